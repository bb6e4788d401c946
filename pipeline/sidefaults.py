"""What of a side file its own drawing contradicts: nothing is cut, punched or notched by numbers that cannot be meant.

Whether a file of that drawing was spoilt or made up does not matter: a round hole must be the one that is drawn, to the
chord; notches lie on the outline and drill holes within its box; the outline without notches is as large as the one
with them, to the size of a notch.  Names go into drawings and onto paper, and are plain text.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from pipeline.sideentries import DrillSide, FeatureSide, NotchSide, Row3
from stages.geometry.arrays import Array, norm
from stages.geometry.paths.arcpath import ArcPath, bounds, chords, distances, piece_count
from stages.model.pattern import Contour, FlatPattern

SLACK_MM = 1e-5
"""Drawings and side files say places to 1e-6 mm."""
UNIT = 1e-6
"""By how much the length of a unit vector may be off: rounding of its decimals."""
LONGEST_NAME = 200
"""Letters, as of names in a job file."""
HALF_TURN = 1.0 + 1e-9
"""The bulge of half a turn: pieces of an outline without notches are none above it, rounding apart."""

Said = tuple[str, Row3 | None]
"""Name and circle of a hole."""


def side_faults(pattern: FlatPattern, holes: Sequence[Said], said: FeatureSide) -> Iterator[str]:
    """Yield what is wrong; pattern: as drawn, holes: in the order of its inner contours."""
    yield from (f"{name[:40]!r} is no name" for name in _names(holes, said) if not _is_name(name))
    for drawn, (name, circle) in zip(pattern.inner, holes, strict=True):
        if circle is not None and not _is_circle(drawn, circle):
            yield f"hole {name!r}: a circle of {circle[2]:g} mm at ({circle[0]:g}, {circle[1]:g}) is not the one drawn"
    outline = pattern.outer.path
    if said.boundary is not None:
        wrong = _outline_fault(pattern.outer, np.array(said.boundary), said.notches)
        if wrong:
            yield f"the outline without notches {wrong}"
            return
        rows = np.array(said.boundary)
        outline = ArcPath(rows[:, :2], rows[:, 2], closed=True)
    for notch in said.notches:
        yield from (f"notch {notch.name!r}: {wrong}" for wrong in _notch_faults(notch, outline, pattern.outer.chord_mm))
    for drill in said.drills:
        if not _is_within(drill, outline):
            yield f"drill hole {drill.name!r}: {drill.diameter_mm:g} mm at ({drill.at[0]:g}, {drill.at[1]:g})"


def _names(holes: Sequence[Said], said: FeatureSide) -> Iterator[str]:
    yield from (name for name, _ in holes)
    yield from (mark.name for mark in said.marks)
    yield from (notch.name for notch in said.notches)
    yield from (drill.name for drill in said.drills)
    yield from said.texts


def _is_name(name: str) -> bool:
    return name.isprintable() and len(name) <= LONGEST_NAME


def _is_circle(drawn: Contour, circle: Row3) -> bool:
    """Return whether a hole as drawn is a circle to the chord."""
    x, y, diameter = circle
    off = np.abs(norm(drawn.path.vertices - [x, y]) - diameter / 2.0)
    return diameter > 0.0 and bool((off <= drawn.chord_mm + SLACK_MM).all())


def _outline_fault(drawn: Contour, rows: Array, notches: Sequence[NotchSide]) -> str:
    """Return what is wrong with the outline without notches, nothing if all is well."""
    if len(rows) < len("ab") or (np.abs(rows[:, 2]) > HALF_TURN).any():
        return "is none"
    path = ArcPath(rows[:, :2], rows[:, 2], closed=True)
    start, end = chords(path)
    if not (norm(end - start) > 0.0).all():
        return "has pieces without length"
    room = drawn.chord_mm + SLACK_MM + max((max(abs(one.depth_mm), abs(one.width_mm)) for one in notches), default=0.0)
    off = np.abs(np.array(bounds(path)) - np.array(bounds(drawn.path))).max()
    return "" if off <= room else f"reaches {off:.6g} mm further or less far than the one drawn"


def _notch_faults(notch: NotchSide, outline: ArcPath, chord_mm: float) -> Iterator[str]:
    count = piece_count(outline)
    off = float(distances(np.broadcast_to(np.array(notch.at), (count, 2)), outline, np.arange(count)).min())
    if not off <= chord_mm + SLACK_MM:
        yield f"{off:.6g} mm off the outline"
    if not abs(float(norm(np.array(notch.inward))) - 1.0) <= UNIT:
        yield f"({notch.inward[0]:g}, {notch.inward[1]:g}) is no unit vector"
    if not (notch.depth_mm > 0.0 and notch.width_mm >= 0.0):
        yield f"{notch.depth_mm:g} mm deep, {notch.width_mm:g} mm wide"


def _is_within(drill: DrillSide, outline: ArcPath) -> bool:
    """Return whether a drill hole lies in the box of the outline."""
    low_x, low_y, high_x, high_y = bounds(outline)
    radius, (x, y) = drill.diameter_mm / 2.0, drill.at
    return radius > 0.0 and low_x <= x - radius <= x + radius <= high_x and low_y <= y - radius <= y + radius <= high_y
