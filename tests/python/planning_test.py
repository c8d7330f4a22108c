"""Plans from Python keep to limits and view, bring what they say, and are the program's."""
import copy
import unittest

import numpy as np
import poecal

import cells

FEW = {"count": 6, "candidates": 200}


def rows_of(csv):
    return [line.split(",") for line in csv.splitlines()]


class OfACapture(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        source = poecal.PlanSource(capture=cells.corners_capture(), model=cells.results() / "model.yaml")
        cls.cell = poecal.readPlanningCell(source)
        cls.plan = poecal.planPoses(cls.cell, poecal.PlanOptions(**FEW))
        cls.samples = [poecal.Sample(q=pose.q) for pose in cls.plan.poses]

    def test_brings_what_it_says(self):
        plan = self.plan
        self.assertLess(plan.after.position, plan.before.position)
        self.assertLess(plan.after.rotation, plan.before.rotation)
        for more, told in (([], plan.before), (self.samples, plan.after)):
            tool = poecal.toolUncertainty(self.cell, more)
            np.testing.assert_allclose([tool.position, tool.rotation], [told.position, told.rotation], rtol=1e-9)

    def test_shows_the_target(self):
        model, camera = self.cell.model, self.cell.nominal.camera
        self.assertEqual(len(self.plan.poses), 6)
        for pose in self.plan.poses:
            corners = poecal.predictCorners(model.cell, self.cell.target, poecal.forwardKinematics(model.cell.arm, pose.q))
            px = np.array([corner.px for corner in corners])
            self.assertEqual(px.shape, (4, 2))
            self.assertTrue((px > 0.0).all() and (px < [camera.width, camera.height]).all(), px)

    def test_lies_within_the_limits(self):
        limited, lower, upper = copy.copy(self.cell), np.full(6, -1.2), np.array([2.0, 0.5, 1.5, 2.0, 2.0, 0.5])
        model, cell, arm = copy.copy(limited.model), copy.copy(limited.model.cell), copy.copy(limited.model.cell.arm)
        joints = list(arm.joints)
        for joint, low, high in zip(joints, lower, upper):
            joint.limits = poecal.JointLimits(lower=low, upper=high)
        arm.joints = joints
        cell.arm = arm
        model.cell = cell
        limited.model = model
        planned = np.array([pose.q for pose in poecal.planPoses(limited, poecal.PlanOptions(**FEW)).poses])
        self.assertTrue((planned >= lower).all() and (planned <= upper).all(), planned)
        free = np.array([pose.q for pose in self.plan.poses])
        self.assertFalse((free >= lower).all() and (free <= upper).all())

    def test_is_the_program_s(self):
        for jobs in (1, 2):
            file = cells.new_folder() / "next.csv"
            options = ("--count", 6, "--candidates", 200, "--jobs", jobs)
            cells.done("plan", cells.corners_capture(), "--model", cells.results() / "model.yaml", *options, "--out", file)
            plan = poecal.planPoses(self.cell, poecal.PlanOptions(jobs=jobs, **FEW))
            self.assertEqual(poecal.planCsv(plan, len(self.cell.taken.samples)), file.read_text())

    def test_for_an_effect_shows_it_better(self):
        options = {"aim": poecal.PlanAim.kDetect, "detect": "joint_gain@joint:3", **FEW}
        small, twice = (poecal.planPoses(self.cell, poecal.PlanOptions(detect_size=size, **options)) for size in (1e-4, 2e-4))
        self.assertGreater(small.detection_after.chi_square, small.detection_before.chi_square)
        # The expected chi-square grows with the square of the size.
        self.assertAlmostEqual(twice.detection_before.chi_square / small.detection_before.chi_square, 4.0, delta=1e-6)

    def test_tells_rivals_apart(self):
        cell = copy.copy(self.cell)
        found = poecal.Rival(effect="joint_coupling", location="joint:6", driver="q5", probability=0.6)
        other = poecal.Rival(effect="joint_gain", location="joint:6", driver="q6", probability=0.4)
        cell.open = [poecal.Rivals(explanations=[found, other])]
        plan = poecal.planPoses(cell, poecal.PlanOptions(aim=poecal.PlanAim.kSeparate, **FEW))
        self.assertEqual({odds.right for odds in plan.odds}, {"joint_coupling@joint:6/q5", "joint_gain@joint:6/q6"})
        for odds in plan.odds:
            self.assertGreater(odds.expected, odds.before)

    def test_options_are_validated(self):
        with self.assertRaisesRegex(poecal.InvalidArgument, "count is 0"):
            poecal.planPoses(self.cell, poecal.PlanOptions(count=0))


class FromMemory(unittest.TestCase):
    def test_starts_from_what_a_calibration_gave(self):
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        options = poecal.CalibrateOptions(last=poecal.CalibrationStep.kIdentification)
        found = poecal.calibrate(loaded.nominal, loaded.measurements, options).identification
        cell = poecal.PlanningCell(
            nominal=loaded.nominal, model=found.model, target=loaded.capture.target, taken=loaded.measurements,
            noise=poecal.PlanNoise(corner=0.1), arm_beyond_tolerance=found.arm_beyond_tolerance,
        )  # fmt: skip
        plan = poecal.planPoses(cell, poecal.PlanOptions(**FEW))
        self.assertLess(plan.after.position, plan.before.position)
        # A quarter of the noise: what the pictures show is that much more certain, and the priors hold less.
        cell.noise = poecal.PlanNoise(corner=0.025)
        quarter = poecal.toolUncertainty(cell, []).position / plan.before.position
        self.assertTrue(0.25 <= quarter < 0.5, quarter)


class OfAFirstCapture(unittest.TestCase):
    def first(self, **places):
        robot, camera, target = (cells.COBOT / name for name in ("cobot6.urdf", "camera.yaml", "target.yaml"))
        return poecal.firstCapture(
            poecal.FirstCapture(robot=robot, camera=camera, target=target, base_link="base_link", tip_link="flange", **places)
        )

    def test_places_are_where_they_were_said_to_be(self):
        at, to = np.array([1.2, -0.9, 0.8]), np.array([0.2, 0.1, 0.5])
        cell = self.first(camera_at=at, look_at=to, rough_position=0.03)
        T_base_camera = np.linalg.inv(cell.model.cell.registration.T_camera_near)
        np.testing.assert_allclose(T_base_camera[:3, 3], at, atol=1e-12)
        np.testing.assert_allclose(T_base_camera[:3, 2], (to - at) / np.linalg.norm(to - at), atol=1e-12)
        self.assertEqual((cell.rough_position, len(cell.taken.samples)), (0.03, 0))

    def test_makes_the_tool_certain(self):
        cell = self.first(camera_at=[1.2, -0.9, 0.8], look_at=[0.2, 0.1, 0.5])
        plan = poecal.planPoses(cell, poecal.PlanOptions(count=12, candidates=200))
        self.assertLess(plan.after.position, 0.1 * plan.before.position)
        header, *rows = rows_of(poecal.planCsv(plan))
        self.assertEqual(header[:7], ["image", "q1", "q2", "q3", "q4", "q5", "q6"])
        np.testing.assert_allclose([[float(cell) for cell in row[1:7]] for row in rows], [pose.q for pose in plan.poses], atol=1e-6)

    def test_needs_to_know_where_the_camera_is(self):
        with self.assertRaisesRegex(poecal.InvalidArgument, "camera"):
            self.first()


if __name__ == "__main__":
    unittest.main()
