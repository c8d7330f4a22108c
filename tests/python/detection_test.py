"""Corners found from Python are the true ones, and the program's."""
import shutil
import unittest

import numpy as np
import poecal

import cells


def truth():
    target = poecal.readTarget(cells.COBOT / "target.yaml")
    return poecal.readDetections(cells.truth_of(cells.pictures_capture()) / "corners.csv", target).images


def detected(**options):
    return poecal.detectCapture(poecal.readCapture(cells.pictures_capture()), poecal.DetectOptions(**options))


class OfACapture(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = detected()

    def test_are_the_true_ones_to_their_sigma(self):
        true, seen = cells.corners_of(truth()), self.result.detections.images
        self.assertEqual(cells.corners_of(seen).keys(), true.keys())
        off = [
            (corner.px - true[one.image, corner.id.tag, corner.id.corner]) / corner.sigma for one in seen for corner in one.corners
        ]
        # Of 48 corners of 12 tags, whose four corners share two numbers: mean square 1 with a deviation of about sqrt(2 / 48).
        self.assertLess(abs(np.mean(np.square(off)) - 1.0), 4.0 * np.sqrt(2.0 / 48.0))

    def test_say_what_the_pictures_look_like(self):
        look = poecal.medianLook([one.look for one in self.result.detections.images])
        self.assertAlmostEqual(look.blur, 0.7, delta=0.02)
        self.assertAlmostEqual(look.noise, 2.0, delta=0.1)
        self.assertIsNone(poecal.medianLook([]))
        file = cells.new_folder() / "pictures.csv"
        file.write_text(poecal.picturesCsv(self.result.detections))
        self.assertEqual(len(poecal.readPictureLooks(file)), 12)

    def test_are_the_program_s(self):
        file = cells.new_folder() / "detections.csv"
        cells.done("detect", cells.pictures_capture(), "--out", file)
        for jobs in (1, 2):
            self.assertEqual(poecal.detectionsCsv(detected(jobs=jobs).detections), file.read_text())

    def test_are_read_again(self):
        file = cells.new_folder() / "detections.csv"
        file.write_text(poecal.detectionsCsv(self.result.detections))
        read = poecal.readDetections(file, poecal.readCapture(cells.pictures_capture()).target)
        self.assertEqual(poecal.detectionsCsv(read), file.read_text())
        name = read.images[3].image
        self.assertEqual(len(read.find(name).corners), 4)
        self.assertIsNone(read.find("no such picture"))

    def test_register_the_cell(self):
        capture = poecal.readCapture(cells.pictures_capture())
        measurements = poecal.measurementsOf(capture, self.result.detections)
        nominal = poecal.Cell(arm=capture.arm, camera=capture.camera)
        registered = poecal.registerCell(nominal, measurements.observations).cell.registration
        scene = poecal.readScene(cells.pictures_capture().with_name("scene.yaml"))
        # What the nominal arm's errors of 0.6 mm and 2 mrad leave of twelve poses.
        off = poecal.logSe3(registered.T_far_target @ np.linalg.inv(scene.registration.T_far_target))
        self.assertLess(np.linalg.norm(off[3:]), 5e-3)
        self.assertLess(np.linalg.norm(off[:3]), 1e-2)

    def test_one_picture_that_cannot_be_read_is_a_remark(self):
        capture = cells.new_folder() / "capture"
        shutil.copytree(cells.pictures_capture(), capture)
        picture = sorted((capture / "images").iterdir())[4]
        picture.write_bytes(picture.read_bytes()[:200])
        result = poecal.detectCapture(poecal.readCapture(capture))
        note, = result.notes
        self.assertTrue(note.failed and note.image.endswith(picture.name))
        self.assertEqual(poecal.texts(result.notes), [note.text()])
        self.assertEqual(len(result.detections.find(note.image).corners), 0)


class OfACameraWithoutASize(unittest.TestCase):
    def capture(self):
        folder = cells.new_folder() / "capture"
        shutil.copytree(cells.pictures_capture(), folder)
        lines = (folder / "camera.yaml").read_text().splitlines()
        kept = [line for line in lines if not line.startswith(("image_width", "image_height"))]
        self.assertEqual(len(kept), len(lines) - 2)
        (folder / "camera.yaml").write_text("\n".join(kept) + "\n")
        return folder

    def test_takes_that_of_the_pictures(self):
        capture = poecal.readCapture(self.capture())
        self.assertEqual((capture.camera.width, capture.camera.height), (0, 0))
        poecal.takeSizeFromPictures(capture)
        known = poecal.readCapture(cells.pictures_capture()).camera
        self.assertEqual((capture.camera.width, capture.camera.height), (known.width, known.height))
        self.assertEqual(len(poecal.detectCapture(capture).notes), 0)

    def test_needs_a_picture(self):
        folder = self.capture()
        shutil.rmtree(folder / "images")
        with self.assertRaisesRegex(poecal.FileError, "states no image_width"):
            poecal.takeSizeFromPictures(poecal.readCapture(folder))


class OfPictures(unittest.TestCase):
    def test_are_searched_once(self):
        folder, file = cells.pictures_capture() / "images", cells.new_folder() / "known.corners"
        target, camera = poecal.readTarget(cells.COBOT / "target.yaml"), poecal.readCamera(cells.COBOT / "camera.yaml")
        names = poecal.listPictures(folder)
        self.assertEqual(len(names), 12)
        found = []
        for reused in (0, 12):
            known = poecal.KnownCorners(file)
            found.append(poecal.detect(folder, names, target, poecal.DetectOptions(camera=camera), known))
            known.finish()
            self.assertEqual(known.reused(), reused)
        first, second = (poecal.detectionsCsv(one.detections) for one in found)
        self.assertEqual(first, second)
        self.assertEqual((found[1].width, found[1].height), (camera.width, camera.height))

    def test_have_corners_only_of_their_own_family(self):
        self.assertLessEqual({"tag36h11", "tag25h9"}, set(poecal.knownFamilies()))
        target = poecal.apriltagTarget("tag25h9", [poecal.TargetTag(id=12, size=0.12)])
        folder = cells.pictures_capture() / "images"
        result = poecal.detect(folder, poecal.listPictures(folder)[:2], target)
        self.assertEqual([len(one.corners) for one in result.detections.images], [0, 0])
        self.assertIn("tag36h11", result.notes[-1].message)

    def test_options_are_validated(self):
        with self.assertRaisesRegex(poecal.InvalidArgument, "jobs is -1"):
            detected(jobs=-1)


class OfBoards(unittest.TestCase):
    def off(self, fit):
        camera = poecal.readCamera(cells.COBOT / "camera.yaml")
        return np.abs(fit.camera.parameters() - camera.parameters())

    def test_show_the_lens(self):
        board = poecal.readBoardPictures(cells.board_folder())
        self.assertEqual((len(board.views), board.target.type), (5, poecal.TargetType.kCharuco))
        view = board.views[0]
        self.assertEqual((view.points.shape[0], view.pixels.shape), (3, (2, view.points.shape[1])))
        fit = poecal.calibrateIntrinsics(board.views, board.width, board.height).chosen()
        known = np.isfinite(fit.camera.standard_deviation) & (fit.camera.parameters() != 0.0)
        self.assertTrue((self.off(fit) < 5.0 * fit.camera.standard_deviation)[known].all())

    def test_made_of_arrays_give_the_lens_back(self):
        camera = poecal.readCamera(cells.COBOT / "camera.yaml")
        target = poecal.chessboardTarget(9, 6, 0.04)
        p_target = np.array([point.p_target for point in target.points]).T
        views = []
        for turn in np.random.default_rng(2).uniform(-0.5, 0.5, (8, 3)):
            T = poecal.expSe3([*turn, 0.0, 0.0, 0.0])
            T[:3, 3] = [0.0, 0.0, 0.7] - T[:3, :3] @ p_target.mean(axis=1)
            cell = poecal.Cell(camera=camera, registration=poecal.Registration(T_camera_near=T))
            pixels = np.array([corner.px for corner in poecal.predictCorners(cell, target, np.eye(4))]).T
            views.append(poecal.BoardView(image=str(turn), points=p_target, pixels=pixels))
        options = poecal.IntrinsicsOptions(model=camera.model)
        fit = poecal.calibrateIntrinsics(views, camera.width, camera.height, options).chosen()
        self.assertLess(fit.rms_px, 1e-6)
        self.assertLess(self.off(fit).max(), 1e-4)


if __name__ == "__main__":
    unittest.main()
