"""Whether the texts of a pattern lie on the part: the box of each against the lines and arcs that will be cut.

The box is as high as the letters and as wide as they can be: `LETTER_WIDTH` heights each, which the widest letters of
the fonts that readers put in for STANDARD take up.  Narrow letters take half of that: what is told of may just fit.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from stages.geometry.arrays import Array, Points2
from stages.geometry.paths import clearance, enclosed
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.clearance import Pieces
from stages.model.pattern import LETTER_WIDTH, Contour, Text
from stages.model.report import Finding


def text_findings(texts: Sequence[Text], outer: Contour, inner: Sequence[Contour]) -> tuple[Finding, ...]:
    """Return what is to be said of texts that reach over the outline or over a hole."""
    if not texts:
        return ()
    paths = [(contour, clearance.pieces(contour.path)) for contour in (outer, *inner)]
    return tuple(finding for text in texts for finding in _findings(text, paths))


def text_box(text: Text, share: float = 1.0) -> Points2:
    """Return the corners of a text's box, of a share of its size, counter-clockwise, mm."""
    half = share * text.height_mm / 2.0 * np.array([LETTER_WIDTH * len(text.text), 1.0])
    angle = np.radians(text.angle_deg)
    turn: Array = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners: Points2 = text.at + (SQUARE * half) @ turn.T
    return corners


SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def _findings(text: Text, paths: Sequence[tuple[Contour, Pieces]]) -> Iterator[Finding]:
    """Yield where a text is not on the part: outside the outline, over holes."""
    off = [contour for number, (contour, path) in enumerate(paths) if not _clear(text, 1.0, path, hole=number > 0)]
    if not off:
        return
    room = _room(text, [path for _, path in paths])
    cure = f"a height of {room:.4g} mm would do" if room > 0.0 else "it stands off the part"
    for contour in off:
        outside = contour is paths[0][0]
        what = "reaches over the outline" if outside else f"lies over {contour.name}"
        wide, high = LETTER_WIDTH * len(text.text) * text.height_mm, text.height_mm
        message = f"{text.name}: {text.text!r}, up to {wide:.4g} x {high:.4g} mm, {what}; {cure}"
        where: dict[str, float | int | str] = {"feature": text.name, "x": float(text.at[0]), "y": float(text.at[1])}
        yield Finding("text-outside" if outside else "text-over-hole", message, where=where)


def _clear(text: Text, share: float, path: Pieces, *, hole: bool) -> bool:
    """Return whether a text of a share of its size is clear of a contour: inside the outline, or outside a hole."""
    corners = text_box(text, share)
    box = clearance.pieces(ArcPath(corners, np.zeros(4), closed=True))
    if clearance.clearance(box, path, within=0.0) == 0.0:
        return False
    # a corner may lie on a chord of the contour, not most of them
    inside = 2 * np.count_nonzero(enclosed.inside(corners, path)) > len(corners)
    around = enclosed.inside(path.start[:1], box).any()
    return bool(not inside and not around if hole else inside)


def _room(text: Text, paths: Sequence[Pieces]) -> float:
    """Return the largest height at which a text is clear of all contours, mm, by halving; 0 if there is none."""
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        share = (low + high) / 2.0
        fits = all(_clear(text, share, path, hole=number > 0) for number, path in enumerate(paths))
        low, high = (share, high) if fits else (low, share)
    return low * text.height_mm


HALVINGS = 14
"""To four digits of the height, which is what is told."""
