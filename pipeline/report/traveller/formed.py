"""The formed part as it looks, in lines and areas: what the page that can be turned shows (`view.formed`), seen once.

Faces are shaded and painted from back to front by the depth of their middles, lines on them right after what they lie
on.  Right for surfaces without self-intersection whose faces are small beside their distance; for looking at.  All
faces and all lines are placed at once; only their operators are put together one by one.
"""

from base64 import b64decode
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from pipeline.report.shades import BACK_RGB, FRONT_RGB, LIGHT
from pipeline.report.shopentries import FormedEntry
from pipeline.report.traveller.ink import QUIET, Pen, said
from pipeline.report.traveller.numbers import millimetres
from pipeline.report.view.cells import COLUMNS
from pipeline.report.view.entries import Numbers, Ruled, Triangles
from stages.geometry.arrays import Array, Indices, Points3, cross3, norm

SHADE = 0.34
"""How much darker a face is that the light does not meet: a little more than in the previews, for paper."""

TONES = 128
"""From dark to light on each side: steps of less than a grey level of 255."""

FEW = 3
"""Cells along a ruling where the part is all of its net: they are there to be painted in order."""

MOST_ROWS = 100
"""Of a net: more show nothing else at this size."""

LIFT = 0.06
"""How far lines are brought forward, as a share of the depth: half of a cell lies before its own far edge."""

EDGES = {"c0": "0 .45 .7", "c1": ".84 .37 0", "start": "0 .5 .37", "end": ".33 .33 .33"}
LINES = {"mark": ".42 .44 .47", "bend": ".55 .2 .45", "hole": ".1 .11 .13"}
RULING = ".62 .68 .74"
UNIT_MM = 0.01
"""Places are whole numbers of it: a tenth of the thinnest line."""
EDGE, LINE, RULING_WIDE, SEAM = 45, 20, 8, 6
"""Widths of lines in `UNIT_MM`; seam: of those that close the seams between faces."""
CAPTION_MM = 5.0
FLAT = 1e-12

Drawn = tuple[Points3, str, int]
"""A line in space with its colour and its width on paper."""


@dataclass(frozen=True, slots=True)
class Shape:
    """What is painted of a part: faces of four corners, faces of three, lines."""

    quads: Array
    triangles: Array
    lines: Sequence[Drawn]


@dataclass(frozen=True, slots=True)
class Placing:
    """How points get on paper: seen in a frame (right, up, towards the viewer), scaled and moved, in `UNIT_MM`."""

    frame: Points3
    scale: float
    low: Array
    offset: Array

    def seen(self, points: Array) -> Array:
        """Return points of any shape as they are seen, mm."""
        seen: Array = points @ self.frame.T
        return seen

    def placed(self, seen: Array) -> list[list[int]]:
        """Return the places of corners, a row for each face or line."""
        places = np.rint((self.scale * (seen[..., :2] - self.low) + self.offset) / UNIT_MM).astype(np.int64)
        rows: list[list[int]] = places.reshape(len(places), 2 * seen.shape[1]).tolist()
        return rows


def formed_picture(formed: Ruled | Triangles, size_mm: tuple[float, float], size: FormedEntry | None) -> str:
    """Return a formed part in a box, from its lower left corner; size: how large it is, for the line below it."""
    shape = _of_triangles(formed) if isinstance(formed, Triangles) else _of_rulings(formed)
    placing = _placing(shape, np.array(formed.frame), size_mm)
    items = [*_faces(placing, shape.quads), *_faces(placing, shape.triangles), *_lines(placing, shape)]
    ordered = [operators for _, operators in sorted(items, key=_depth)]
    sides = "" if size is None else f", {f' {TIMES} '.join(map(millimetres, size.size_mm))} mm ({size.evidence})"
    caption = said(size_mm[0] / 2.0, 1.2, f"formed{sides}", Pen(7.0, colour=QUIET, align="middle"))
    return "".join([f"q {UNIT_MM} 0 0 {UNIT_MM} 0 0 cm 1 j 1 J\n", *ordered, "Q\n", caption])


TIMES = "\N{MULTIPLICATION SIGN}"

Item = tuple[float, str]
"""How near something is, and the operators that paint it."""


def _depth(item: Item) -> float:
    return item[0]


