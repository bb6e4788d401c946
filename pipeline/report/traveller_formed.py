"""The formed part as it looks, in lines and areas: what the page that can be turned shows (`viewformed`), seen once.

Faces are shaded and painted from back to front by the depth of their middles, lines on them right after what they lie
on.  Right for surfaces without self-intersection whose faces are small beside their distance; for looking at.
"""

from base64 import b64decode
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import ceil

import msgspec
import numpy as np
from msgspec import Struct

from pipeline.report.traveller_ink import QUIET, Pen, said
from pipeline.report.traveller_numbers import millimetres
from pipeline.report.viewcells import COLUMNS
from stages.geometry.arrays import Array, cross3, norm

LIGHT = np.array([-0.45, 0.55, 0.70])
FRONT = np.array([0.78, 0.88, 0.96])
BACK = np.array([0.93, 0.87, 0.74])
SHADE = 0.34
"""Light from the upper left; the side that is seen flat is blue, the other sand-coloured, as in the previews."""

FEW = 3
"""Cells along a ruling where the part is all of its net: they are there to be painted in order."""

MOST_ROWS = 150
"""Of a net: more show nothing else at this size."""

LIFT = 0.012
"""How far lines are brought forward, as a share of the depth."""

EDGES = {"c0": "0 0.45 0.7", "c1": "0.84 0.37 0", "start": "0 0.5 0.37", "end": "0.33 0.33 0.33"}
LINES = {"mark": "0.42 0.44 0.47", "bend": "0.55 0.2 0.45", "hole": "0.1 0.11 0.13"}
RULING = "0.62 0.68 0.74"
EDGE_MM, LINE_MM, RULING_MM = 0.45, 0.2, 0.08
CAPTION_MM = 5.0
FLAT = 1e-12


class Numbers(Struct, frozen=True):
    """Whole numbers of so many bytes."""

    bytes: int
    numbers: str


class CellsEntry(Struct, frozen=True):
    """What is left of a net."""

    whole: str
    corners: str


class LineEntry(Struct, frozen=True):
    """A line by its places on the net."""

    kind: str
    places: str


class Ruled(Struct, frozen=True, tag_field="kind", tag="ruled"):
    """A part by its rulings."""

    frame: tuple[tuple[float, float, float], ...]
    low: tuple[float, ...]
    step: float
    points: str
    breaks: tuple[int, ...]
    rulings: tuple[int, ...]
    cells: CellsEntry | None
    outlines: tuple[str, ...]
    lines: tuple[LineEntry, ...]


class Triangles(Struct, frozen=True, tag_field="kind", tag="mesh"):
    """A part by its triangles."""

    frame: tuple[tuple[float, float, float], ...]
    low: tuple[float, ...]
    step: float
    points: str
    triangles: Numbers
    outlines: tuple[Numbers, ...]


class PartView(Struct, frozen=True):
    """A part of the view."""

    name: str
    formed: Ruled | Triangles | None


class View(Struct, frozen=True):
    """What is drawn of the parts."""

    parts: tuple[PartView, ...]


def formed_parts(files: Mapping[str, bytes], path: str) -> dict[str, Ruled | Triangles]:
    """Return the formed parts by the names of the parts; nothing where the file with them is not there."""
    content = files.get(path)
    if content is None:
        return {}
    parts = msgspec.json.decode(content, type=View).parts
    return {part.name: part.formed for part in parts if part.formed is not None}


def formed_picture(formed: Ruled | Triangles, size_mm: tuple[float, float]) -> str:
    """Return a formed part in a box, from its lower left corner."""
    faces, lines = _of_triangles(formed) if isinstance(formed, Triangles) else _of_rulings(formed)
    frame = np.array(formed.frame)
    items = [(face @ frame.T, "") for face in faces]
    every = np.concatenate([face for face, _ in items])
    extent = np.ptp(np.concatenate(faces), axis=0)
    low, span = every.min(axis=0), np.ptp(every, axis=0)
    room = np.array([size_mm[0] - 2.0, size_mm[1] - CAPTION_MM - 2.0])
    scale = float(min(room / np.maximum(span[:2], FLAT)))
    offset = 1.0 + (room - scale * span[:2]) / 2.0 + [0.0, CAPTION_MM]

    def placed(points: Array) -> str:
        return " ".join(_pairs(scale * (points[:, :2] - low[:2]) + offset))

    lift = LIFT * float(span[2])
    drawn = [(float(face[:, 2].mean()), _face(face, placed(face))) for face, _ in items]
    for points, colour, width in lines:
        seen = points @ frame.T
        depths = (seen[1:, 2] + seen[:-1, 2]) / 2.0 + lift
        drawn += [
            (float(depth), f"{colour} RG {width} w {_line(placed(seen[i : i + 2]))}") for i, depth in enumerate(depths)
        ]
    ordered = [operators for _, operators in sorted(drawn, key=lambda one: one[0])]
    words = "formed, " + " \N{MULTIPLICATION SIGN} ".join(millimetres(float(side)) for side in extent) + " mm"
    caption = said(size_mm[0] / 2.0, 1.2, words, Pen(7.0, colour=QUIET, align="middle"))
    return "".join(["q 1 j 1 J\n", *ordered, "Q\n", caption])


