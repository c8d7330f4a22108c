"""Poses of an instrument: their table, and where instrument and tool are."""
import unittest

import numpy as np
import poecal

import cells

ARM = poecal.readArm(cells.COBOT / "cobot6.urdf", "base_link", "flange")
T_INSTRUMENT_BASE = poecal.expSe3([0.3, -0.2, 1.1, 0.8, -0.4, 0.2])
T_FLANGE_TOOL = poecal.expSe3([0.1, 0.4, -0.2, 0.02, 0.05, 0.13])


def readings(count):
    """Within the limits of every joint."""
    return np.random.default_rng(8).uniform(-1.2, 1.2, (count, 6)) + [0.0, -1.3, 0.0, 0.0, 0.0, 0.0]


def seen(q):
    return T_INSTRUMENT_BASE @ poecal.forwardKinematics(ARM, q) @ T_FLANGE_TOOL


def written(q, poses, **columns):
    """A poses.csv with these poses, and further columns."""
    file = cells.new_folder() / "poses.csv"
    header = [f"q{k + 1}" for k in range(6)] + ["x", "y", "z", "qx", "qy", "qz", "qw", *columns]
    rows = [
        [*one, *T[:3, 3], *poecal.quaternionXyzw(T), *(column[k] for column in columns.values())]
        for k, (one, T) in enumerate(zip(q, poses, strict=True))
    ]
    file.write_text("\n".join([",".join(header)] + [",".join(repr(float(cell)) for cell in row) for row in rows]) + "\n")
    return file


class Table(unittest.TestCase):
    def test_is_read_as_it_was_written(self):
        q = readings(5)
        file = written(q, seen(q), sigma_position=[1e-4] * 5, humidity=np.arange(5.0))
        table = poecal.readPoses(file, ARM)
        self.assertEqual((table.file, table.other_columns, table.position_only), (file, ("humidity",), False))
        np.testing.assert_array_equal([pose.sample.q for pose in table.poses], q)
        np.testing.assert_allclose([pose.T_instrument_tool for pose in table.poses], seen(q), atol=1e-14)
        self.assertEqual([pose.sigma_position for pose in table.poses], [1e-4] * 5)
        self.assertEqual([pose.sample.other[0] for pose in table.poses], [0.0, 1.0, 2.0, 3.0, 4.0])
        self.assertIsNone(table.poses[0].sigma_rotation)

    def test_errors_name_the_line(self):
        q = readings(3)
        file = written(q, seen(q))
        file.write_text(file.read_text().replace(repr(float(q[1, 2])), "nought"))
        with self.assertRaisesRegex(poecal.FileError, r"poses.csv:3: .*nought"):
            poecal.readPoses(file, ARM)

    def test_gives_measurements(self):
        q = readings(6)
        read = poecal.measurementsOf(poecal.readPoses(written(q, seen(q)), ARM))
        made = poecal.Measurements()
        made.addPoses(poecal.sampleTable(q), seen(q))
        self.assertEqual(len(read.observations), 6)
        for one, other in zip(read.observations, made.observations, strict=True):
            np.testing.assert_array_equal(one.q, other.q)
            np.testing.assert_allclose(one.pose.T_camera_target, other.pose.T_camera_target, atol=1e-14)

    def test_may_be_made_by_hand(self):
        poses = [poecal.MeasuredPose(sample=poecal.Sample(q=q), T_instrument_tool=seen(q), sigma_position=1e-4) for q in readings(4)]
        measurements = poecal.measurementsOf(poecal.PoseTable(poses=poses, other_columns=["humidity"]))
        self.assertEqual((len(measurements.samples), measurements.other_columns), (4, ("humidity",)))


class Registration(unittest.TestCase):
    def registered(self, q, poses, **how):
        measurements = poecal.Measurements()
        measurements.addPoses(poecal.sampleTable(q), poses, 1e-4, 1e-4)
        return poecal.registerPoses(poecal.Cell(arm=ARM), measurements.observations, **how)

    def test_finds_instrument_and_tool(self):
        q = readings(20)
        result = self.registered(q, seen(q))
        found = result.adjustment.cell.registration
        np.testing.assert_allclose(found.T_camera_near, T_INSTRUMENT_BASE, atol=1e-9)
        np.testing.assert_allclose(found.T_far_target, T_FLANGE_TOOL, atol=1e-9)
        self.assertEqual(result.warnings, ())
        self.assertEqual((result.adjustment.rank, len(result.adjustment.names)), (12, 12))

    def test_deviations_are_those_of_the_noise(self):
        q = readings(100)
        noise = np.random.default_rng(9).normal(0.0, 1e-4, (100, 6))
        noisy = [T @ poecal.expSe3([*turn, *shift]) for T, turn, shift in zip(seen(q), noise[:, :3], noise[:, 3:], strict=True)]
        adjustment = self.registered(q, noisy, robust=False).adjustment
        self.assertEqual(adjustment.status, poecal.AdjustmentStatus.kConverged)
        self.assertLess(adjustment.steps[-1].cost, adjustment.steps[0].cost)
        # 588 degrees of freedom.
        self.assertLess(abs(adjustment.reducedChiSquare() - 1.0), 5.0 * np.sqrt(2.0 / 588.0))
        off = adjustment.cell.registration.T_camera_near @ np.linalg.inv(T_INSTRUMENT_BASE)
        away = poecal.logSe3(off)
        chi_square = away @ np.linalg.solve(adjustment.covariance[:6, :6], away)
        self.assertLess(chi_square, 27.9)  # 1 in 10^4 of 6 numbers

    def test_robust_one_sets_a_wrong_row_aside(self):
        q = readings(20)
        poses = seen(q)
        poses[7, :3, 3] += 0.1
        robust, plain = (self.registered(q, poses, robust=choice).adjustment for choice in (True, False))
        self.assertEqual([float(weights[0]) == 0.0 for weights in robust.weights], [k == 7 for k in range(20)])
        np.testing.assert_allclose(robust.cell.registration.T_camera_near, T_INSTRUMENT_BASE, atol=1e-9)
        self.assertGreater(np.abs(plain.cell.registration.T_camera_near - T_INSTRUMENT_BASE).max(), 1e-3)

    def test_poses_that_never_turn_do_not_do(self):
        with self.assertRaises(poecal.InsufficientData):
            self.registered(readings(1), seen(readings(1)))


if __name__ == "__main__":
    unittest.main()