def _placing(shape: Shape, frame: Points3, size_mm: tuple[float, float]) -> Placing:
    """Return how all faces of a shape get into the middle of a box, above the line below it."""
    every = np.concatenate([shape.quads.reshape(-1, 3), shape.triangles.reshape(-1, 3)]) @ frame.T
    low, span = every.min(axis=0), np.ptp(every, axis=0)
    room = np.array([size_mm[0] - 2.0, size_mm[1] - CAPTION_MM - 2.0])
    scale = float(min(room / np.maximum(span[:2], FLAT)))
    return Placing(frame, scale, low[:2], 1.0 + (room - scale * span[:2]) / 2.0 + [0.0, CAPTION_MM])


def _faces(placing: Placing, faces: Array) -> Iterable[Item]:
    """Return faces in their shades, their edges in the same so that neighbours meet."""
    if not len(faces):
        return []
    seen = placing.seen(faces)
    places = placing.placed(seen)
    depths, tones = seen[..., 2].mean(axis=1).tolist(), _tones(seen)
    ends = ["{} {} m", *["{} {} l"] * (seen.shape[1] - 1), "b\n"]
    form = " ".join(ends).format
    return [(depth, SHADES[tone] + form(*row)) for depth, tone, row in zip(depths, tones, places, strict=True)]


def _tones(seen: Array) -> list[int]:
    """Return the shade of each face, those of the other side behind those of the side that is seen flat."""
    normals = cross3(seen[:, 1] - seen[:, 0], seen[:, -1] - seen[:, 0])
    lit = np.abs(normals @ LIGHT) / (np.maximum(norm(normals), FLAT) * float(norm(LIGHT)))
    tones: list[int] = (np.rint(lit * (TONES - 1)).astype(np.int64) + TONES * (normals[:, 2] < 0.0)).tolist()
    return tones


def _shades() -> Iterator[str]:
    """Yield the operators that choose each shade."""
    for side in (FRONT_RGB, BACK_RGB):
        for lit in np.linspace(0.0, 1.0, TONES):
            colour = " ".join(f"{part:.3f}" for part in side * (1.0 - SHADE * (1.0 - lit)))
            yield f"{colour} rg {colour} RG {SEAM} w "


SHADES = tuple(_shades())


def _lines(placing: Placing, shape: Shape) -> Iterator[Item]:
    """Yield the pieces of lines, brought forward a little."""
    if not shape.lines:
        return
    ends = [np.stack([points[:-1], points[1:]], axis=1) for points, _, _ in shape.lines]
    styles = [f"{colour} RG {width} w " for (_, colour, width), one in zip(shape.lines, ends, strict=True) for _ in one]
    seen = placing.seen(np.concatenate(ends))
    every = placing.seen(np.concatenate([shape.quads.reshape(-1, 3), shape.triangles.reshape(-1, 3)]))[:, 2]
    # by the nearer end: a piece may be longer than the faces that it lies on
    depths = (seen[..., 2].max(axis=1) + LIFT * float(np.ptp(every))).tolist()
    for depth, style, (x, y, to_x, to_y) in zip(depths, styles, placing.placed(seen), strict=True):
        yield depth, f"{style}{x} {y} m {to_x} {to_y} l S\n"


def _points(formed: Ruled | Triangles) -> Points3:
    steps = np.frombuffer(b64decode(formed.points), dtype="<u2").reshape(-1, 3)
    points: Array = np.array(formed.low) + formed.step * steps
    return points


def _whole_numbers(entry: Numbers) -> Indices:
    return np.frombuffer(b64decode(entry.numbers), dtype=f"<u{entry.bytes}").astype(np.int64)


def _of_triangles(formed: Triangles) -> Shape:
    """Return the faces and the lines of a part by its triangles."""
    points = _points(formed)
    faces = points[_whole_numbers(formed.triangles).reshape(-1, 3)]
    loops = [points[_whole_numbers(loop)] for loop in formed.outlines]
    return Shape(np.zeros((0, 4, 3)), faces, [(loop, EDGES["c0"], EDGE) for loop in loops])


