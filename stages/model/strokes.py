"""In which order the paths of one part are cut: marks as drawn, holes from small to large, the outline last.

Once the outline is cut the part may tip or slide, and nothing on it lands in its place any more.
"""

from dataclasses import dataclass
from typing import Literal

from stages.geometry.arcpath import ArcPath, area
from stages.model.pattern import FlatPattern, MarkLayer


@dataclass(frozen=True, slots=True)
class Stroke:
    """A path and its layer; `contour` numbers the contours of a part, the outer one 0, and is None for a mark."""

    layer: MarkLayer | Literal["CUT_INNER", "CUT_OUTER"]
    path: ArcPath
    contour: int | None = None


def strokes(pattern: FlatPattern) -> tuple[Stroke, ...]:
    """Return the paths of a part in the order they are cut, in its flat frame."""
    inner = sorted(range(len(pattern.inner)), key=lambda i: abs(area(pattern.inner[i].path)))
    marks = [Stroke(mark.layer, mark.path) for mark in pattern.marks]
    holes = [Stroke("CUT_INNER", pattern.inner[i].path, i + 1) for i in inner]
    return *marks, *holes, Stroke("CUT_OUTER", pattern.outer.path, 0)
