"""The colours of the phases differ for every reader, also for one without red or green cones."""

import itertools
import pathlib
import re
import unittest

STYLE = pathlib.Path(__file__).resolve().parents[1] / "python/stg_view/web/style.css"
PHASES = ("search", "approach", "stable", "lost")
# What these eyes see, as a matrix on linear RGB: Machado, Oliveira and Fernandes (2009), severity 1.
EYES = {
    "all cones": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "no red": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "no green": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
}
TO_XYZ = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
WHITE = (0.9505, 1.0, 1.089)
LEAST = 25.0  # CIE 1976 difference; side by side, 2 can just be seen


def times(matrix, vector):
    """Matrix times vector."""
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def lab_of(colour, eye):
    """CIELAB of #rrggbb as an eye sees it."""
    share = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in share]
    seen = [min(1.0, max(0.0, x)) for x in times(EYES[eye], linear)]
    f = [(x / w) ** (1 / 3) if x / w > 0.008856 else 7.787 * x / w + 16 / 116 for x, w in zip(times(TO_XYZ, seen), WHITE)]
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


class ColoursTest(unittest.TestCase):
    """Both themes."""

    def test_white_and_black(self):
        self.assertAlmostEqual(100.0, lab_of("#ffffff", "all cones")[0], places=1)
        self.assertAlmostEqual(0.0, lab_of("#000000", "no green")[0], places=1)

    def test_every_two_phases_differ_for_every_eye(self):
        themes = STYLE.read_text().split(":root")[1:3]
        for (k, theme), eye in itertools.product(enumerate(themes), EYES):
            colours = {name: re.search(rf"--{name}: (#\w{{6}})", theme).group(1) for name in PHASES}
            for a, b in itertools.combinations(PHASES, 2):
                apart = sum((x - y) ** 2 for x, y in zip(lab_of(colours[a], eye), lab_of(colours[b], eye))) ** 0.5
                self.assertGreater(apart, LEAST, f"theme {k}: {a} and {b}, {eye}")


if __name__ == "__main__":
    unittest.main()
