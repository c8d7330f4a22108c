"""The types beside the module are the module's, and its names are those of C++."""
import ast
import inspect
import re
import shutil
import subprocess
import types
import unittest
from pathlib import Path

import numpy as np
import poecal

import cells

STUB = Path(poecal.__file__).with_name("__init__.pyi")
HEADERS = "\n".join(file.read_text() for file in sorted((cells.SOURCE / "include/poecal").rglob("*.hpp")))
CODE = re.sub(r"//.*", "", HEADERS)


def pep8(name):
    return re.sub("[A-Z]", lambda letter: "_" + letter.group().lower(), name)


def names_in(body):
    """What the body of a stub or of one of its classes defines."""
    names = {}
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names[node.name] = node
        elif isinstance(node, ast.Assign):
            names[node.targets[0].id] = node
        elif isinstance(node, ast.AnnAssign):
            names[node.target.id] = node
    return names


def public(names):
    return {name for name in names if not name.startswith("_")}


def arguments_of(function):
    every = function.args.posonlyargs + function.args.args + function.args.kwonlyargs
    return [argument.arg for argument in every if argument.arg != "self"]


def arguments_in(signature):
    """Names in a signature that pybind11 writes."""
    inner = re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", signature[signature.index("(") + 1 : signature.rindex(" -> ")]))
    return [name for name in re.findall(r"(?:^|, )(\w+): ", inner) if name != "self"]


def arguments_of_call(call):
    return arguments_in(call.__doc__.split("\n")[0])


def arguments_of_overloads(call):
    """Of each way to call a function: one signature is the first line, several are numbered."""
    numbered = re.findall(r"^\d+\. (\w+\(.* -> .*)$", call.__doc__, re.MULTILINE)
    return [arguments_in(signature) for signature in numbered or call.__doc__.split("\n")[:1]]


def functions_of_stub():
    """The nodes of each function by its name: several where it is overloaded."""
    functions = {}
    for node in ast.parse(STUB.read_text()).body:
        if isinstance(node, ast.FunctionDef):
            functions.setdefault(node.name, []).append(node)
    return functions


def stubbed():
    return names_in(ast.parse(STUB.read_text()).body)


def classes():
    return {name: kind for name, kind in vars(poecal).items() if inspect.isclass(kind)}


def members(kind):
    """Of a class and not of what it is derived from, but for the enumerations' own ways."""
    return public(vars(kind)) - ({"name", "value"} if hasattr(kind, "__members__") else set())


class Stub(unittest.TestCase):
    def test_has_the_names_of_the_module(self):
        self.assertEqual(public(stubbed()), public(dir(poecal)))

    def test_has_the_members_of_each_class(self):
        for name, kind in classes().items():
            self.assertEqual(public(names_in(stubbed()[name].body)), members(kind), name)

    def test_says_which_members_may_be_set(self):
        for name, kind in classes().items():
            for member, node in names_in(stubbed()[name].body).items():
                if isinstance(vars(kind).get(member), property):
                    final = ast.unparse(node.annotation).startswith("Final[")
                    self.assertEqual(final, vars(kind)[member].fset is None, f"{name}.{member}")

    def test_has_the_arguments_of_each_function(self):
        for name, nodes in functions_of_stub().items():
            self.assertEqual([arguments_of(node) for node in nodes], arguments_of_overloads(getattr(poecal, name)), name)
        for name, kind in classes().items():
            for member, node in names_in(stubbed()[name].body).items():
                doc = getattr(kind, member, None).__doc__ or ""  # of an alias it begins with the other name
                if isinstance(node, ast.FunctionDef) and not member.startswith("_") and doc.startswith(member):
                    self.assertEqual(arguments_of(node), arguments_of_call(getattr(kind, member)), f"{name}.{member}")

    def test_makes_objects_of_their_members(self):
        for name, kind in classes().items():
            if hasattr(kind, "__copy__"):
                initialiser = names_in(stubbed()[name].body)["__init__"]
                settable = [member for member, value in vars(kind).items() if isinstance(value, property) and value.fset]
                self.assertEqual(arguments_of(initialiser), settable, name)
                kind()


def fits(annotation, value):
    """Whether a value is what the stub says."""
    if annotation.endswith(" | None"):
        return value is None or fits(annotation.removesuffix(" | None"), value)
    inner = annotation[annotation.find("[") + 1 : -1]
    if annotation.startswith("Final["):
        return fits(inner, value)
    if annotation.startswith(("Sequence[", "tuple[")):
        alike = "," not in inner or inner.endswith(", ...")
        each = [inner.removesuffix(", ...")] * len(value) if alike else inner.split(", ")
        return isinstance(value, tuple) and all(fits(*pair) for pair in zip(each, value, strict=True))
    if annotation.startswith("Mapping[str, "):
        return isinstance(value, types.MappingProxyType) and all(fits(inner.removeprefix("str, "), one) for one in value.values())
    if annotation == "_Array":
        return isinstance(value, np.ndarray) and value.dtype == np.float64 and not value.flags.writeable
    return type(value).__name__.removeprefix("Posix") == annotation


def annotations_in(body):
    return {member: ast.unparse(node.annotation) for member, node in names_in(body).items() if isinstance(node, ast.AnnAssign)}


def found_objects():
    """Objects of as many classes as there are, from real calls."""
    made = [kind() for kind in classes().values() if hasattr(kind, "__copy__")]
    return made + calibrated_objects() + planned_objects() + picture_objects() + pose_objects()


def calibrated_objects():
    capture, out = cells.corners_capture(), cells.new_folder() / "out"
    run = poecal.runCapture(capture, out)
    model, loaded = poecal.readModel(out / "model.yaml"), poecal.loadCapture(capture, out)
    wanted = poecal.sampleTable(T_base_flange=[poecal.forwardKinematics(model.cell.arm, [0.1, -1.0, 1.0, 0.2, 0.3, 0.4])])
    return [
        run, model, loaded, poecal.realArm(model), *poecal.compensate(poecal.realArm(model), wanted), poecal.readResults(out),
        poecal.axisOffset(*model.cell.arm.joints[:2]), *poecal.effectKinds(), model.effects[0].effect, poecal.checkCapture(capture),
        *poecal.predictCorners(model.cell, model.target, poecal.forwardKinematics(model.cell.arm, run.measurements.samples[0].q)),
        poecal.calibrateBoardFolder(cells.board_folder(), poecal.IntrinsicsOptions(), 1, out / "camera.yaml"), poecal.CaptureSource("x"),
        *poecal.registerCell(loaded.nominal, loaded.measurements.observations).samples[:1], loaded.measurements.observations[0],
        poecal.dhTables(run.calibration.identification.nominal, model.cell.arm), poecal.frameNames(model),
    ]  # fmt: skip


def planned_objects():
    """Also of rivals, and of an effect that is looked for."""
    cell = poecal.readPlanningCell(poecal.PlanSource(capture=cells.corners_capture(), model=cells.results() / "model.yaml"))
    rivals = [poecal.Rival(effect="joint_coupling", location="joint:6", driver="q5", probability=0.6),
              poecal.Rival(effect="joint_gain", location="joint:6", driver="q6", probability=0.4)]  # fmt: skip
    cell.open = [poecal.Rivals(explanations=rivals)]
    few = {"count": 2, "candidates": 50}
    separate = poecal.PlanOptions(aim=poecal.PlanAim.kSeparate, **few)
    detect = poecal.PlanOptions(aim=poecal.PlanAim.kDetect, detect="joint_gain@joint:3", detect_size=1e-3, floor=-1.0, **few)
    return [cell, detect, *(poecal.planPoses(cell, options) for options in (separate, detect))]


def picture_objects():
    """Of pictures with a remark, too."""
    scene = poecal.readScene(cells.scene_file("image: {blur: 0.7, noise: 2.0, background: plain}", 1))
    capture = cells.new_folder() / "capture"
    summary = poecal.simulate(scene, capture)
    found = poecal.detectCapture(poecal.readCapture(capture))
    other = poecal.apriltagTarget("tag36h11", [poecal.TargetTag(id=7, size=0.08)])
    unseen = poecal.detect(capture / "images", poecal.listPictures(capture / "images"), other, poecal.DetectOptions(other_tags=[12]))
    return [
        scene, summary, found, unseen, poecal.readBoardPictures(cells.board_folder()), poecal.paperNamed("a4"),
        poecal.drawTargetSheet(other, poecal.paperNamed("a4")),
    ]  # fmt: skip


def pose_objects():
    """Of an instrument's poses."""
    arm = poecal.readRobotYaml(cells.SOURCE / "calib_data/puma560/robot.yaml")
    table = poecal.paperPoses(arm)
    registration = poecal.registerPoses(poecal.Cell(arm=arm), poecal.measurementsOf(table).observations)
    return [table, registration, *poecal.paperExperiment(arm, arm, poecal.PaperOptions(seeds=1, poses=20, test_poses=2))]


def parts_of(value):
    """The objects of the module in a value."""
    if isinstance(value, tuple):
        return [part for one in value[:5] for part in parts_of(one)]  # as many as show what a member may be
    return [value] if type(value).__module__ == "poecal" and not hasattr(value, "__members__") else []


def body_of(name):
    """What stands between the braces of a type in the headers; nothing where there is no such type."""
    found = re.search(rf"^(?:struct|class|enum class) {name}\b[^;{{]*{{", CODE, re.MULTILINE)
    if found is None:
        return None
    depth, end = 1, found.end()
    while depth > 0:
        depth += {"{": 1, "}": -1}.get(CODE[end], 0)
        end += 1
    return CODE[found.end() : end]


def own_names(names):
    """Without the PEP 8 names of others."""
    return names - {pep8(name) for name in names if pep8(name) != name}


class Types(unittest.TestCase):
    def test_of_members_are_those_of_real_objects(self):
        annotations = {name: annotations_in(stubbed()[name].body) for name in classes()}
        seen, left, wrong = set(), found_objects(), set()
        while left:
            one = left.pop()
            name = type(one).__name__
            seen.add(name)
            for member, annotation in annotations[name].items():
                value = getattr(one, member)
                if not fits(annotation, value):
                    wrong.add(f"{name}.{member} is {type(value).__name__}, expected {annotation}")
                left += parts_of(value)
        self.assertEqual(wrong, set())
        results = {name for name, kind in classes().items() if any(isinstance(member, property) for member in vars(kind).values())}
        enumerations = {name for name, kind in classes().items() if hasattr(kind, "__members__")}
        # Of clean captures there are no bad rows and no rivals of a finding.
        self.assertLessEqual(results - enumerations - seen, {"AlternativeCause", "BadSample", "SuspectRow"})


class Names(unittest.TestCase):
    def test_are_those_of_the_headers(self):
        unknown = [name for name in own_names(public(dir(poecal))) - set(classes()) if not re.search(rf"\b{name}\(", CODE)]
        for name, kind in classes().items():
            body = body_of(name)
            if body is None:
                unknown.append(name)
                continue
            unknown += [f"{name}.{member}" for member in own_names(members(kind)) if not re.search(rf"\b{member}\b", body)]
        self.assertEqual(unknown, [])

    def test_of_options_with_progress_are_all_here(self):
        told = [name for name in re.findall(r"^struct (\w+)", CODE, re.MULTILINE) if "ProgressFunction progress" in (body_of(name) or "")]
        self.assertIn("SimulateOptions", told)
        for name in told:
            self.assertIn("progress", members(getattr(poecal, name)), name)

    def test_are_looked_for_in_the_type_itself(self):
        self.assertIn("kEyeToHand", body_of("Setup"))
        self.assertNotIn("T_camera_near", body_of("Setup"))
        self.assertIsNone(body_of("Seteup"))

    def test_of_functions_are_also_pep_8_s(self):
        for scope in (poecal, *classes().values()):
            for name, value in list(vars(scope).items()):
                if callable(value) and not inspect.isclass(value) and not name.startswith("_"):
                    self.assertIs(getattr(scope, pep8(name)), getattr(scope, name), name)


@unittest.skipUnless(shutil.which("mypy"), "mypy is not installed (apps/install-dependencies.sh --ci)")
class Mypy(unittest.TestCase):
    def checked(self, *files):
        # The module's folder is where mypy looks for its types, as it does for an installed package.
        command = ["mypy", "--strict", "--ignore-missing-imports", "--cache-dir", Path(cells.scratch().name, "mypy"), *files]
        return subprocess.run(command, env={"MYPYPATH": str(STUB.parent.parent), "PATH": "/usr/bin:/bin"}, capture_output=True, text=True)

    def test_passes_the_stub_and_what_uses_it(self):
        run = self.checked(STUB, cells.SOURCE / "apps/python/example.py")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_sees_a_wrong_call(self):
        wrong = cells.new_folder() / "wrong.py"
        wrong.write_text("import poecal\npoecal.readModel(7)\npoecal.Arm().joints.append(poecal.Joint())\n")
        run = self.checked(wrong)
        self.assertIn("wrong.py:2: error: Argument 1", run.stdout)
        self.assertIn("wrong.py:3: error", run.stdout)


if __name__ == "__main__":
    unittest.main()
