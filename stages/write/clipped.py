"""What is to be said of texts as strokes that do not lie on their part as a whole, before anything is written."""

from collections.abc import Iterator, Sequence
from math import fsum

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, length, transform
from stages.model.cutfile import Machine
from stages.model.pattern import FlatPattern, Text
from stages.model.report import Finding
from stages.model.sheet import SheetLayout
from stages.write.drawing import moved_text
from stages.write.onpart import on_part, region_of
from stages.write.strokefont import lettering

LEAST_SHARE = 1.0 - 1e-9
"""A text of which this share of its strokes is left lies on its part."""

AS_DRAWN, MIRRORED = Rigid2(), Rigid2(mirrored=True)


def clipped_texts(
    patterns: Sequence[FlatPattern], layouts: Sequence[SheetLayout], machine: Machine
) -> Iterator[Finding]:
    """Yield the texts of which strokes are cut off, with their place on the part.

    Letters are not mirrored with a copy: on that they may reach over another edge than on the part as drawn.
    """
    if machine.text != "strokes":
        return
    turned = {placed.part for layout in layouts for placed in layout.placements if placed.motion.mirrored}
    for pattern in patterns:
        for text in pattern.texts:
            left = min(_left(pattern, text, motion) for motion in _ways(pattern.part in turned))
            if left < LEAST_SHARE:
                yield _finding(pattern, text, left)


def _ways(mirrored: bool) -> tuple[Rigid2, ...]:
    return (AS_DRAWN, MIRRORED) if mirrored else (AS_DRAWN,)


def _left(pattern: FlatPattern, text: Text, motion: Rigid2) -> float:
    """Return which share of the strokes of a text lies on its part."""
    label = moved_text(text, motion)
    strokes = lettering(label.text, label.at, label.height_mm, label.angle_deg)
    contours = [transform(contour.path, motion) for contour in (pattern.outer, *pattern.inner)]
    whole = _long(strokes)
    return _long(on_part(strokes, region_of(contours))) / whole if whole else 1.0


def _long(strokes: Sequence[ArcPath]) -> float:
    return fsum(map(length, strokes))


def _finding(pattern: FlatPattern, text: Text, left: float) -> Finding:
    x, y = text.at.tolist()
    share = f"is cut off at a contour, {100.0 * left:.3g} % of it is engraved"
    what = "does not lie on the part" if left == 0.0 else share
    message = f"{pattern.part}, {text.name}: the text {text.text!r} at ({x:.6g}, {y:.6g}) {what}"
    where: dict[str, float | int | str] = {"part": pattern.part, "feature": text.name, "x": x, "y": y}
    return Finding("text-clipped", f"{message}; move it, or give it a smaller height", where=where)
