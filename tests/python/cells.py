"""Captures whose truth is known, and the program to compare the module with."""
import functools
import os
import struct
import subprocess
import tempfile
import zlib
from pathlib import Path

import numpy as np

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


def scene_file(looks, count):
    """A scene of the demo's arm. looks: what it says in place of `image:`."""
    folder = new_folder()
    for file in COBOT.iterdir():
        (folder / file.name).write_bytes(file.read_bytes())
    told = (folder / "scene-joint.yaml").read_text().splitlines()
    lines = [line for line in told if not line.startswith(("image:", "intrinsics:"))]
    scene = "\n".join(lines).replace("count: 60", f"count: {count}") + f"\n{looks}\n"
    (folder / "scene.yaml").write_text(scene)
    return folder / "scene.yaml"


def simulated(looks, count):
    """A capture of that scene, and its truth beside it."""
    scene = scene_file(looks, count)
    done("simulate", scene, "--out", scene.with_name("capture"))
    return scene.with_name("capture")


def truth_of(capture):
    """The folder with a simulated capture's truth."""
    return capture.with_name(capture.name + "-truth")


def corners_of(images):
    """(picture, tag, corner) -> px of pictures with corners."""
    return {(one.image, corner.id.tag, corner.id.corner): corner.px for one in images for corner in one.corners}


def largest_distance(images, others):
    """Between the same corners [px]; they must be of the same names."""
    first, second = corners_of(images), corners_of(others)
    if first.keys() != second.keys() or not first:
        raise AssertionError(f"{len(first)} corners, {len(second)} others")
    return max(np.linalg.norm(first[name] - second[name]) for name in first)


def write_png(file, pixels):
    """A grey picture of height x width bytes, as png's specification has it: each row with filter 0."""
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    chunks = {b"IHDR": struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 0, 0, 0, 0), b"IDAT": zlib.compress(rows), b"IEND": b""}
    body = [struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks.items()]
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(body))


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
