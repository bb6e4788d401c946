"""A drawing in the operators of PDF, a unit being 1 mm: its lines, its arcs as cubic pieces, its texts, its layers.

Layers follow each other as in the drawing, in colours that show on paper; a reader can switch each of them off.

PDF has no arcs.  An arc is written as cubic pieces that share its ends and tangents [1]_.  The square of the distance
of such a piece from the centre exceeds that of the radius R, by at most

    s R^2,    s = 4/27 sin^6(a/4) / cos^2(a/4)    for a sweep a, at t = 1/2 +- sqrt(3)/6,

so it is off outwards alone, by R (sqrt(1 + s) - 1); arcs are divided until that is below `ARC_MM`.

.. [1] M. Goldapp, "Approximation of circular arcs by cubic polynomials", Computer Aided Geometric Design 8 (1991),
   227-238: the interpolating case, handles of 4/3 tan(a/4) R.
"""

from collections.abc import Sequence
from itertools import groupby
from math import cos, radians, sin

import numpy as np

from stages.geometry.arrays import Array, norm
from stages.geometry.paths.arcpath import ArcPath, chords, directions, piece_count, radii, split, sweeps
from stages.model.cutfile import Machine
from stages.write.colours import FULL, on_paper
from stages.write.drawing import Drawing, Label
from stages.write.numerals import numerals
from stages.write.pdfobjects import CAPITAL_SHARE, LETTER_SHARE, string

ARC_MM = 1e-4
"""How far a cubic piece may be off its arc: a thousandth of the line's width."""

WIDEST_RAD = np.pi / 2.0
LINE_MM = 0.09
"""A quarter of a point, what printers call a hairline: it shows, and its middle can be cut along."""

CONDENSED = 80
"""Width of letters in percent: a line of Courier is then 0.85 heights a letter, within what labels have room for."""

LETTER_WIDTH = LETTER_SHARE * CONDENSED / 100.0 / CAPITAL_SHARE


def layers_of(drawing: Drawing) -> list[str]:
    """Return the layers that a drawing has by what they mean, in its order."""
    kinds = [*(item.layer for item in drawing.items), *(label.layer for label in drawing.labels)]
    return list(dict.fromkeys(kinds))


def drawn(drawing: Drawing, machine: Machine) -> str:
    """Return the operators that draw a drawing where it is, on layers numbered as `layers_of` has them."""
    layers = layers_of(drawing)
    made = [f"{LINE_MM:g} w 1 j\n"]
    for kind, items in groupby(drawing.items, key=lambda item: item.layer):
        strokes = "".join(stroke(item.path) for item in items)
        made.append(on_layer(layers.index(kind), f"{_colour(machine, kind)} RG\n{strokes}"))
    for kind, labels in groupby(drawing.labels, key=lambda label: label.layer):
        texts = "".join(text(label) for label in labels)
        made.append(on_layer(layers.index(kind), f"{_colour(machine, kind)} rg\n{texts}"))
    return "".join(made)


def on_layer(number: int, content: str) -> str:
    """Return operators that belong to a layer."""
    return f"/OC /L{number} BDC\n{content}EMC\n"


def lines(ends: Array) -> str:
    """Return straight lines, each from x, y to x, y in mm."""
    rows = _rows(ends, 2)
    return "".join(f"{start} m {end} l S\n" for start, end in zip(rows[::2], rows[1::2], strict=True))


def text(label: Label) -> str:
    """Return a text with its middle at its place."""
    size = label.height_mm / CAPITAL_SHARE
    angle = radians(label.angle_deg)
    along, up = np.array([cos(angle), sin(angle)]), np.array([-sin(angle), cos(angle)])
    half = LETTER_WIDTH * label.height_mm * len(label.text) / 2.0
    start = label.at - half * along - label.height_mm / 2.0 * up
    place = numbers(np.concatenate([along, up, start]))
    return f"BT /F {numbers([size])} Tf {CONDENSED} Tz {place} Tm {string(label.text)} Tj ET\n"


def numbers(values: Sequence[float] | Array) -> str:
    """Return numbers as operators take them."""
    return " ".join(numerals(np.asarray(values, dtype=np.float64)))


def _colour(machine: Machine, kind: str) -> str:
    return " ".join(f"{part / FULL:.4f}" for part in on_paper(machine.layers[kind].colour))


def stroke(path: ArcPath) -> str:
    """Return a path as a line, closed if it is."""
    return f"{outline(path)} {'s' if path.closed else 'S'}\n"


def outline(path: ArcPath) -> str:
    """Return a path that is yet to be drawn or filled."""
    path = for_cubics(path)
    _, ends = chords(path)
    points = _rows(np.concatenate([path.vertices[:1], ends]), 2)
    curves = _rows(np.concatenate([cubics(path).reshape(len(ends), 4), ends], axis=1), 6)
    straight = sweeps(path) == 0.0
    pieces = zip(points[1:], curves, straight.tolist(), strict=True)
    made = [f"{end} l" if is_line else f"{curve} c" for end, curve, is_line in pieces]
    if path.closed and straight[-1]:
        made.pop()
    return " ".join([f"{points[0]} m", *made])


def _rows(values: Array, width: int) -> list[str]:
    """Return numbers as they are written, row by row."""
    written = numerals(values)
    return [" ".join(written[i : i + width]) for i in range(0, len(written), width)]


def for_cubics(path: ArcPath) -> ArcPath:
    """Return the path with its arcs divided until a cubic piece for each is within `ARC_MM`; exact."""
    while True:
        sweep = np.abs(sweeps(path))
        off = cubic_error(np.where(sweep > 0.0, radii(path), 0.0), sweep)
        if not ((off > ARC_MM) | (sweep > WIDEST_RAD)).any():
            return path
        path = split(path, max_bulge=float(np.tan(sweep.max() / 4.0 * SMALLER)))


SMALLER = 0.55
"""Of the widest sweep: a little over a half, so that rounding does not make three parts of what two are enough for."""


def cubic_error(radius: Array, sweep: Array) -> Array:
    """Return how far cubic pieces for arcs are off them at most, in mm."""
    quarter = sweep / 4.0
    square = 4.0 / 27.0 * np.sin(quarter) ** 6 / np.cos(quarter) ** 2
    # sqrt(1 + s) - 1 without the digits that its difference loses
    off: Array = radius * square / (1.0 + np.sqrt(1.0 + square))
    return off


def cubics(path: ArcPath) -> Array:
    """Return the two inner control points of a cubic piece for each piece, shape (pieces, 2, 2), in mm.

    The handles of an arc, 4/3 tan(a/4) R, are c (1 + b^2) / 3 by its chord c and bulge b: no large radius comes in.
    """
    start, end = chords(path)
    first, last = directions(path)
    handle = (norm(end - start) * (1.0 + path.bulges[: piece_count(path)] ** 2) / 3.0)[:, None]
    leaving = np.stack([np.cos(first), np.sin(first)], axis=1)
    arriving = np.stack([np.cos(last), np.sin(last)], axis=1)
    return np.stack([start + handle * leaving, end - handle * arriving], axis=1)
