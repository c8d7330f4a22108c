"""Captures whose truth is known, and the program to compare the module with."""
import functools
import os
import subprocess
import tempfile
from pathlib import Path

PROGRAM = os.environ["POECAL_PROGRAM"]
SOURCE = Path(os.environ["POECAL_SOURCE_DIR"])
COBOT = SOURCE / "calib_data/cobot6"
RATIO = 1e-3  # that joint 5 leaks into joint 6 by, in the scenes here


def program(*arguments, folder=None):
    """Runs `poecal ARGUMENTS`."""
    return subprocess.run([PROGRAM, *map(str, arguments)], cwd=folder, capture_output=True, text=True, timeout=120)


def done(*arguments, folder=None):
    """Runs a command that must not fail; what it says on stdout."""
    run = program(*arguments, folder=folder)
    if run.returncode != 0:
        raise RuntimeError(f"{arguments}: {run.stderr}")
    return run.stdout


@functools.cache
def scratch():
    """A folder for as long as the tests run."""
    return tempfile.TemporaryDirectory(prefix="poecal-python-")


def new_folder():
    return Path(tempfile.mkdtemp(dir=scratch().name))


def simulated(looks, count):
    """A capture of the demo's arm. looks: what the scene says in place of `image:`."""
    folder = new_folder()
    for file in COBOT.iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    told = (folder / "scene-joint.yaml").read_text().splitlines()
    lines = [line for line in told if not line.startswith(("image:", "intrinsics:"))]
    scene = "\n".join(lines).replace("count: 60", f"count: {count}") + f"\n{looks}\n"
    (folder / "scene.yaml").write_text(scene)
    done("simulate", folder / "scene.yaml", "--out", folder / "capture")
    return folder / "capture"


@functools.cache
def corners_capture():
    """60 poses, corners with 0.1 px of noise."""
    return simulated("corners: {sigma: 0.1}", 60)


@functools.cache
def pictures_capture():
    """12 pictures."""
    return simulated("image: {blur: 0.7, noise: 2.0, background: plain}", 12)


@functools.cache
def board_folder():
    """5 pictures of a board, to find the lens from."""
    looks = "image: {blur: 0.7, noise: 2.0, background: plain}\nintrinsics: {target: board.yaml, count: 5}"
    return simulated(looks, 1) / "intrinsics"


@functools.cache
def results():
    """What the program makes of corners_capture()."""
    out = new_folder() / "out"
    done("run", corners_capture(), "--out", out)
    return out