def _of_rulings(formed: Ruled) -> Shape:
    """Return the faces and the lines of a part by its rulings."""
    rails = _points(formed).reshape(-1, 2, 3)
    lines = list(_ruled_lines(formed, rails))
    if formed.cells is None:
        kept = _kept_rows(len(rails), formed.breaks)
        joined = [(i, j) for i, j in pairwise(kept) if not (i in formed.breaks and j == i + 1)]
        low, high = np.array(joined, dtype=np.int64).reshape(-1, 2).repeat(FEW, axis=0).T
        column = np.tile(np.arange(FEW), len(joined))
        return Shape(_quads(rails, low, high, column / FEW, (column + 1) / FEW), np.zeros((0, 3, 3)), lines)
    bits = np.unpackbits(np.frombuffer(b64decode(formed.cells.whole), dtype=np.uint8), bitorder="little")
    row, column = np.nonzero(bits[: (len(rails) - 1) * COLUMNS].reshape(-1, COLUMNS))
    # counter-clockwise in row and u: seen from the side that is seen flat they run the other way
    triangles = _at(rails, _places(formed.cells.corners)).reshape(-1, 3, 3)[:, ::-1]
    return Shape(_quads(rails, row, row + 1, column / COLUMNS, (column + 1) / COLUMNS), triangles, lines)


def _kept_rows(rows: int, breaks: Sequence[int]) -> list[int]:
    """Return the rulings that are shown: every so many, and both at a break."""
    step = ceil(rows / MOST_ROWS)
    always = {0, rows - 1, *breaks, *(i + 1 for i in breaks)}
    return sorted({*range(0, rows, step), *always})


def _quads(rails: Array, low: Indices, high: Indices, u: Array, w: Array) -> Array:
    """Return cells between two rulings each, their normals to the side that is seen flat, shape (n, 4, 3)."""
    corners = [
        rails[row, 0] + t[:, None] * (rails[row, 1] - rails[row, 0])
        for row, t in ((low, u), (low, w), (high, w), (high, u))
    ]
    return np.stack(corners, axis=1)


def _places(encoded: str) -> Array:
    return np.frombuffer(b64decode(encoded), dtype="<f4").astype(np.float64).reshape(-1, 2)


def _at(rails: Array, places: Array) -> Array:
    """Return the points at places on the net."""
    row = np.clip(np.floor(places[:, 0]).astype(np.int64), 0, len(rails) - 2)
    t, u = (places[:, 0] - row)[:, None], places[:, 1][:, None]
    low = (1.0 - u) * rails[row, 0] + u * rails[row, 1]
    high = (1.0 - u) * rails[row + 1, 0] + u * rails[row + 1, 1]
    points: Array = (1.0 - t) * low + t * high
    return points


def _thinned(line: Points3) -> Points3:
    """Return a straight line in `FEW` pieces, so that they are painted in order, and any other in `MOST_PIECES`."""
    chord = line[-1] - line[0]
    along = (line - line[0]) @ chord / max(float(chord @ chord), FLAT)
    off = norm(line - line[0] - along[:, None] * chord).max()
    count = len(line) - 1
    most = min(FEW if off <= STRAIGHT * norm(chord) else MOST_PIECES, count)
    thinned: Points3 = line[np.arange(most + 1) * count // most]
    return thinned


STRAIGHT = 5e-4
"""How far a line may be off its chord, as a share of it, to be straight at this size: 0.04 mm on 88."""

MOST_PIECES = 48


def _ruled_lines(formed: Ruled, rails: Array) -> Iterator[Drawn]:
    """Yield edges, holes, marks and rulings."""
    steps = (np.arange(FEW + 1) / FEW)[:, None]
    if formed.cells is None:
        for i in formed.rulings:
            yield (1.0 - steps) * rails[i, 0] + steps * rails[i, 1], RULING, RULING_WIDE
    places = [_places(one.places) for one in formed.lines]
    points = _at(rails, np.concatenate([np.zeros((0, 2)), *places]))
    ends = np.cumsum([len(one) for one in places])[:-1]
    for one, line in zip(formed.lines, np.split(points, ends) if places else (), strict=True):
        yield _thinned(line), LINES.get(one.kind, LINES["mark"]), LINE
    if formed.outlines:
        for ring in formed.outlines:
            around = _places(ring)
            yield _at(rails, np.vstack([around, around[:1]])), LINES["hole"], EDGE
        return
    rows = np.split(np.arange(len(rails)), np.array(formed.breaks, dtype=np.int64) + 1)
    for run in rows:
        yield rails[run, 0], EDGES["c0"], EDGE
        yield rails[run, 1], EDGES["c1"], EDGE
    for i, name in ((0, "start"), (-1, "end")):
        yield (1.0 - steps) * rails[i, 0] + steps * rails[i, 1], EDGES[name], EDGE
