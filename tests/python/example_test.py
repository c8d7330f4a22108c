"""What people are shown runs."""
import importlib.util
import os
import subprocess
import sys
import unittest

import cells


def run(script, *arguments, folder):
    return subprocess.run([sys.executable, script, *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=120)


class Examples(unittest.TestCase):
    def test_the_one_of_the_readme(self):
        folder = cells.new_folder()
        os.symlink(cells.corners_capture(), folder / "capture")
        shown = run(cells.SOURCE / "tests/python/readme_example.py", folder=folder)
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("joint_coupling at joint:6", shown.stdout)
        self.assertEqual((folder / "out/model.yaml").read_bytes(), (cells.results() / "model.yaml").read_bytes())

    def test_the_one_with_plots(self):
        out = cells.new_folder() / "out"
        shown = run(cells.SOURCE / "apps/python/example.py", cells.corners_capture(), out, folder=cells.new_folder())
        self.assertIn("where: joint:6, driven by q5", shown.stdout)
        if importlib.util.find_spec("matplotlib") is None:
            self.assertIn("no plots: matplotlib is not installed", shown.stderr)
            return
        self.assertEqual(shown.returncode, 0, shown.stderr)
        for name in ("ladder.png", "residuals.png"):
            self.assertEqual((out / name).read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            self.assertGreater((out / name).stat().st_size, 10_000)  # an empty sheet of this size has 3 kB


if __name__ == "__main__":
    unittest.main()
