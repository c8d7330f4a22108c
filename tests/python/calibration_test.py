"""The main job by the module and by the program is the same, and finds what is true."""
import json
import math
import shutil
import unittest

import numpy as np
import poecal

import cells

WRITTEN = ("registration.yaml", "flange_poses.csv", "identification.json", "diagnosis.json", "model.yaml")


def calibrated():
    return poecal.runCapture(cells.corners_capture(), cells.new_folder() / "out")


class FromFolderToFolder(unittest.TestCase):
    def test_writes_the_bytes_that_the_program_writes(self):
        for jobs in (1, 2):
            out = cells.new_folder() / "out"
            poecal.runCapture(cells.corners_capture(), out, poecal.CalibrateOptions(jobs=jobs))
            for name in WRITTEN:
                self.assertEqual((out / name).read_bytes(), (cells.results() / name).read_bytes(), name)

    def test_writes_what_was_asked_for_alone(self):
        out = cells.new_folder() / "out"
        options = poecal.CalibrateOptions(last=poecal.CalibrationStep.kRegistration)
        done = poecal.runCapture(poecal.CaptureSource(cells.corners_capture()), out, options, poecal.ResultFiles(registration=True))
        self.assertEqual([name for name in WRITTEN if (out / name).exists()], ["registration.yaml", "flange_poses.csv"])
        self.assertIsNone(done.calibration.identification)
        self.assertIsNone(done.calibration.diagnosis)
        self.assertIsNone(done.calibration.model)

    def test_the_model_is_the_one_of_the_file(self):
        kept, read = calibrated().calibration.model, poecal.readModel(cells.results() / "model.yaml")
        q = np.random.default_rng(3).uniform(-1.0, 1.0, (10, 6))
        poses = [poecal.forwardKinematics(model.cell.arm, q) for model in (kept, read)]
        np.testing.assert_allclose(*poses, atol=1e-14, rtol=0)  # the file has gamma as a pose
        self.assertEqual(kept.effects[0].effect.location(), "joint:6")
        np.testing.assert_array_equal(kept.effects[0].parameters, read.effects[0].parameters)

    def test_finds_the_truth(self):
        finding, = calibrated().calibration.diagnosis.findings
        self.assertEqual((finding.effect, finding.location, finding.driver), ("joint_coupling", "joint:6", "q5"))
        self.assertEqual(finding.parameters["source"], 5)
        self.assertLess(abs(finding.parameters["ratio"] - cells.RATIO), 3.0 * finding.standard_deviation["ratio"])
        self.assertTrue(finding.shrinkage.claimed())


