"""Many paths of lines and arcs in one pass: their extents, and the operators that draw them, to a ten-thousandth mm.

The paths of a part are joined to one, with a straight gap between the end of one and the start of the next.  Arcs are
cubic pieces, each within `OFF_MM` of its arc (`stages.write.pdf`): a twentieth of the thinnest line.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.report.view.entries import PathView
from stages.geometry.arrays import Array, ArrayValue, Indices
from stages.geometry.paths.arcpath import ArcPath, divided, furthest, radii, sweeps
from stages.write.pdf import WIDEST_RAD, cubics

OFF_MM = 0.005
DECIMALS = 4
ROW = 3
"""Numbers of a vertex: x, y, bulge."""


@dataclass(frozen=True, slots=True, eq=False)
class Joined(ArrayValue):
    """Several paths as an open one, and which vertex is the first of each; closed ones end where they began."""

    path: ArcPath
    first: Indices


def joined(paths: Sequence[PathView]) -> Joined:
    """Return several paths as one, mm."""
    rows: list[float] = []
    first = []
    for path in paths:
        first.append(len(rows) // ROW)
        rows += path.points
        rows += [*path.points[:2], 0.0] if path.closed else ()
    values = np.array(rows).reshape(-1, ROW)
    return Joined(ArcPath(values[:, :2], values[:, 2], closed=False), np.array(first, dtype=np.int64))


def extents(paths: Joined) -> Array:
    """Return x least, y least, x most, y most of each path in mm; exact, arcs included."""
    vertices, first = paths.path.vertices, paths.first
    low, high = np.minimum.reduceat(vertices, first), np.maximum.reduceat(vertices, first)
    piece, points = furthest(paths.path)
    owner = np.searchsorted(first, piece, side="right") - 1
    np.minimum.at(low, owner, points)
    np.maximum.at(high, owner, points)
    return np.concatenate([low, high], axis=1)


def outlines(paths: Joined) -> list[str]:
    """Return the operators of each path, yet to be drawn or filled; closed ones come back to where they began."""
    count = _counts(paths.path)
    path = divided(paths.path, count)
    begin = np.concatenate([[0], np.cumsum(count)])[paths.first]
    curves = np.concatenate([cubics(path).reshape(-1, 4), path.vertices[1:]], axis=1)
    starts = np.round(path.vertices[begin], DECIMALS).tolist()
    pieces = list(_pieces(np.round(curves, DECIMALS), sweeps(path) == 0.0))
    ends = [*(begin[1:] - 1).tolist(), len(pieces)]
    return [
        f"{x:.14g} {y:.14g} m {' '.join(pieces[low:high])}"
        for (x, y), low, high in zip(starts, begin.tolist(), ends, strict=True)
    ]


def _counts(path: ArcPath) -> Indices:
    """Return into how many cubic pieces each piece is cut: their error grows as the sixth power of the sweep."""
    sweep = np.abs(sweeps(path))
    radius = np.where(sweep > 0.0, radii(path), 1.0)
    widest = np.minimum(4.0 * (27.0 / 4.0 * 2.0 * OFF_MM / radius * SPARE) ** (1.0 / 6.0), WIDEST_RAD)
    counts: Indices = np.maximum(np.ceil(sweep / widest), 1.0).astype(np.int64)
    return counts


SPARE = 0.99
"""For what the leading term of the error leaves out: sin^6 x / cos^2 x is below x^6 / `SPARE` up to an eighth of pi."""


def _pieces(curves: Array, straight: Array) -> Iterator[str]:
    """Yield the operators of pieces one by one."""
    for (a, b, c, d, x, y), is_line in zip(curves.tolist(), straight.tolist(), strict=True):
        yield f"{x:.14g} {y:.14g} l" if is_line else f"{a:.14g} {b:.14g} {c:.14g} {d:.14g} {x:.14g} {y:.14g} c"
