"""What can be measured of a blank: width, height, and what the traveller has between its corners (`report.tape`).

    edge c0, edge A-B     along an edge, by its name on the surface or by the letters of its ends
    straight A-B          between the ends of an edge that is not straight
    diagonal 1, 2 ...     in the order of the traveller

All are the report's own figures.  What a kerf does to a size (`rate`, mm per mm) is known for a blank with straight
sides; other sizes are compared and no kerf is fitted to them.
"""

from collections.abc import Iterator
from itertools import count
from math import isclose

import numpy as np

from pipeline.asmade.sizes import SAME, Dimension, length
from pipeline.report.shopentries import FlatEntry, SpanEntry, TapeEntry
from pipeline.report.tape import EDGE
from stages.geometry.arrays import Points2
from stages.unroll.asmade import corner_moves, distance_rate

FEWEST_CORNERS = 3


def blank_sizes(part: str, flat: FlatEntry, tape: TapeEntry | None) -> Iterator[Dimension]:
    """Yield what can be measured of the blank of a part."""
    corners = polygon(flat, tape)
    for axis, (what, size) in enumerate((("width", flat.blank.width), ("height", flat.blank.height))):
        yield length(part, what, "blank", size, rate=None if corners is None else _extent_rate(corners, axis))
    at = {letter: i for i, spot in enumerate(tape.spots) for letter in spot.letters} if tape is not None else {}
    for what, span, size in _sizes(tape):
        rate = None if corners is None else _rate(corners, at[span.first], at[span.last])
        yield length(part, what, "blank", size, rate=rate)


def polygon(flat: FlatEntry, tape: TapeEntry | None) -> Points2 | None:
    """Return the corners of a blank whose sides are all straight, counter-clockwise, mm; None of any other."""
    sides = [span.straight_mm for span in tape.spans if span.along_mm is not None] if tape is not None else []
    straight = isclose(sum(sides), flat.blank.outline_length, rel_tol=SAME)
    if tape is None or len(tape.spots) < FEWEST_CORNERS or not straight:
        return None
    return np.array([(spot.x, spot.y) for spot in tape.spots])


def _sizes(tape: TapeEntry | None) -> Iterator[tuple[str, SpanEntry, float]]:
    """Yield the distances between corners by their names."""
    diagonals = count(1)
    for span in tape.spans if tape is not None else ():
        ends = f"{span.first}-{span.last}"
        if span.along_mm is None:
            yield f"diagonal {next(diagonals)}", span, span.straight_mm
            continue
        yield f"edge {ends if span.what == EDGE else span.what}", span, span.along_mm
        if not isclose(span.along_mm, span.straight_mm, rel_tol=SAME):
            yield f"straight {ends}", span, span.straight_mm


def _rate(corners: Points2, i: int, j: int) -> float:
    """Return by how much the distance of two corners grows per mm of kerf."""
    moves = corner_moves(corners)
    return distance_rate(corners[i], corners[j], moves[i], moves[j])


def _extent_rate(corners: Points2, axis: int) -> float:
    """Return by how much the width (0) or the height (1) grows per mm of kerf."""
    low, high = int(corners[:, axis].argmin()), int(corners[:, axis].argmax())
    moves = corner_moves(corners)
    return float(moves[high, axis] - moves[low, axis])
