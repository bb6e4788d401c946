"""Text as strokes of one line, for machines that engrave what they are given and know no letters.

The letters are this project's own: straight strokes on a grid of 4 by 9, capitals from line 2 to line 8, small letters
to line 6, descenders to line 0.  A stroke is written as its grid points, x then y.  All letters are equally wide; what
is not printable ASCII has no letter here.
"""

import numpy as np

from stages.geometry.arrays import Points2, Vector2
from stages.geometry.paths.arcpath import ArcPath

CAPITAL = 6.0
"""Grid lines that a capital is high: as high as the text."""

MIDDLE_X, MIDDLE_Y = 2.0, 5.0
ADVANCE = 5.5
"""From letter to letter, in grid lines: less than the width that the room for a text is reckoned with."""

GLYPHS = {
    " ": "", "!": "2824 2322", '"': "1816 3836", "#": "1218 3238 0444 0646", "$": "473818070615354443321203 2921",
    "%": "0248 0818170708 3343423233", "&": "42071827260403122244", "'": "2826", "(": "38272332", ")": "18272312",
    "*": "2723 0644 0446", "+": "2723 0545", ",": "232110", "-": "0545", ".": "2322", "/": "0248",
    "0": "180703123243473818 0347", "1": "172822 1232", "2": "07183847460242", "3": "0718384746354443321203 1535",
    "4": "32380444", "5": "480805354443321203", "6": "4738180703123243443505", "7": "084812",
    "8": "150607183847463515 1504031232434435", "9": "0312324347381807061545", ":": "2625 2322", ";": "2625 232110",
    "<": "470543", "=": "0646 0444", ">": "074503", "?": "07183847462524 2322",
    "@": "3436261514233334 344347381807031242", "A": "0206284642 0545", "B": "02083847463544433202 0535",
    "C": "4738180703123243", "D": "02083847433202", "E": "48080242 0535", "F": "480802 0535",
    "G": "47381807031232434525", "H": "0802 4842 0545", "I": "1838 2822 1232", "J": "4843321203", "K": "0802 480542",
    "L": "080242", "M": "0208254842", "N": "02084248", "O": "180703123243473818", "P": "02083847463505",
    "Q": "180703123243473818 2442", "R": "02083847463505 2542", "S": "473818070615354443321203", "T": "0848 2822",
    "U": "080312324348", "V": "082248", "W": "0812263248", "X": "0842 4802", "Y": "082548 2522", "Z": "08480242",
    "[": "38181232", "\\": "0842", "]": "18383212", "^": "062846", "_": "0141", "`": "1827",
    "a": "4642 4536160503123243", "b": "0802 0516364543321203", "c": "4536160503123243", "d": "4842 4536160503123243",
    "e": "04444536160503123243", "f": "38281712 0636", "g": "4641301001 4536160503123243", "h": "0802 0516364542",
    "i": "2622 2728", "j": "26211000 2728", "k": "0802 460442", "l": "282332", "m": "0602 05162522 25364542",
    "n": "0602 0516364542", "o": "160503123243453616", "p": "0600 0516364543321203", "q": "4640 4536160503123243",
    "r": "0602 04263645", "s": "45361605143443321203", "t": "18132232 0636", "u": "0603123243 4642", "v": "062246",
    "w": "0612253246", "x": "0642 4602", "y": "0603123243 4641301001", "z": "06460242", "{": "38272615242332",
    "|": "2821", "}": "18272635242312", "~": "05163445",
}  # fmt: skip


def reach(text: str) -> float:
    """Return how far the strokes of a text reach from its middle, in heights of the text; 0 where it has none."""
    strokes = _strokes(text)
    return max((float(np.hypot(*stroke.T).max()) for stroke in strokes), default=0.0)


def lettering(text: str, at: Vector2, height_mm: float, angle_deg: float) -> list[ArcPath]:
    """Return the strokes of a text with its middle at a point; those that come back to their start are closed."""
    angle = np.radians(angle_deg)
    turn = height_mm * np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return [_path(stroke @ turn + at, closed=bool((stroke[0] == stroke[-1]).all())) for stroke in _strokes(text)]


def _strokes(text: str) -> list[Points2]:
    """Return the strokes of a text about its middle, in heights of the text."""
    start = -ADVANCE * (len(text) - 1) / 2.0
    return [
        (_points(stroke) + np.array([start + ADVANCE * place - MIDDLE_X, -MIDDLE_Y])) / CAPITAL
        for place, letter in enumerate(text)
        for stroke in GLYPHS[letter].split()
    ]


def _points(stroke: str) -> Points2:
    return np.array([int(digit) for digit in stroke], dtype=np.float64).reshape(-1, 2)


def _path(points: Points2, *, closed: bool) -> ArcPath:
    corners = points[:-1] if closed else points
    return ArcPath(corners, np.zeros(corners.shape[0]), closed)
