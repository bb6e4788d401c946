"""Where a contour may begin: the place that the rule of the job names first, then others, should a lead not fit there.

A side is one of the sheet as it lies in the drawing.  Places that would leave a piece too short to cut are vertices.
"""

from collections.abc import Iterator

import numpy as np

from stages.geometry.arrays import Numbers, Values
from stages.geometry.paths.arcpath import ArcPath, joint_turns, lengths, sweeps
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.geometry.paths.parts import place_at, settled
from stages.model.helps import StartRule

SAME_MM = 1e-6
"""Lengths and heights nearer than this are the same: the first counts, whatever way the part was turned."""

CORNER_RAD = np.radians(5.0)
"""Joints that turn less are no corners: fitted arcs meet at 0.2 deg."""

TWICE_LEAST = 2.0


def starts(path: ArcPath, rule: StartRule | float) -> list[float]:
    """Return the places at which a closed path may begin, the best first, none twice."""
    every = settled(path, np.array([*_candidates(path, rule)]), LEAST_PIECE_MM) % path.bulges.size
    return list(dict.fromkeys(every.tolist()))


def _candidates(path: ArcPath, rule: StartRule | float) -> Iterator[float]:
    """Yield what the rule names, then the middles of long pieces and the corners."""
    if isinstance(rule, float):
        yield place_at(path, rule * float(lengths(path).sum()))
    elif rule == "as-drawn":
        yield 0.0
    elif rule == "corner":
        yield from corners(path)[:1].tolist()
    elif rule in SIDES:
        yield float(_outermost(path, rule))
    yield from middles(path)
    yield from corners(path).tolist()
    yield 0.0


SIDES: dict[str, tuple[int, float]] = {"left": (0, 1.0), "right": (0, -1.0), "bottom": (1, 1.0), "top": (1, -1.0)}
"""The coordinate that is least at a side, and with which sign."""


def _outermost(path: ArcPath, rule: str) -> int:
    """Return the vertex nearest to a side; of several the lowest, or the one furthest to the left."""
    axis, sign = SIDES[rule]
    rounded = np.round(path.vertices / SAME_MM)
    return int(np.lexsort((rounded[:, 1 - axis], sign * rounded[:, axis]))[0])


def corners(path: ArcPath) -> Numbers:
    """Return the vertices at which a closed path turns like a corner, the sharpest first."""
    turn = np.abs(joint_turns(path))
    found = np.flatnonzero(turn >= CORNER_RAD)
    return found[np.argsort(-_stepped(turn[found]), kind="stable")]


def middles(path: ArcPath) -> Iterator[float]:
    """Yield the middles of the pieces of a path, lines before arcs, the longest first."""
    long = lengths(path)
    for piece in np.lexsort((-_stepped(long), sweeps(path) != 0.0)).tolist():
        if long[piece] >= TWICE_LEAST * LEAST_PIECE_MM:
            yield piece + 0.5


def _stepped(values: Values) -> Values:
    """Return values in whole steps, so that those which differ by rounding are the same."""
    steps: Values = np.round(values / SAME_MM)
    return steps
