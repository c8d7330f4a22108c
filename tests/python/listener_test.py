"""Long calls tell Python how far they are, let its other threads run, and stop where it says so."""
import copy
import shutil
import signal
import sys
import threading
import time
import unittest
import warnings
import weakref

import numpy as np
import poecal

import cells


class Heard(poecal.Listener):
    def __init__(self):
        super().__init__()
        self.told, self.warned = [], []

    def warning(self, message):
        self.warned.append(message)

    def progress(self, label, done, total):
        self.told.append((label, done, total))


class Stops(poecal.Listener):
    """Does something at the third picture."""

    def __init__(self, action):
        super().__init__()
        self.action, self.told = action, []

    def progress(self, label, done, total):
        self.told.append((done, total))
        if done == 3:
            self.action()


def spoilt_capture():
    capture = cells.new_folder() / "capture"
    shutil.copytree(cells.pictures_capture(), capture)
    picture = sorted((capture / "images").iterdir())[4]
    picture.write_bytes(picture.read_bytes()[:200])
    return capture, picture.name


class Told(unittest.TestCase):
    def test_each_picture_counts_once(self):
        for jobs in (1, 2):
            listener = Heard()
            poecal.loadCapture(cells.pictures_capture(), cells.new_folder() / "out", jobs, listener)
            self.assertEqual([done for _, done, _ in listener.told], list(range(1, 13)))
            self.assertEqual({total for _, _, total in listener.told}, {12})
            self.assertEqual(listener.warned, [])

    def test_a_picture_that_cannot_be_read_is_a_warning(self):
        capture, name = spoilt_capture()
        listener = Heard()
        poecal.loadCapture(capture, cells.new_folder() / "out", listener=listener)
        self.assertEqual(len([message for message in listener.warned if name in message]), 1, listener.warned)

    def test_without_a_listener_it_is_a_warning_of_python(self):
        capture, name = spoilt_capture()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            poecal.loadCapture(capture, cells.new_folder() / "out")
        self.assertEqual(len([one for one in caught if name in str(one.message)]), 1, caught)
        with warnings.catch_warnings(), self.assertRaisesRegex(UserWarning, name):
            warnings.simplefilter("error")
            poecal.loadCapture(capture, cells.new_folder() / "out")


class OfCommands(unittest.TestCase):
    def test_each_row_counts_once_and_may_be_the_last(self):
        def refuse():
            raise LookupError("enough")

        arm, listener = poecal.realArm(poecal.readModel(cells.results() / "model.yaml")), Heard()
        q = np.random.default_rng(5).uniform(-1.0, 0.0, (8, 6))
        wanted = poecal.sampleTable(q, T_base_flange=poecal.forwardKinematics(arm.arm, q), dir=np.ones((8, 6)))
        commands = poecal.compensate(arm, wanted, listener=listener)
        self.assertEqual([heard[1:] for heard in listener.told], [(k + 1, 8) for k in range(8)])
        np.testing.assert_array_equal([one.q for one in commands], [one.q for one in poecal.compensate(arm, wanted)])
        with self.assertRaisesRegex(LookupError, "enough"):
            poecal.compensate(arm, wanted, listener=Stops(refuse))


class OfAReport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_of_60 = poecal.runCapture(cells.corners_capture(), cells.new_folder() / "out")

    def write(self, out, listener):
        return poecal.writeReport(self.run_of_60, cells.corners_capture(), out, listener=listener)

    def test_each_picture_counts_once(self):
        listener, out = Heard(), cells.new_folder() / "out"
        self.assertEqual(self.write(out, listener), "")
        self.assertEqual([heard[1:] for heard in listener.told], [(k + 1, 60) for k in range(60)])
        self.assertTrue((out / "report.html").exists())

    def test_a_listener_stops_it(self):
        def refuse():
            raise LookupError("enough")

        out = cells.new_folder() / "out"
        with self.assertRaisesRegex(LookupError, "enough"):
            self.write(out, Stops(refuse))
        self.assertFalse((out / "report.html").exists())


