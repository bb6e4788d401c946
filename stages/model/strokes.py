"""In which order the paths of one part are cut: marks as drawn, holes from small to large, the outline last.

Once the outline is cut the part may tip or slide, and nothing on it lands in its place any more.
"""

from dataclasses import dataclass
from typing import Literal

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, area
from stages.model.pattern import FlatPattern, MarkLayer

StrokeLayer = MarkLayer | Literal["CUT_INNER", "CUT_OUTER"]


@dataclass(frozen=True, slots=True)
class Stroke:
    """A path, its layer and name; `contour` numbers the contours of a part, the outer one 0, and is None for a mark."""

    layer: StrokeLayer
    path: ArcPath
    contour: int | None = None
    name: str = ""


def turned_over(pattern: FlatPattern, motion: Rigid2) -> bool:
    """Return whether a copy lies with its lower side up: mirrored, and not because it is a mirror image."""
    return motion.mirrored and not pattern.pair


def seen_from_below(layer: str) -> str:
    """Return the layer of a mark on a copy that is turned over: what bends up bends down then."""
    if layer == "BEND_UP":
        return "BEND_DOWN"
    return "BEND_UP" if layer == "BEND_DOWN" else layer


def strokes(pattern: FlatPattern) -> tuple[Stroke, ...]:
    """Return the paths of a part in the order they are cut, in its flat frame."""
    inner = sorted(range(len(pattern.inner)), key=lambda i: abs(area(pattern.inner[i].path)))
    marks = [Stroke(mark.layer, mark.path, name=mark.name) for mark in pattern.marks]
    holes = [Stroke("CUT_INNER", pattern.inner[i].path, i + 1, pattern.inner[i].name) for i in inner]
    return *marks, *holes, Stroke("CUT_OUTER", pattern.outer.path, 0)
