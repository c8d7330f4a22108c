"""Poses from the module against a second formula and against the program."""
import copy
import csv
import unittest

import numpy as np
import poecal

import cells

ROUNDING = 1e-12  # a few products of matrices with entries of metres
PROMISED = 1e-9  # [m], [rad]: what compensate.hpp says


def exponential(xi):
    """exp of a twist as a 4 x 4 matrix: the power series of the matrix, halved until it is short."""
    w, v = xi[:3], xi[3:]
    small = np.zeros((4, 4))
    small[:3] = np.c_[np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]), v] / 2**10
    term = total = np.eye(4)
    for k in range(1, 12):
        term = term @ small / k
        total = total + term
    return np.linalg.matrix_power(total, 2**10)


def nominal():
    return poecal.readArm(cells.COBOT / "cobot6.urdf", "base_link", "flange")


def readings(rows):
    """Within the joints' limits, the elbow bent and the wrist not straight, so that no posture is singular."""
    return np.random.default_rng(1).uniform([-2.5, -2.2, 0.5, -2.5, 0.4, -2.5], [2.5, -0.4, 2.0, 2.5, 2.0, 2.5], (rows, 6))


def flawed_model():
    """The calibrated cell with effects that follow other joints, sides, gravity, temperature and time."""
    model = poecal.readModel(cells.results() / "model.yaml")
    specs = [
        poecal.EffectSpec(effect="joint_coupling", location="joint:6", parameters={"source": 5, "ratio": 4e-3}),
        poecal.EffectSpec(effect="joint_backlash", location="joint:5", parameters={"half_gap": 6e-4}),
        poecal.EffectSpec(effect="joint_compliance", location="joint:2", parameters={"compliance": 4e-5}),
        poecal.EffectSpec(effect="joint_drift", location="joint:4", parameters={"rate": 1e-3, "reference": 20.0}, driver="temperature"),
        poecal.EffectSpec(effect="joint_slip", location="joint:1", parameters={"time": 50.0, "offset": 1e-3}),
    ]
    model.effects = [poecal.makeEffect(spec, model.cell) for spec in specs]
    return model


def drivers(rows):
    numbers = np.random.default_rng(2)
    return {
        "dir": numbers.choice([-1.0, 1.0], (rows, 6)),
        "temperature": numbers.uniform(20.0, 30.0, rows),
        "stamp": 10.0 * np.arange(rows),
    }


def poses_of(file):
    with open(file, newline="") as table:
        rows = list(csv.DictReader(table))
    position = [[float(row[name]) for name in ("x", "y", "z")] for row in rows]
    quaternion = [[float(row[name]) for name in ("qx", "qy", "qz", "qw")] for row in rows]
    return np.array([poecal.poseFromQuaternion(*pair) for pair in zip(position, quaternion)])


class Kinematics(unittest.TestCase):
    def test_is_the_product_of_exponentials(self):
        arm, q = nominal(), readings(5)
        expected = []
        for row in q:
            T = np.eye(4)
            for joint, angle in zip(arm.joints, row):
                T = T @ exponential(joint.xi * angle)
            expected.append(T @ exponential(arm.gamma))
        np.testing.assert_allclose(poecal.forwardKinematics(arm, q), expected, atol=ROUNDING, rtol=0)

    def test_one_row_is_one_pose_and_no_row_is_none(self):
        arm, q = nominal(), readings(3)
        np.testing.assert_array_equal(poecal.forwardKinematics(arm, q)[1], poecal.forwardKinematics(arm, q[1]))
        np.testing.assert_array_equal(poecal.forwardKinematics(arm, q[1]), poecal.forwardKinematics(arm, list(q[1])))
        self.assertEqual(poecal.forwardKinematics(arm, np.zeros((0, 6))).shape, (0, 4, 4))

    def test_strides_do_not_matter(self):
        arm, q = nominal(), readings(8)
        np.testing.assert_array_equal(poecal.forwardKinematics(arm, np.asfortranarray(q)), poecal.forwardKinematics(arm, q))
        np.testing.assert_array_equal(poecal.forwardKinematics(arm, q[::2]), poecal.forwardKinematics(arm, q)[::2])
        T = poecal.forwardKinematics(arm, q[0])
        np.testing.assert_allclose(poecal.expSe3(poecal.logSe3(np.asfortranarray(T))), T, atol=ROUNDING, rtol=0)

    def test_an_arm_made_by_hand(self):
        arm = poecal.Arm(name="turntable", joints=[poecal.Joint.revolute("turn", [0, 0, 1], [0, 0, 0])], gamma=[0, 0, 0, 0.3, 0, 0])
        np.testing.assert_allclose(poecal.forwardKinematics(arm, [np.pi / 2])[:3, 3], [0.0, 0.3, 0.0], atol=ROUNDING)

    def test_with_effects_is_what_the_program_predicts(self):
        model, table, folder = flawed_model(), poecal.sampleTable(readings(20), **drivers(20)), cells.new_folder()
        (folder / "model.yaml").write_text(poecal.modelYaml(model))
        (folder / "joints.csv").write_text(poecal.samplesCsv(table))
        cells.done("predict", "--model", "model.yaml", "--joints", "joints.csv", "--out", "poses.csv", folder=folder)
        reached = poecal.reachedPoses(poecal.realArm(model), table)
        np.testing.assert_allclose(reached, poses_of(folder / "poses.csv"), atol=ROUNDING, rtol=0)  # by way of a quaternion
        without = poecal.forwardKinematics(model.cell.arm, readings(20))
        self.assertGreater(np.abs(reached - without)[:, :3, 3].max(), 1e-4)  # the effects are there

    def test_each_driver_matters(self):
        arm, q = poecal.realArm(flawed_model()), readings(20)
        columns = drivers(20)
        reached = poecal.reachedPoses(arm, poecal.sampleTable(q, **columns))
        for name, other in {"dir": -columns["dir"], "temperature": columns["temperature"] + 5.0, "stamp": columns["stamp"] - 100.0}.items():
            changed = poecal.reachedPoses(arm, poecal.sampleTable(q, **{**columns, name: other}))
            self.assertGreater(np.abs(changed - reached).max(), 1e-4, name)

    def test_compensated_commands_reach_the_wanted_poses(self):
        arm, columns = poecal.realArm(flawed_model()), drivers(10)
        wanted = poecal.forwardKinematics(nominal(), readings(10))
        commands = poecal.compensate(arm, poecal.sampleTable(readings(10), T_base_flange=wanted, **columns))
        self.assertEqual([command.why_not for command in commands], [""] * 10)
        q = np.array([command.q for command in commands])
        reached = poecal.reachedPoses(arm, poecal.sampleTable(q, **columns))
        np.testing.assert_allclose(reached, wanted, atol=2 * PROMISED, rtol=0)