class Stopped(unittest.TestCase):
    def stopped(self, action, error, jobs):
        listener, out = Stops(action), cells.new_folder() / "out"
        with self.assertRaises(error) as caught:
            poecal.runCapture(cells.pictures_capture(), out, poecal.CalibrateOptions(jobs=jobs), listener=listener)
        self.assertFalse((out / "model.yaml").exists())
        return listener, caught.exception

    def test_an_exception_of_the_listener_comes_out(self):
        def refuse():
            raise LookupError("enough")

        for jobs in (1, 2):
            _, error = self.stopped(refuse, LookupError, jobs)
            self.assertEqual(error.args, ("enough",))

    def test_nothing_more_is_worked_on(self):
        def refuse():
            raise LookupError("enough")

        listener, _ = self.stopped(refuse, LookupError, 1)
        self.assertEqual(listener.told, [(1, 12), (2, 12), (3, 12), (0, 0)])  # (0, 0): the job has failed

    def test_control_c_stops_it(self):
        listener, _ = self.stopped(lambda: signal.raise_signal(signal.SIGINT), KeyboardInterrupt, 1)
        self.assertEqual(listener.told[-1], (0, 0))

    def test_a_signal_stops_it_where_nobody_listens(self):
        def interrupt(*_):
            raise KeyboardInterrupt

        before, out = signal.signal(signal.SIGALRM, interrupt), cells.new_folder() / "out"
        try:
            with self.assertRaises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, 1e-3)  # less than a picture takes
                poecal.runCapture(cells.pictures_capture(), out)
        finally:
            signal.signal(signal.SIGALRM, before)
        self.assertFalse((out / "model.yaml").exists())

    def test_a_listener_that_fails_at_the_end_of_a_failure_does_not_hide_it(self):
        class Fails(poecal.Listener):
            def progress(self, label, done, total):
                raise LookupError("first" if total > 0 else "second")

        heard = []
        hook, sys.unraisablehook = sys.unraisablehook, heard.append
        try:
            with self.assertRaisesRegex(LookupError, "first"):
                poecal.loadCapture(cells.pictures_capture(), cells.new_folder() / "out", 1, Fails())
        finally:
            sys.unraisablehook = hook
        self.assertEqual([str(one.exc_value) for one in heard], ["second"])


