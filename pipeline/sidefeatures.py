"""What a part was given and its drawing does not say, for the side file of its flat drawing.

Holes that are contours are in its table of contours; here are names, notches, and the holes that a pattern file says by
points.
"""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from pipeline.sideentries import DrillSide, FeatureSide, MarkSide, NotchSide, Pair, Row3

if TYPE_CHECKING:
    from pipeline.run import PartRun
    from stages.geometry.arrays import Vector2
    from stages.model.cutfile import Machine
    from stages.model.pattern import FlatPattern


def features(run: "PartRun", marks: Sequence[MarkSide], machine: "Machine") -> FeatureSide | None:
    """Return the features of a part; marks: as they follow in its drawing, a grain line among them."""
    from stages.model.pattern import MARK_LAYERS

    pattern = run.pattern
    if pattern is None:
        return None
    return FeatureSide(
        marks=tuple(mark for mark in marks if mark.layer in MARK_LAYERS),
        texts=tuple(text.name for text in pattern.texts) if machine.text == "TEXT" else (),
        notches=tuple(_notches(pattern)),
        drills=tuple(_drills(pattern)) if machine.flavour == "aama" else (),
        boundary=_boundary(pattern),
    )


def _notches(pattern: "FlatPattern") -> Iterator[NotchSide]:
    for one in pattern.notches:
        sizes = one.depth_mm, one.width_mm
        yield NotchSide(one.name, one.kind, _pair(one.at), _pair(one.inward), *sizes, one.in_outline, one.is_cut)


def _drills(pattern: "FlatPattern") -> Iterator[DrillSide]:
    """Yield the holes that a pattern file says by points, in the order in which it has them."""
    from stages.write.tracing import drill_of

    for drill in pattern.drills or filter(None, map(drill_of, pattern.inner)):
        yield DrillSide(drill.name, drill.purpose, _pair(drill.at), drill.diameter_mm)


def _pair(place: "Vector2") -> Pair:
    x, y = place.tolist()
    return x, y


def _boundary(pattern: "FlatPattern") -> tuple[Row3, ...] | None:
    if pattern.boundary is None:
        return None
    path = pattern.boundary.path
    return tuple((x, y, bulge) for (x, y), bulge in zip(path.vertices.tolist(), path.bulges.tolist(), strict=True))