class Shapes(unittest.TestCase):
    def refuses(self, words, call, *arguments, **columns):
        with self.assertRaisesRegex(ValueError, words):
            call(*arguments, **columns)

    def test_what_was_got_and_what_was_expected(self):
        arm = nominal()
        self.refuses(r"5 joint positions, expected 6", poecal.forwardKinematics, arm, np.zeros(5))
        self.refuses(r"5 joint positions, expected 6", poecal.forwardKinematics, arm, np.zeros((2, 5)))
        self.refuses(r"expected an array of shape \(N, n\), got \(2, 3, 4\)", poecal.forwardKinematics, arm, np.zeros((2, 3, 4)))
        self.refuses(r"expected an array of shape \(6,\), got \(5,\)", poecal.expSe3, np.zeros(5))
        self.refuses(r"expected an array of shape \(4, 4\), got \(3, 4\)", poecal.logSe3, np.zeros((3, 4)))
        self.refuses(r"expected an array of shape \(6,\), got \(6, 1\)", setattr, arm, "gamma", np.zeros((6, 1)))
        self.refuses(r"expected an array of shape \(N, n\), got \(6,\)", poecal.sampleTable, np.zeros(6))
        self.refuses(r"stamp: 2 rows, expected 3", poecal.sampleTable, np.zeros((3, 6)), stamp=[1.0, 2.0])

    def test_a_matrix_that_is_no_pose(self):
        mirrored = np.diag([1.0, 1.0, -1.0, 1.0])
        stretched = np.diag([1.0, 1.0, 1.01, 1.0])
        unfinished = np.eye(4)
        unfinished[0, 3] = np.nan
        for T in (mirrored, stretched, unfinished, np.diag([1.0, 1.0, 1.0, 0.0])):
            self.refuses("expected a pose", poecal.logSe3, T)

    def test_what_is_no_array(self):
        for q in ("far", object(), [[1.0], [1.0, 2.0]]):
            with self.assertRaises(TypeError):
                poecal.forwardKinematics(nominal(), q)


class Objects(unittest.TestCase):
    def test_a_copy_cannot_be_taken_for_the_member(self):
        arm = nominal()
        with self.assertRaises(ValueError):
            arm.gamma[0] = 1.0
        with self.assertRaises(AttributeError):
            arm.joints.append(poecal.Joint.revolute("more", [0, 0, 1], [0, 0, 0]))
        with self.assertRaises(TypeError):
            poecal.EffectSpec(effect="joint_gain").parameters["gain"] = 1.0
        arm.joints = arm.joints[:2]
        self.assertEqual(arm.jointCount(), 2)

    def test_what_was_read_outlives_where_it_was_read(self):
        cell = poecal.Cell(arm=nominal())
        arm, registration = cell.arm, cell.registration
        cell.arm = None
        del cell
        self.assertEqual(arm.name, "cobot6")
        self.assertEqual(registration.nearFrame(), "base")
        measurements = poecal.Measurements(target=poecal.apriltagTarget("tag36h11", [poecal.TargetTag(id=7, size=0.08)]))
        target = measurements.target
        tag, point = target.tags[0], target.points[3]
        measurements.target = poecal.chessboardTarget(60, 40, 0.02)
        self.assertEqual((tag.id, tag.size), (7, 0.08))
        self.assertEqual((point.id.tag, point.id.corner), (7, 3))
        self.assertEqual(len(target.points), 2400)  # an inner object is the member

    def test_an_inner_object_is_the_member(self):
        cell = poecal.Cell()
        T = poecal.expSe3([0.1, 0.2, 0.3, 1.0, 2.0, 3.0])
        cell.registration.T_camera_near = T
        np.testing.assert_array_equal(cell.registration.T_camera_near, T)

    def test_copies_are_apart(self):
        arm = nominal()
        for other in (copy.copy(arm), copy.deepcopy(arm)):
            other.name = "other"
        self.assertEqual(arm.name, "cobot6")

    def test_members_that_are_not_there(self):
        with self.assertRaisesRegex(TypeError, "Arm has no member joint"):
            poecal.Arm(joint=[])
        with self.assertRaises(AttributeError):
            nominal().joint = []

    def test_repr_is_one_line_with_the_members(self):
        text = repr(poecal.Joint.revolute("turn", [0, 0, 1], [0.5, 0, 0]))
        self.assertEqual(text, "Joint(name='turn', type=<JointType.kRevolute: 0>, xi=(0, 0, 1, 0, -0.5, 0), anchor=(0.5, 0, 0))")
        self.assertEqual(repr(poecal.Arm(name="empty")), "Arm(name='empty', gamma=(0, 0, 0, 0, 0, 0))")


if __name__ == "__main__":
    unittest.main()
