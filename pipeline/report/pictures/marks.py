"""What is drawn on a flat pattern beside its contours: marks, bend lines, texts."""

from collections.abc import Sequence

import numpy as np

from pipeline.report.pictures.canvas import INK, PURPLE, Canvas, Fit
from stages.geometry.arrays import Points2
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import FlatPattern, Mark

POINTS_PER_INCH = 72.0
LEAST_POINTS = 3.0
"""Smaller type is a grey smear."""
Dashes = tuple[float, ...]
STYLES: dict[str, tuple[str, str, Dashes]] = {
    "dashed": ("mark", INK, (5.0, 2.0)),
    "dash-dotted": ("bend line", PURPLE, (8.0, 2.0, 2.0, 2.0)),
    "dotted": ("sew line", INK, (1.0, 1.6)),
    "solid": ("slit", INK, ()),
}
"""How lines beside the contours are drawn: what they are, their colour and dashes."""


def draw_marks(canvas: Canvas, pattern: FlatPattern, fit: Fit) -> None:
    """Draw the lines beside the contours, each sort in its own style, and texts as they will be written."""
    for style, (_, colour, dashes) in STYLES.items():
        paths = [mark.path for mark in pattern.marks if _style(mark) == style]
        canvas.lines([fit.place(mark_points(path, fit)) for path in paths], colour, 0.8, dashes)
    for text in pattern.texts:
        size = text.height_mm * fit.scale * POINTS_PER_INCH / CAPITAL
        if size >= LEAST_POINTS:
            along = fit.turn(np.array([np.cos(np.radians(text.angle_deg)), np.sin(np.radians(text.angle_deg))]))
            angle = float(np.degrees(np.arctan2(along[1], along[0])))
            canvas.text(fit.place(text.at[None])[0], text.text, size, angle_deg=angle)


def _style(mark: Mark) -> str:
    """Return how a line is drawn."""
    if mark.layer.startswith("BEND"):
        return "dash-dotted"
    return {"SEW": "dotted", "CUT_SLIT": "solid"}.get(mark.layer, "dashed")


CAPITAL = 0.73
"""Height of capitals as a share of the type size."""


def has_bends(pattern: FlatPattern) -> bool:
    """Return whether bend lines are drawn: they lie along rulings, and both would be too many lines."""
    return any(mark.layer.startswith("BEND") for mark in pattern.marks)


def marks_legend(pattern: FlatPattern) -> list[str]:
    """Return what the lines mean, with their numbers."""
    counts = {how: _count([mark for mark in pattern.marks if _style(mark) == how]) for how in STYLES}
    named = [f"{how}: {count} {STYLES[how][0]}{'s' * (count > 1)}" for how, count in counts.items() if count]
    stitches = sum(hole.purpose == "stitch" for hole in pattern.inner)
    return [*named, *([f"{stitches} stitch holes"] if stitches else [])]


def _count(marks: Sequence[Mark]) -> int:
    """Return how many lines of one style there are; a bend line that holes cut into pieces is one."""
    return len({mark.name for mark in marks}) if marks and marks[0].layer.startswith("BEND") else len(marks)


def mark_points(path: ArcPath, fit: Fit) -> Points2:
    """Return a path as points in mm, finer than can be seen."""
    points = arcpath.polygon(path, accuracy=fit.fine_mm)
    return np.vstack([points, points[:1]]) if path.closed else points
