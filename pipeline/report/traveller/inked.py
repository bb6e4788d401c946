"""A pattern as pages draw it: its contours are a form of the file, however often they are shown, its marks strokes."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from pipeline.report.traveller.paths import extents, joined, outlines
from pipeline.report.view.entries import FlatView, MarkView, PathView
from stages.geometry.paths.arcpath import ArcPath
from stages.write.drawing import clear_mm
from stages.write.pdfbook import Form

BESIDE = 0.1
"""Around contours, for the width of their lines, which is never so large a share of what is shown."""

Pair = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Inked:
    """A pattern: the number of the form that draws its contours, that form, its marks by layers, its extent in mm."""

    number: int
    form: Form
    marks: tuple[tuple[str, str], ...]
    low: Pair
    high: Pair


def inked(flat: FlatView, number: int) -> Inked:
    """Return a pattern whose contours are the form of that number."""
    marks = sorted(flat.marks, key=_layer)
    paths = joined([*flat.contours, *marks])
    count = len(flat.contours)
    boxes, drawn = extents(paths), outlines(paths)
    low, high = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
    outer_low, outer_high = boxes[0, :2], boxes[0, 2:]
    beside = BESIDE * float((outer_high - outer_low).max())
    (x, y), (to_x, to_y) = (outer_low - beside).tolist(), (outer_high + beside).tolist()
    form = Form((x, y, to_x, to_y), " h ".join(drawn[:count]) + " h B*\n")
    return Inked(number, form, tuple(_strokes(marks, drawn[count:])), (low[0], low[1]), (high[0], high[1]))


def _layer(mark: MarkView) -> str:
    return mark.layer


def _strokes(marks: Iterable[MarkView], drawn: Iterable[str]) -> Iterable[tuple[str, str]]:
    """Yield the marks of each layer, drawn."""
    for layer, pairs in groupby(zip(marks, drawn, strict=True), key=lambda pair: pair[0].layer):
        yield layer, "".join(f"{path} {'s' if mark.closed else 'S'}\n" for mark, path in pairs)


def label_room_mm(flat: FlatView) -> float:
    """Return how far the place of a part's name is from all contours, mm."""
    return clear_mm(np.array(flat.label), map(arc_path, flat.contours))


def arc_path(path: PathView) -> ArcPath:
    """Return a path as a value."""
    rows = np.array(path.points).reshape(-1, 3)
    return ArcPath(rows[:, :2], rows[:, 2], path.closed)
