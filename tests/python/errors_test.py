"""Exceptions have the names of C++ and the exit status of the program."""
import shutil
import unittest

import numpy as np
import poecal

import cells


class Errors(unittest.TestCase):
    def fails(self, error, words, call, *arguments):
        with self.assertRaisesRegex(error, words) as caught:
            call(*arguments)
        self.assertIs(type(caught.exception), error)
        return caught.exception

    def test_every_error_is_an_error_of_poecal(self):
        for name in ("InvalidArgument", "FileError", "ImplausibleInput", "ImplausibleCapture", "OutOfMemory", "InsufficientData"):
            self.assertTrue(issubclass(getattr(poecal, name), poecal.Error), name)
        self.assertTrue(issubclass(poecal.InvalidArgument, ValueError))
        self.assertTrue(issubclass(poecal.OutOfMemory, MemoryError))
        self.assertTrue(issubclass(poecal.ImplausibleCapture, poecal.ImplausibleInput))

    def test_a_bad_file_is_told_as_the_program_tells_it(self):
        capture = cells.new_folder() / "capture"
        shutil.copytree(cells.corners_capture(), capture)
        manifest = capture / "capture.yaml"
        manifest.write_text(manifest.read_text() + "robott: arm.yaml\n")
        error = self.fails(poecal.FileError, r"capture\.yaml:\d+: ", poecal.readCapture, capture)
        run = cells.program("run", capture, "--out", cells.new_folder() / "out")
        self.assertEqual(run.returncode, error.exitStatus())
        self.assertEqual(run.stderr, f"poecal: error: {error}\n")

    def test_too_little_data(self):
        capture = cells.new_folder() / "capture"
        shutil.copytree(cells.corners_capture(), capture)
        rows = (capture / "samples.csv").read_text().splitlines(keepends=True)
        (capture / "samples.csv").write_text("".join(rows[:3]))
        out = cells.new_folder() / "out"
        error = self.fails(poecal.InsufficientData, "poses", poecal.runCapture, capture, out)
        self.assertEqual(error.exitStatus(), 4)
        self.assertEqual(cells.program("run", capture, "--out", out).returncode, 4)
        self.assertFalse((out / "model.yaml").exists())

    def test_a_result_never_replaces_an_input(self):
        capture = cells.new_folder() / "capture"
        shutil.copytree(cells.corners_capture(), capture)
        (capture / "camera.yaml").rename(capture / "model.yaml")
        manifest = capture / "capture.yaml"
        manifest.write_text(manifest.read_text().replace("camera: camera.yaml", "camera: model.yaml"))
        before = (capture / "model.yaml").read_bytes()
        error = self.fails(poecal.InvalidArgument, "model.yaml", poecal.runCapture, capture, capture)
        self.assertEqual(error.exitStatus(), 2)
        self.assertEqual((capture / "model.yaml").read_bytes(), before)

    def test_options_are_validated(self):
        error = self.fails(
            poecal.InvalidArgument, "jobs is -1", poecal.calibrate, poecal.Cell(), poecal.Measurements(), poecal.CalibrateOptions(jobs=-1)
        )
        self.assertEqual(error.exitStatus(), 2)
        self.assertEqual(error.exit_status(), 2)

    def test_joints_in_degrees_are_suspected(self):
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        measurements = poecal.Measurements(target=loaded.capture.target)
        truth = poecal.readModel(cells.results() / "model.yaml").cell
        table = poecal.sampleTable(np.rad2deg([sample.q for sample in loaded.measurements.samples]))
        for sample, in_degrees in zip(loaded.measurements.samples, table.samples):
            corners = poecal.predictCorners(truth, loaded.capture.target, poecal.forwardKinematics(truth.arm, sample.q))
            measurements.addPicture(in_degrees, corners)
        error = self.fails(poecal.ImplausibleCapture, "degrees", poecal.calibrate, loaded.nominal, measurements)
        self.assertEqual(error.part(), poecal.InputPart.kSamples)
        self.assertIsNone(error.sample())
        self.assertEqual(error.exitStatus(), 3)


if __name__ == "__main__":
    unittest.main()
