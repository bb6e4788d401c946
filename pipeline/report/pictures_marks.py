"""What is drawn on a flat pattern beside its contours: marks, bend lines, texts."""

import numpy as np

from pipeline.report.pictures_canvas import INK, PURPLE, Canvas, Fit
from stages.geometry import arcpath
from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import Points2
from stages.model.pattern import FlatPattern

POINTS_PER_INCH = 72.0
LEAST_POINTS = 3.0
"""Smaller type is a grey smear."""
BEND_DASHES, MARK_DASHES = (8.0, 2.0, 2.0, 2.0), (5.0, 2.0)


def draw_marks(canvas: Canvas, pattern: FlatPattern, fit: Fit) -> None:
    """Draw marks dashed, bend lines dash-dotted in a colour of their own, texts as they will be written."""
    for bends, colour, dashes in ((False, INK, MARK_DASHES), (True, PURPLE, BEND_DASHES)):
        paths = [mark.path for mark in pattern.marks if mark.layer.startswith("BEND") == bends]
        canvas.lines([fit.place(mark_points(path, fit)) for path in paths], colour, 0.8, dashes)
    for text in pattern.texts:
        size = text.height_mm * fit.scale * POINTS_PER_INCH / CAPITAL
        if size >= LEAST_POINTS:
            along = fit.turn(np.array([np.cos(np.radians(text.angle_deg)), np.sin(np.radians(text.angle_deg))]))
            angle = float(np.degrees(np.arctan2(along[1], along[0])))
            canvas.text(fit.place(text.at[None])[0], text.text, size, angle_deg=angle)


CAPITAL = 0.73
"""Height of capitals as a share of the type size."""


def has_bends(pattern: FlatPattern) -> bool:
    """Return whether bend lines are drawn: they lie along rulings, and both would be too many lines."""
    return any(mark.layer.startswith("BEND") for mark in pattern.marks)


def marks_legend(pattern: FlatPattern) -> list[str]:
    """Return what the lines mean, with their numbers."""
    bends = sum(mark.layer.startswith("BEND") for mark in pattern.marks)
    marks = len(pattern.marks) - bends
    counts = (("dashed", marks, "mark"), ("dash-dotted", bends, "bend line"))
    return [f"{how}: {count} {what}{'s' * (count > 1)}" for how, count, what in counts if count]


def mark_points(path: ArcPath, fit: Fit) -> Points2:
    """Return a path as points in mm, finer than can be seen."""
    points = arcpath.polygon(path, accuracy=fit.fine_mm)
    return np.vstack([points, points[:1]]) if path.closed else points