class PlainObjects(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.done = calibrated()

    def test_the_ladder_with_its_intervals(self):
        diagnosis = self.done.calibration.diagnosis
        self.assertEqual([stage.stage for stage in diagnosis.stages[:3]], ["nominal", "registered", "identified"])
        for stage in diagnosis.stages:
            low, high = stage.rms_interval
            self.assertTrue(low <= stage.rms <= high, stage)
            self.assertAlmostEqual(stage.excess, math.sqrt(max(0.0, stage.rms**2 - diagnosis.noise_rms**2)), delta=1e-12)

    def test_residuals_are_those_of_the_figures(self):
        for stage in self.done.calibration.identification.stages:
            lengths = np.concatenate([row.lengths for row in stage.held_out_rows])
            self.assertEqual(len(lengths), stage.held_out.corners)
            self.assertAlmostEqual(math.sqrt(np.mean(lengths**2)), stage.held_out.px.rms, delta=1e-12)

    def test_parts_outlive_the_whole(self):
        rows = calibrated().calibration.identification.stages[2].held_out_rows
        np.testing.assert_array_equal(rows[0].lengths, self.done.calibration.identification.stages[2].held_out_rows[0].lengths)

    def test_a_summary_of_a_folder_has_the_same_figures(self):
        summary, diagnosis = poecal.readResults(cells.results()), self.done.calibration.diagnosis
        self.assertEqual(summary.verdict, "effects")
        self.assertEqual(summary.findings[0].location, "joint:6")
        self.assertEqual(summary.shrinkage, diagnosis.shrinkage.value)
        self.assertEqual((summary.shrinkage_low, summary.shrinkage_high), diagnosis.shrinkage.interval)
        self.assertEqual(summary.stage("identified").rms_px, diagnosis.stages[2].errors.px.rms)
        self.assertIsNone(summary.stage("no such stage"))
        self.assertIn("shrinkage=0.", repr(summary))

    def test_sentences(self):
        text = poecal.diagnosisText(self.done.calibration.diagnosis, self.done.measurements.samples)
        self.assertIn("joint:6, driven by q5", text)
        self.assertIn("joint_backlash", poecal.explainEffect(self.done.calibration.diagnosis, "joint_backlash"))


class OtherCalls(unittest.TestCase):
    """Each beside the command that makes the same call."""

    def test_poses_of_an_instrument(self):
        robot, poses = cells.corners_capture() / "cobot6.urdf", cells.results() / "flange_poses.csv"
        links = ("--base-link", "base_link", "--tip-link", "flange")
        by_program, by_module = cells.new_folder(), cells.new_folder()
        cells.done("diagnose", "--robot", robot, *links, "--poses", poses, "--registered", "--out", by_program)
        source = poecal.PosesSource(robot=robot, base_link="base_link", tip_link="flange", poses=poses)
        options = poecal.CalibrateOptions(identify=poecal.IdentifyOptions(registered=True))
        poecal.runPoses(source, by_module, options, poecal.ResultFiles(diagnosis=True))
        for name in ("diagnosis.json", "model.yaml"):
            self.assertEqual((by_module / name).read_bytes(), (by_program / name).read_bytes(), name)

    def test_the_lens(self):
        by_program, by_module = cells.new_folder() / "camera.yaml", cells.new_folder() / "camera.yaml"
        cells.done("intrinsics", cells.board_folder(), "--out", by_program)
        result = poecal.calibrateBoardFolder(cells.board_folder(), poecal.IntrinsicsOptions(), 1, by_module)
        self.assertEqual(by_module.read_bytes(), by_program.read_bytes())
        self.assertEqual(len(result.views), 5)
        truth = poecal.readCamera(cells.COBOT / "camera.yaml")
        camera = result.chosen().camera
        off = np.abs(camera.parameters() - truth.parameters())
        known = np.isfinite(camera.standard_deviation) & (camera.parameters() != 0.0)  # others are held
        self.assertTrue((off < 5.0 * camera.standard_deviation)[known].all(), (off, camera.standard_deviation))
        self.assertGreaterEqual(known.sum(), 4)

    def test_the_report(self):
        out = cells.new_folder() / "out"
        run = poecal.runCapture(cells.corners_capture(), out)
        self.assertEqual(poecal.writeReport(run, cells.corners_capture(), out), "")
        for name in ("report.json", "report.html"):
            self.assertEqual((out / name).read_bytes(), (cells.results() / name).read_bytes(), name)

    def test_a_check(self):
        check = poecal.checkCapture(cells.corners_capture())
        said = json.loads(cells.done("check", cells.corners_capture(), "--json"))["items"]
        self.assertEqual([(item.topic, item.text) for item in check.items], [(item["topic"], item["text"]) for item in said])
        self.assertEqual(check.exitStatus(), 0)
        self.assertEqual(check.items[0].level, poecal.CheckLevel.kOk)

    def test_a_new_capture(self):
        folder = cells.new_folder() / "capture"
        robot, target, camera = (cells.COBOT / name for name in ("cobot6.urdf", "target.yaml", "camera.yaml"))
        new = poecal.NewCapture(folder=folder, robot=robot, target=target, camera=camera, base_link="base_link", tip_link="flange")
        written = poecal.createCapture(new)
        self.assertTrue(all(file.is_file() for file in written))
        self.assertIn(folder / "samples.csv", written)
        self.assertEqual(poecal.checkCapture(folder).exitStatus(), 4)  # there is no picture yet

    def test_texts_are_those_of_the_files(self):
        run = calibrated()
        calibration, measurements = run.calibration, run.measurements
        for name, text in {
            "registration.yaml": poecal.registrationYaml(calibration, measurements),
            "flange_poses.csv": poecal.flangePosesCsv(calibration, measurements),
            "identification.json": poecal.identificationJson(calibration.identification, measurements.samples),
            "diagnosis.json": poecal.diagnosisJson(calibration, measurements),
            "model.yaml": poecal.modelYaml(calibration.model),
        }.items():
            self.assertEqual(text, (cells.results() / name).read_text(), name)
        out = cells.new_folder()
        poecal.writeResults(calibration, measurements, poecal.ResultFiles(identification=True), out)
        self.assertEqual(sorted(file.name for file in out.iterdir()), ["identification.json", "model.yaml"])

    def test_a_fleet(self):
        again = cells.new_folder() / "again"
        shutil.copytree(cells.results(), again)
        summaries = [poecal.readResults(cells.results()), poecal.readResults(again)]
        table = cells.new_folder() / "fleet.csv"
        cells.done("fleet", cells.results(), again, "--out", table)
        self.assertEqual(poecal.fleetCsv(summaries), table.read_text())
        self.assertEqual(poecal.fleetText(summaries).count("joint_coupling at joint:6"), 2)
        row = dict(zip(poecal.fleetColumns(), poecal.fleetRow(summaries[0])))
        self.assertEqual(row["pictures"], "60")

    def test_pages(self):
        if not poecal.reportBuilt():
            with self.assertRaisesRegex(poecal.InvalidArgument, "D3"):
                poecal.fleetHtml([], "fleet.html")
            self.skipTest("this build makes no pages")
        page = cells.new_folder() / "fleet.html"
        cells.done("fleet", cells.results(), "--out", page.with_suffix(".csv"), "--page", page)
        self.assertEqual(poecal.fleetHtml([poecal.readResults(cells.results())], page), page.read_text())
        out = cells.new_folder()
        for file in ("report.json", "report.html"):
            (out / file).write_bytes((cells.results() / file).read_bytes())
        (out / "report.html").unlink()
        poecal.renderReport(out)
        self.assertEqual((out / "report.html").read_bytes(), (cells.results() / "report.html").read_bytes())
        with self.assertRaisesRegex(poecal.FileError, "report.json: there is none"):
            poecal.renderReport(cells.new_folder())

    def test_report_data_are_the_program_s(self):
        told = json.loads((cells.results() / "report.json").read_text())
        self.assertEqual(json.loads(poecal.reportJson(calibrated(), told["pictures"])), told)


class FromMemory(unittest.TestCase):
    def test_arrays_give_the_model_that_files_give(self):
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        samples, points = loaded.measurements.samples, loaded.measurements.target.points
        px = np.full((len(samples), len(points), 2), np.nan)
        with open(cells.corners_capture() / "detections.csv") as file:
            names = [sample.image for sample in samples]
            for line in file.readlines()[1:]:
                image, tag, corner, u, v, _ = line.split(",")
                place = [point.id == poecal.PointId(tag=int(tag), corner=int(corner)) for point in points].index(True)
                px[names.index(image), place] = float(u), float(v)
        self.assertFalse(np.isnan(px).any())
        table = poecal.sampleTable(
            np.array([sample.q for sample in samples]),
            dir=[sample.dir for sample in samples],
            pose=[sample.pose for sample in samples],
            stamp=[sample.stamp for sample in samples],
        )
        measurements = poecal.Measurements(target=loaded.capture.target)
        measurements.addPictures(table, px, sigma=0.1)
        calibration = poecal.calibrate(loaded.nominal, measurements)
        files = calibrated().calibration
        self.assertEqual(poecal.robotYaml(calibration.model.cell.arm), poecal.robotYaml(files.model.cell.arm))
        self.assertEqual(calibration.diagnosis.findings[0].parameters, files.diagnosis.findings[0].parameters)

    def test_the_steps_by_themselves_are_the_whole(self):
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        nominal, measurements = loaded.nominal, loaded.measurements
        registration = poecal.registerCell(nominal, measurements.observations)
        identification = poecal.identify(nominal, measurements, registration=registration)
        diagnosis = poecal.diagnose(identification, measurements, poecal.DiagnoseOptions(jobs=2))
        whole = poecal.calibrate(nominal, measurements)
        self.assertEqual(registration.rms_px, whole.registration.rms_px)
        texts = [poecal.identificationJson(one, measurements.samples) for one in (identification, whole.identification)]
        self.assertEqual(*texts)
        texts = [poecal.diagnosisText(one, measurements.samples) for one in (diagnosis, whole.diagnosis)]
        self.assertEqual(*texts)
        self.assertEqual(poecal.modelYaml(diagnosis.model), poecal.modelYaml(whole.diagnosis.model))

    def test_observations_are_what_was_seen(self):
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        measurements, camera = loaded.measurements, loaded.nominal.camera
        one = measurements.observations[7]
        np.testing.assert_array_equal(one.q, measurements.samples[one.sample].q)
        by_id = {point.id: point.p_target for point in measurements.target.points}
        for corner in one.corners:
            np.testing.assert_array_equal(corner.p_target, by_id[corner.id])
            self.assertTrue((corner.px > 0.0).all() and (corner.px < [camera.width, camera.height]).all())
        again = poecal.Measurements(target=measurements.target, samples=measurements.samples, observations=measurements.observations)
        self.assertEqual(again.poseGroups(), measurements.poseGroups())

    def test_an_instrument_s_poses_show_the_arm(self):
        nominal = poecal.readArm(cells.COBOT / "cobot6.urdf", "base_link", "flange")
        true = poecal.readRobotYaml(cells.truth_of(cells.corners_capture()) / "actual.yaml")
        numbers = np.random.default_rng(5)
        q = numbers.uniform(-1.5, 1.5, (40, 6))
        measurements = poecal.Measurements()
        measurements.addPoses(poecal.sampleTable(q), poecal.forwardKinematics(true, q), 1e-6, 1e-6)
        options = poecal.CalibrateOptions(
            last=poecal.CalibrationStep.kIdentification, identify=poecal.IdentifyOptions(registered=True, method=poecal.Method.kBundle)
        )
        arm = poecal.calibrate(poecal.Cell(arm=nominal), measurements, options).model.cell.arm
        unseen = numbers.uniform(-1.5, 1.5, (20, 6))
        error = poecal.forwardKinematics(arm, unseen) - poecal.forwardKinematics(true, unseen)
        before = poecal.forwardKinematics(nominal, unseen) - poecal.forwardKinematics(true, unseen)
        self.assertGreater(np.abs(before).max(), 1e-3)
        # Exact poses; the tolerances of 1e-3 m and 3e-3 rad pull with (1e-6 / 1e-3)^2 of an error that is as large as they are.
        self.assertLess(np.abs(error).max(), 1e-7)

    def test_shapes_of_corners(self):
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        measurements, table = poecal.Measurements(target=loaded.capture.target), poecal.sampleTable(np.zeros((2, 6)))
        for shape, words in {
            (2, 4): r"expected an array of shape \(N, n, 2\), got \(2, 4\)",
            (2, 4, 3): r"expected an array of shape \(N, n, 2\), got \(2, 4, 3\)",
            (3, 4, 2): "3 pictures for 2 samples",
            (2, 5, 2): "picture 0: 5 corners, expected 4",
        }.items():
            with self.assertRaisesRegex(ValueError, words):
                measurements.addPictures(table, np.zeros(shape))
        with self.assertRaisesRegex(ValueError, r"expected an array of shape \(N, 4, 4\), got \(2, 3, 4\)"):
            measurements.addPoses(table, np.zeros((2, 3, 4)))


if __name__ == "__main__":
    unittest.main()
