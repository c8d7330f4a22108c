"""Captures simulated from Python are the program's, and their truth is found again."""
import copy
import unittest

import numpy as np
import poecal

import cells

CORNERS = "corners: {sigma: 0.1}"
PICTURES = "image: {blur: 0.7, noise: 2.0, background: plain}"


def files_of(folder):
    return {file.relative_to(folder): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


def true_cell(scene):
    return poecal.Cell(arm=scene.actual, camera=scene.camera, registration=scene.registration)


class Scenes(unittest.TestCase):
    def test_are_read_as_they_are_written(self):
        scene = poecal.readScene(cells.scene_file(CORNERS, 20))
        self.assertEqual((scene.count, scene.seed, scene.corner_sigma, scene.image), (20, 12, 0.1, None))
        self.assertEqual(scene.nominal.jointCount(), 6)
        effect, = scene.effects
        self.assertEqual(effect.effect.name(), "joint_coupling")
        np.testing.assert_array_equal(effect.parameters, [5.0, cells.RATIO])
        # The true arm is the nominal one with errors of 0.6 mm and 2 mrad.
        offsets = [poecal.axisOffset(*pair) for pair in zip(scene.nominal.joints, scene.actual.joints)]
        self.assertTrue(all(1e-5 < offset.tilt < 1e-2 and offset.shift < 3e-3 for offset in offsets), offsets)

    def test_pictures_take_their_looks_in_turn(self):
        looks = [poecal.PictureLook(blur=0.5, noise=1.0), poecal.PictureLook(blur=1.5, noise=3.0)]
        scene = poecal.Scene(image=poecal.ImageOptions(background="plain"), looks=looks)
        drawn = [poecal.imageOptions(scene, index) for index in range(3)]
        self.assertEqual([(one.blur, one.noise) for one in drawn], [(0.5, 1.0), (1.5, 3.0), (0.5, 1.0)])
        self.assertEqual({one.background for one in drawn}, {"plain"})

    def test_a_wrong_one_is_named_with_its_line(self):
        file = cells.scene_file("corner: {sigma: 0.1}", 20)
        with self.assertRaisesRegex(poecal.FileError, r"scene\.yaml:\d+: .*corner"):
            poecal.readScene(file)


class Drawn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = poecal.readScene(cells.scene_file(CORNERS, 20))
        cls.samples = poecal.drawSamples(cls.scene)

    def test_samples_lie_within_the_limits(self):
        scene = copy.copy(self.scene)
        arm, lower, upper = copy.copy(scene.nominal), np.full(6, -1.0), np.array([2.0, 0.5, 1.5, 2.0, 2.0, 0.5])
        joints = list(arm.joints)
        for joint, low, high in zip(joints, lower, upper):
            joint.limits = poecal.JointLimits(lower=low, upper=high)
        arm.joints = joints
        scene.nominal = arm
        q = np.array([sample.q for sample in poecal.drawSamples(scene).samples])
        self.assertEqual(q.shape, (20, 6))
        self.assertTrue((q >= lower).all() and (q <= upper).all())
        free = np.array([sample.q for sample in self.samples.samples])
        self.assertFalse((free >= lower).all() or (free <= upper).all())  # without them it goes further
        self.assertTrue((np.abs(free) <= np.pi).all())

    def predicted(self, leaks):
        """Corners of the true arm, whose joint 5 turns others by these ratios."""
        cell, target, arm = true_cell(self.scene), self.scene.target, self.scene.actual
        poses = [poecal.forwardKinematics(arm, sample.q + leaks * sample.q[4]) for sample in self.samples.samples]
        return [
            poecal.ImageCorners(image=sample.image, corners=poecal.predictCorners(cell, target, pose))
            for sample, pose in zip(self.samples.samples, poses)
        ]

    def test_corners_are_those_of_the_true_cell(self):
        scene = copy.copy(self.scene)
        scene.effects = []
        self.assertLess(cells.largest_distance(poecal.trueCorners(scene, self.samples), self.predicted(np.zeros(6))), 1e-9)

    def test_corners_show_the_effects(self):
        turned = self.predicted(cells.RATIO * np.array([0, 0, 0, 0, 0, 1]))
        self.assertLess(cells.largest_distance(poecal.trueCorners(self.scene, self.samples), turned), 1e-9)


class Captures(unittest.TestCase):
    def test_are_the_program_s(self):
        for looks, jobs in ((CORNERS, 1), (PICTURES, 1), (PICTURES, 2)):
            file = cells.scene_file(looks, 3)
            by_program, by_module = file.with_name("by_program"), file.with_name("by_module")
            cells.done("simulate", file, "--out", by_program)
            summary = poecal.simulate(poecal.readScene(file), by_module, poecal.SimulateOptions(jobs=jobs))
            self.assertEqual(files_of(by_module), files_of(by_program))
            self.assertEqual(summary.truth, cells.truth_of(by_module))
            self.assertEqual(files_of(summary.truth), files_of(cells.truth_of(by_program)))
            self.assertEqual((summary.poses, summary.samples, summary.corners), (3, 3, 12))
            self.assertEqual(summary.pictures, looks == PICTURES)

    def test_a_scene_that_was_changed_is_calibrated_to_its_new_truth(self):
        scene = poecal.readScene(cells.scene_file(CORNERS, 20))
        scene.count, scene.corner_sigma = 40, 0.05
        spec = poecal.EffectSpec(effect="joint_gain", location="joint:3", parameters={"gain": 2e-3})
        scene.effects = [poecal.makeEffect(spec, true_cell(scene))]
        folder = cells.new_folder()
        summary = poecal.simulate(scene, folder / "capture")
        self.assertEqual((summary.samples, summary.corners), (40, 160))
        run = poecal.runCapture(folder / "capture", folder / "out", listener=poecal.Listener())
        finding, = run.calibration.diagnosis.findings
        self.assertEqual((finding.effect, finding.location), ("joint_gain", "joint:3"))
        self.assertLess(abs(finding.parameters["gain"] - 2e-3), 4.0 * finding.standard_deviation["gain"])

    def test_a_full_folder_is_left_alone(self):
        folder = cells.new_folder()
        (folder / "mine.txt").write_text("mine")
        with self.assertRaisesRegex(poecal.FileError, "not empty"):
            poecal.simulate(poecal.readScene(cells.scene_file(CORNERS, 3)), folder)
        self.assertEqual([file.name for file in folder.iterdir()], ["mine.txt"])


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.camera = poecal.readCamera(cells.COBOT / "camera.yaml")
        cls.target = poecal.apriltagTarget("tag36h11", [poecal.TargetTag(id=12, size=0.12)])
        # Upright before the camera and turned a little; the front of a tag looks against its z.
        cls.T = poecal.expSe3([0.3, -0.2, 0.4, 0.0, 0.0, 0.0])
        cls.T[:3, 3] = 0.05, -0.03, 0.6

    def drawn(self, **options):
        return poecal.renderTarget(self.camera, self.target, self.T, poecal.ImageOptions(**options))

    def test_are_arrays_of_bytes(self):
        picture = self.drawn()
        self.assertEqual((picture.shape, picture.dtype), ((self.camera.height, self.camera.width), np.uint8))
        self.assertGreater(np.ptp(picture), 150)

    def test_noise_is_as_large_as_stated_and_of_its_seed(self):
        options = poecal.ImageOptions(blur=0.7, noise=3.0, background="plain")
        first, second = (poecal.renderTarget(self.camera, self.target, self.T, options, seed) for seed in (1, 2))
        still = self.drawn(blur=0.7, noise=0.0, background="plain").astype(float)
        middle = (still > 30) & (still < 225)  # elsewhere noise is cut off at 0 and 255
        self.assertGreater(middle.sum(), 10_000)
        for noisy in (first, second):
            # 3 grey levels, and what rounding twice adds: 1/12 each.
            self.assertAlmostEqual((noisy - still)[middle].std(), np.sqrt(3.0**2 + 2.0 / 12.0), delta=0.05)
        self.assertLess(abs(np.corrcoef((first - still)[middle], (second - still)[middle])[0, 1]), 0.05)

    def test_the_detector_finds_the_corners_where_they_are_projected(self):
        folder = cells.new_folder()
        cells.write_png(folder / "one.png", self.drawn(noise=0.5, background="plain"))
        seen = poecal.detect(folder, ["one.png"], self.target, poecal.DetectOptions(camera=self.camera))
        self.assertEqual(seen.notes, ())
        cell = poecal.Cell(camera=self.camera, registration=poecal.Registration(T_camera_near=self.T))
        projected = poecal.ImageCorners(image="one.png", corners=poecal.predictCorners(cell, self.target, np.eye(4)))
        self.assertLess(cells.largest_distance(seen.detections.images, [projected]), 0.02)  # half a grey level of noise
        look = seen.detections.images[0].look
        self.assertAlmostEqual(look.blur, 0.7, delta=0.02)


if __name__ == "__main__":
    unittest.main()