def _pairs(points: Array) -> Iterator[str]:
    for x, y in np.round(points, 2).tolist():
        yield f"{x:g} {y:g}"


def _line(placed: str) -> str:
    x, y, to_x, to_y = placed.split()
    return f"{x} {y} m {to_x} {to_y} l S\n"


def _face(corners: Array, placed: str) -> str:
    """Return a face in its shade, its edges in the same so that neighbours meet."""
    normal = cross3((corners[1] - corners[0])[None, :], (corners[-1] - corners[0])[None, :])[0]
    normal = normal / max(float(norm(normal[None, :])[0]), FLAT)
    lit = abs(float(normal @ LIGHT)) / float(norm(LIGHT[None, :])[0])
    tone = (FRONT if normal[2] >= 0.0 else BACK) * (1.0 - SHADE * (1.0 - lit))
    colour = " ".join(f"{part:.3f}" for part in tone)
    first, second, *rest = placed.split()
    made = [f"{first} {second} m", *(f"{x} {y} l" for x, y in zip(rest[::2], rest[1::2], strict=True))]
    return f"{colour} rg {colour} RG 0.06 w {' '.join(made)} b\n"


Drawn = tuple[Array, str, float]
"""A line in space with its colour and its width on paper."""


def _points(formed: Ruled | Triangles) -> Array:
    steps = np.frombuffer(b64decode(formed.points), dtype="<u2").reshape(-1, 3)
    points: Array = np.array(formed.low) + formed.step * steps
    return points


def _whole_numbers(entry: Numbers) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    return np.frombuffer(b64decode(entry.numbers), dtype=f"<u{entry.bytes}").astype(np.int64)


def _of_triangles(formed: Triangles) -> tuple[Sequence[Array], Sequence[Drawn]]:
    """Return the faces and the lines of a part by its triangles."""
    points = _points(formed)
    faces = points[_whole_numbers(formed.triangles).reshape(-1, 3)]
    loops = [points[_whole_numbers(loop)] for loop in formed.outlines]
    return list(faces), [(loop, EDGES["c0"], EDGE_MM) for loop in loops]


def _of_rulings(formed: Ruled) -> tuple[Sequence[Array], Sequence[Drawn]]:
    """Return the faces and the lines of a part by its rulings."""
    rails = _points(formed).reshape(-1, 2, 3)
    rows = len(rails)
    faces: list[Array] = []
    if formed.cells is None:
        kept = _kept_rows(rows, formed.breaks)
        joined = [(i, j) for i, j in pairwise(kept) if not (i in formed.breaks and j == i + 1)]
        faces += [_quad(rails, i, j, k / FEW, (k + 1) / FEW) for i, j in joined for k in range(FEW)]
    else:
        bits = np.unpackbits(np.frombuffer(b64decode(formed.cells.whole), dtype=np.uint8), bitorder="little")
        whole = bits[: (rows - 1) * COLUMNS].reshape(rows - 1, COLUMNS)
        faces += [_quad(rails, i, i + 1, k / COLUMNS, (k + 1) / COLUMNS) for i, k in np.argwhere(whole).tolist()]
        corners = _at(rails, _places(formed.cells.corners)).reshape(-1, 3, 3)
        faces += list(corners)
    return faces, list(_ruled_lines(formed, rails))


def _kept_rows(rows: int, breaks: Sequence[int]) -> list[int]:
    """Return the rulings that are shown: every so many, and both at a break."""
    step = ceil(rows / MOST_ROWS)
    always = {0, rows - 1, *breaks, *(i + 1 for i in breaks)}
    return sorted({*range(0, rows, step), *always})


def _quad(rails: Array, i: int, j: int, u: float, w: float) -> Array:
    """Return a cell between two rulings, its normal to the side that is seen flat."""
    a, b, c, d = ((1.0 - t) * rails[k, 0] + t * rails[k, 1] for k, t in ((i, u), (i, w), (j, w), (j, u)))
    return np.array([a, b, c, d])


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


def _ruled_lines(formed: Ruled, rails: Array) -> Iterator[Drawn]:
    """Yield edges, holes, marks and rulings."""
    steps = np.linspace(0.0, 1.0, FEW + 1)[:, None]
    if formed.cells is None:
        for i in formed.rulings:
            yield (1.0 - steps) * rails[i, 0] + steps * rails[i, 1], RULING, RULING_MM
    for one in formed.lines:
        yield _at(rails, _places(one.places)), LINES.get(one.kind, LINES["mark"]), LINE_MM
    if formed.outlines:
        for ring in formed.outlines:
            places = _places(ring)
            yield _at(rails, np.vstack([places, places[:1]])), LINES["hole"], EDGE_MM
        return
    rows = np.split(np.arange(len(rails)), np.array(formed.breaks, dtype=np.int64) + 1)
    for run in rows:
        yield rails[run, 0], EDGES["c0"], EDGE_MM
        yield rails[run, 1], EDGES["c1"], EDGE_MM
    for i, name in ((0, "start"), (-1, "end")):
        yield (1.0 - steps) * rails[i, 0] + steps * rails[i, 1], EDGES[name], EDGE_MM
