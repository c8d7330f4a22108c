"""What others take of a calibrated cell, against second formulas and the program's files."""
import re
import unittest

import numpy as np
import poecal

import cells

RIGHT = np.pi / 2
# a, alpha, d of the Puma 560, as Corke's table has them; theta is 0.
PUMA = [(0.0, RIGHT, 0.0), (0.4318, 0.0, 0.0), (0.0203, -RIGHT, 0.15005), (0.0, RIGHT, 0.4318), (0.0, -RIGHT, 0.0), (0.0, 0.0, 0.0)]


def link(a, alpha, d, theta):
    """Rz(theta) Tz(d) Tx(a) Rx(alpha), written out."""
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array([[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]])


def puma(q):
    T = np.eye(4)
    for (a, alpha, d), angle in zip(PUMA, q):
        T = T @ link(a, alpha, d, angle)
    return T


def puma_arm():
    joints, T = [], np.eye(4)
    for row in PUMA:
        joints.append(poecal.Joint.revolute(f"joint_{len(joints) + 1}", T[:3, 2], T[:3, 3]))
        T = T @ link(*row, 0.0)
    return poecal.Arm(joints=joints, gamma=poecal.logSe3(T))


def model():
    return poecal.readModel(cells.results() / "model.yaml")


def nominal():
    return poecal.readArm(cells.COBOT / "cobot6.urdf", "base_link", "flange")


class Dh(unittest.TestCase):
    def test_of_a_known_arm_is_its_table(self):
        arm = puma_arm()
        tables = poecal.dhTables(arm, arm)
        self.assertTrue(tables.nominal.plain())
        for row, (a, alpha, d) in zip(tables.nominal.rows, PUMA, strict=True):
            np.testing.assert_allclose([row.a, row.alpha, row.d, row.theta, row.beta], [a, alpha, d, 0.0, 0.0], atol=1e-12)
        # Its axes 2 and 3 alone are parallel.
        self.assertEqual([row.rule == poecal.DhRule.kHayati for row in tables.nominal.rows], [k == 1 for k in range(6)])

    def test_reaches_the_poses_of_the_arm(self):
        numbers = np.random.default_rng(4)
        q = numbers.uniform(-3.0, 3.0, (10, 6))
        arm = puma_arm()
        table = poecal.DhTable(rows=[poecal.DhRow(a=a, alpha=alpha, d=d) for a, alpha, d in PUMA])  # made by hand
        np.testing.assert_allclose(poecal.dhForward(table, arm, q), [puma(one) for one in q], atol=1e-12)
        np.testing.assert_allclose(poecal.forwardKinematics(arm, q), [puma(one) for one in q], atol=1e-12)
        np.testing.assert_allclose(poecal.dhForward(table, arm, q[0]), puma(q[0]), atol=1e-12)
        tables = poecal.dhTables(nominal(), model().cell.arm)
        for one, table in ((nominal(), tables.nominal), (model().cell.arm, tables.calibrated)):
            np.testing.assert_allclose(poecal.dhForward(table, one, q), poecal.forwardKinematics(one, q), atol=1e-12)

    def test_of_another_arm_is_refused(self):
        with self.assertRaises(poecal.InvalidArgument):
            poecal.dhTables(puma_arm(), nominal())


class Ros(unittest.TestCase):
    def test_camera_info_holds_the_camera(self):
        text, camera = poecal.cameraInfoYaml(model()), model().cell.camera
        self.assertNotIn("standard_deviation", text)
        matrix = re.search(r"camera_matrix:\s*rows: 3\s*cols: 3\s*data: \[([^\]]*)\]", text).group(1)
        K = [[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]]
        np.testing.assert_array_equal(np.reshape([float(one) for one in matrix.split(",")], (3, 3)), K)
        file = cells.new_folder() / "camera_info.yaml"
        file.write_text(text)
        read = poecal.readCamera(file)
        np.testing.assert_array_equal(read.parameters(), camera.parameters())
        self.assertEqual((read.width, read.height, read.model), (camera.width, camera.height, camera.model))

    def test_transforms_are_those_of_the_cell(self):
        names = poecal.frameNames(model())
        self.assertEqual((names.base, names.flange, names.camera, names.target), ("base_link", "flange", "camera", "target"))
        names.camera = "eye"
        options = ("x", "y", "z", "qx", "qy", "qz", "qw", "frame-id", "child-frame-id")
        poses = {}
        for *numbers, parent, child in re.findall(" ".join(rf"--{one} (\S+)" for one in options), poecal.transformsYaml(model(), names)):
            numbers = [float(number) for number in numbers]
            poses[parent, child] = poecal.poseFromQuaternion(numbers[:3], numbers[3:])
        registration = model().cell.registration
        T_base_camera = np.linalg.inv(registration.T_camera_near)
        np.testing.assert_allclose(poses["base_link", "eye"], T_base_camera, atol=1e-9)
        np.testing.assert_allclose(poses["flange", "target"], registration.T_far_target, atol=1e-9)

    def test_needs_a_camera(self):
        with self.assertRaises(poecal.InvalidArgument):
            poecal.cameraInfoYaml(poecal.Model())


class Files(unittest.TestCase):
    def test_are_the_program_s(self):
        out = cells.new_folder()
        urdf = cells.COBOT / "cobot6.urdf"
        cells.done(
            "export", cells.results() / "model.yaml", "--urdf", urdf, "--camera-info", out / "camera_info", "--transforms",
            out / "transforms", "--joint-table", out / "joints", "--dh", out / "dh",
        )  # fmt: skip
        arm = model().cell.arm
        for name, text in {
            "camera_info": poecal.cameraInfoYaml(model()),
            "transforms": poecal.transformsYaml(model(), poecal.frameNames(model())),
            "joints": poecal.jointTableCsv(model(), nominal()),
            "dh": poecal.dhYaml(poecal.dhTables(nominal(), arm), arm),
        }.items():
            self.assertEqual(text, (out / name).read_text(), name)


if __name__ == "__main__":
    unittest.main()
