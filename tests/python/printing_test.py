"""Targets to print are as large as they say, and show the detector what they should."""
import re
import unittest

import numpy as np
import poecal

import cells

PIXELS_OF_A_MM = 2  # of which the cells here have whole numbers


def black_rectangles(svg):
    """x0, y0, x1, y1 [mm] of the cells that are filled in black; numbers of the rulers are curves and are not among them."""
    number = r"(-?\d+(?:\.\d+)?)"
    drawn = "".join(re.findall(r'<path style="[^"]*;fill:rgb\(0%,0%,0%\);[^"]*" d="([^"]*)"', svg))
    found = re.findall(rf"M {number} {number} L {number} {number} L {number} {number} L {number} {number} Z", drawn)
    return [(float(one[0]), float(one[1]), float(one[4]), float(one[5])) for one in found]


def picture_of(page):
    """A page as a camera without lens sees it, a little out of focus."""
    picture = np.full([round(1e3 * side * PIXELS_OF_A_MM) for side in (page.height, page.width)], 255.0)
    for rectangle in black_rectangles(page.svg):
        x0, y0, x1, y1 = (round(side * PIXELS_OF_A_MM) for side in rectangle)
        picture[y0:y1, x0:x1] = 0.0
    for axis in (0, 1):
        picture = sum(weight * np.roll(picture, shift, axis) for shift, weight in ((-1, 0.25), (0, 0.5), (1, 0.25)))
    return np.round(picture).astype(np.uint8)


class Sheets(unittest.TestCase):
    def test_show_the_detector_the_target_where_they_say(self):
        folder = cells.new_folder()
        for target in (
            poecal.apriltagTarget("tag36h11", [poecal.TargetTag(id=7, size=0.08)]),
            poecal.chessboardTarget(6, 5, 0.025),
        ):
            page, = poecal.drawTargetSheet(target, poecal.paperNamed("a4")).pages
            cells.write_png(folder / "page.png", picture_of(page))
            corners = poecal.detect(folder, ["page.png"], target).detections.images[0].corners
            self.assertEqual(len(corners), len(target.points))
            for corner, point in zip(corners, target.points):
                self.assertEqual(corner.id, point.id)
                at = (page.T_page_target @ [*point.p_target, 1.0])[:2]
                # The middle of the top-left pixel is (0, 0) and half a pixel from the page's corner.
                self.assertLess(np.linalg.norm(corner.px + 0.5 - 1e3 * PIXELS_OF_A_MM * at), 0.05)

    def test_have_the_size_of_the_paper(self):
        target = poecal.apriltagTarget("tag36h11", [poecal.TargetTag(id=7, size=0.08)])
        for name, size in {"a4": (0.210, 0.297), "letter": (0.2159, 0.2794), "300x400": (0.3, 0.4)}.items():
            paper = poecal.paperNamed(name)
            np.testing.assert_allclose((paper.width, paper.height), size)
            page, = poecal.drawTargetSheet(target, paper).pages
            np.testing.assert_allclose(sorted((page.width, page.height)), size)
            self.assertEqual(page.tags, (7,))
            end = page.ruler_corner + [page.ruler, 0.0]
            self.assertTrue((page.ruler_corner > 0.0).all() and end[0] < page.width)

    def test_are_the_program_s(self):
        out = cells.new_folder()
        cells.done("target", "--type", "chessboard", "--cols", 6, "--rows", 5, "--square", 0.025, "--paper", "a3", "--out", out)
        sheet = poecal.drawTargetSheet(poecal.chessboardTarget(6, 5, 0.025), poecal.paperNamed("a3"))
        self.assertEqual(sheet.pdf, (out / "target.pdf").read_bytes())
        self.assertEqual(sheet.pages[0].svg, (out / "target.svg").read_text())
        self.assertEqual(poecal.targetYaml(poecal.chessboardTarget(6, 5, 0.025)), (out / "target.yaml").read_text())

    def test_show_themselves_in_short(self):
        sheet = poecal.drawTargetSheet(poecal.chessboardTarget(6, 5, 0.025), poecal.paperNamed("a4"))
        self.assertLess(len(repr(sheet)) + len(repr(sheet.pages[0])), 400)

    def test_that_are_too_small_are_refused(self):
        with self.assertRaisesRegex(poecal.InvalidArgument, "a2|a1|a3"):
            poecal.drawTargetSheet(poecal.chessboardTarget(9, 6, 0.05), poecal.paperNamed("a4"))
        with self.assertRaisesRegex(poecal.InvalidArgument, "letter"):
            poecal.paperNamed("a9")


if __name__ == "__main__":
    unittest.main()
