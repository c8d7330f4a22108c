"""The paper's experiment from Python is the program's."""
import json
import unittest

import numpy as np
import poecal

import cells

PUMA = cells.SOURCE / "calib_data/puma560"


def arms():
    return (poecal.readRobotYaml(PUMA / name) for name in ("robot.yaml", "actual.yaml"))


class Experiment(unittest.TestCase):
    def test_has_the_figures_of_the_program(self):
        seeds = poecal.paperExperiment(*arms(), poecal.PaperOptions(seeds=3))
        said = json.loads(cells.done("paper", PUMA, "--seeds", 3, "--json"))
        self.assertEqual(list(seeds[0].gao.residuals), said["rms_y"])
        for name, errors in {
            "nominal": [seed.nominal for seed in seeds],
            "gao": [seed.gao.error for seed in seeds],
            "weighted": [seed.weighted.error for seed in seeds],
        }.items():
            figures = said["unseen_poses"][name]
            self.assertAlmostEqual(1e3 * np.median([error.position for error in errors]), figures["position_mm"], delta=1e-12)
            self.assertAlmostEqual(np.median([error.rotation for error in errors]), figures["rotation_rad"], delta=1e-15)

    def test_gives_the_arm_back_where_there_is_no_noise(self):
        nominal, actual = arms()
        seed, = poecal.paperExperiment(nominal, actual, poecal.PaperOptions(seeds=1, test_poses=7, noise_position=0.0, noise_rotation=0.0))
        self.assertEqual((len(seed.gao.test_poses), len(seed.nominal_test_poses)), (7, 7))
        self.assertGreater(seed.nominal.position, 1e-3)
        for fit in (seed.gao, seed.weighted):
            self.assertLess(max(error.position for error in fit.test_poses), 1e-9)
        q = np.random.default_rng(3).uniform(-3.0, 3.0, (5, 6))
        off = poecal.forwardKinematics(seed.weighted.arm, q) - poecal.forwardKinematics(actual, q)
        self.assertLess(np.abs(off).max(), 1e-9)

    def test_measures_with_the_noise_that_it_is_told(self):
        _, actual = arms()
        options = poecal.PaperOptions(poses=200, noise_position=2e-3, noise_rotation=0.0)
        poses = poecal.paperPoses(actual, options, seed=4).poses
        q = np.array([pose.sample.q for pose in poses])
        off = np.array([pose.T_instrument_tool for pose in poses]) - poecal.forwardKinematics(actual, q)
        self.assertLess(np.abs(off[:, :3, :3]).max(), 1e-12)
        # Of 600 uniform numbers the largest is beyond 0.97 of the half width but for once in 10^7.
        self.assertGreater(np.abs(off[:, :3, 3]).max(), 0.97 * 2e-3)
        self.assertLessEqual(np.abs(off[:, :3, 3]).max(), 2e-3 + 1e-12)


if __name__ == "__main__":
    unittest.main()