class InOptions(unittest.TestCase):
    """Every long call whose options have `progress` tells a callable, and is stopped by it and by Ctrl-C."""

    @classmethod
    def setUpClass(cls):
        capture, board = cells.pictures_capture(), cells.board_folder()
        picture = poecal.readCapture(capture)
        names, folder = poecal.listPictures(capture / "images"), capture / "images"
        scene = poecal.readScene(cells.scene_file("image: {blur: 0.7, noise: 2.0, background: plain}", 4))
        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        nominal, measurements = loaded.nominal, loaded.measurements
        found = poecal.identify(nominal, measurements)
        boards = poecal.readBoardPictures(board)
        many = copy.copy(scene)
        many.count = 5000
        cell = poecal.readPlanningCell(poecal.PlanSource(capture=cells.corners_capture(), model=cells.results() / "model.yaml"))

        def calibrated(**told):
            return poecal.calibrateIntrinsics(boards.views, boards.width, boards.height, poecal.IntrinsicsOptions(**told))

        def simulated(**told):
            return poecal.simulate(scene, cells.new_folder() / "capture", poecal.SimulateOptions(jobs=1, **told))

        cls.calls = {
            "calibrate": lambda **told: poecal.calibrate(nominal, measurements, poecal.CalibrateOptions(**told)),
            "registerCell": lambda **told: poecal.registerCell(nominal, measurements.observations, poecal.RegistrationOptions(**told)),
            "identify": lambda **told: poecal.identify(nominal, measurements, poecal.IdentifyOptions(**told)),
            "diagnose": lambda **told: poecal.diagnose(found, measurements, poecal.DiagnoseOptions(**told)),
            "detectCapture": lambda **told: poecal.detectCapture(picture, poecal.DetectOptions(jobs=1, **told)),
            "detect": lambda **told: poecal.detect(folder, names, picture.target, poecal.DetectOptions(jobs=1, **told)),
            "readBoardPictures": lambda **told: poecal.readBoardPictures(board, poecal.DetectOptions(jobs=1, **told)),
            "simulate": simulated,
            "calibrateIntrinsics": calibrated,
            "checkCapture": lambda **told: poecal.checkCapture(capture, poecal.CheckOptions(detect=12, **told)),
            "drawSamples": lambda **told: poecal.drawSamples(many, poecal.SimulateOptions(**told)),
            "planPoses": lambda **told: poecal.planPoses(cell, poecal.PlanOptions(count=4, candidates=100, **told)),
        }  # fmt: skip

    def for_each(self, check):
        for name, call in self.calls.items():
            with self.subTest(name):
                check(call)

    def test_a_callable_is_told_until_all_is_done(self):
        def check(call):
            told = []
            call(progress=lambda *heard: told.append(heard))
            jobs = {label: [heard[1:] for heard in told if heard[0] == label] for label in {heard[0] for heard in told}}
            self.assertGreater(len(jobs), 0)
            for heard in jobs.values():
                self.assertEqual(heard[-1][0], heard[-1][1], jobs)

        self.for_each(check)

    def test_its_exception_comes_out(self):
        def refuse(label, done, total):
            if total > 0:
                raise LookupError("enough")

        def check(call):
            with self.assertRaisesRegex(LookupError, "enough"):
                call(progress=refuse)

        self.for_each(check)

    def test_a_signal_stops_it_where_nobody_is_told(self):
        def interrupt(*_):
            raise KeyboardInterrupt

        def check(call):
            begin = time.process_time()
            call()
            whole, begin = time.process_time() - begin, time.process_time()
            with self.assertRaises(KeyboardInterrupt):
                signal.setitimer(signal.ITIMER_REAL, 1e-3)
                call()
            # Python sees the signal at the end of the call in any case.
            self.assertLess(time.process_time() - begin, 0.7 * whole)

        before = signal.signal(signal.SIGALRM, interrupt)
        try:
            self.for_each(check)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)

    def test_the_jobs_may_be_shared_out(self):
        told, pieces = [], poecal.SimulateOptions(jobs=2, progress=lambda *heard: told.append(heard))
        scene = poecal.readScene(cells.scene_file("image: {blur: 0.7, noise: 2.0, background: plain}", 4))
        poecal.simulate(scene, cells.new_folder() / "capture", pieces)
        for label in ("drawing poses", "drawing"):
            self.assertEqual([done for each, done, _ in told if each == label], [1, 2, 3, 4])

    def test_what_was_set_is_read_and_copied(self):
        def told(label, done, total):
            pass

        kinds = (
            poecal.CalibrateOptions, poecal.CheckOptions, poecal.DetectOptions, poecal.IntrinsicsOptions, poecal.PlanOptions,
            poecal.SimulateOptions,
        )  # fmt: skip
        for kind in kinds:
            options = kind(progress=told)
            self.assertIs(options.progress, told)
            self.assertIs(copy.deepcopy(options).progress, told)
            options.progress = None
            self.assertIsNone(options.progress)
            with self.assertRaises(TypeError):
                options.progress = "no function"

    def test_a_callable_is_let_go(self):
        class Told:
            def __call__(self, label, done, total):
                pass

        told = Told()
        gone = weakref.ref(told)
        poecal.detectCapture(poecal.readCapture(cells.pictures_capture()), poecal.DetectOptions(jobs=2, progress=told))
        del told
        self.assertIsNone(gone())

    def test_one_that_fails_at_the_end_of_a_failure_does_not_hide_it(self):
        def fails(label, done, total):
            raise LookupError("first" if total > 0 else "second")

        heard = []
        hook, sys.unraisablehook = sys.unraisablehook, heard.append
        try:
            with self.assertRaisesRegex(LookupError, "first"):
                poecal.detectCapture(poecal.readCapture(cells.pictures_capture()), poecal.DetectOptions(jobs=1, progress=fails))
        finally:
            sys.unraisablehook = hook
        self.assertEqual([str(one.exc_value) for one in heard], ["second"])


class OtherThreads(unittest.TestCase):
    def test_run_meanwhile(self):
        # With this interval nobody gets Python's lock who is not given it: by the sleeping thread below, and by a long call.
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000.0)
        counted, stop, ready = [0], threading.Event(), threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                ready.set()
                stop.wait(1e-4)

        loaded = poecal.loadCapture(cells.corners_capture(), cells.new_folder() / "out")
        thread = threading.Thread(target=count)
        try:
            thread.start()
            ready.wait()
            before = counted[0]
            poecal.calibrate(loaded.nominal, loaded.measurements)
            after = counted[0]
        finally:
            sys.setswitchinterval(interval)
            stop.set()
            thread.join()
        self.assertGreater(after, before + 1)


if __name__ == "__main__":
    unittest.main()
