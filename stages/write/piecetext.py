"""What a pattern file says in words: of each piece, inside it, and of the style, beside all pieces.

Each text is a key and a value, as ASTM D6673 has them and as programs write them: of a piece its name, size, category,
annotation (the thickness of the material), quantity and material; of the style its name, date, author, sample size,
grade rule table, units and the tolerance of curves.  Sizes are not graded here: there is one, and no rule table.  The
date is the one that all drawings have, since the same job gives the same bytes.
"""

from collections.abc import Sequence
from itertools import chain

import numpy as np

from stages.geometry.curves.rigid import Rigid2, apply
from stages.model.cutfile import Style
from stages.model.pattern import LETTER_WIDTH, FlatPattern
from stages.write.drawing import LABEL_FILL, LABEL_LEAST_MM, Label, room

PIECE_KEYS = ("Piece Name", "Size", "Category", "Quantity")
"""What no piece may lack."""

STYLE_KEYS = ("Style Name", "Creation Date", "Creation Time", "Author", "Sample Size", "Grade Rule Table", "Units")
UNITS = "METRIC"
"""Millimetres."""

STANDARD_TEXT = "ASTM/D13Proposal 1 Version: D 6673-04"
"""By this line programs tell such a file; the edition of 2010 has the same layers."""

STYLE_HEIGHT_MM, PIECE_MOST_MM = 5.0, 5.0
LINE_STEP = 1.6
"""From line to line, in heights."""

BELOW_MM = 10.0
"""Between the lowest piece and the first line of the style."""


def piece_text(pattern: FlatPattern, motion: Rigid2, name: str, quantity: str, style: Style) -> tuple[Label, ...]:
    """Return the texts of a piece, one below the other about the place of its name, as large as fits there."""
    thickness = [] if pattern.thickness_mm is None else [f"Annotation: {pattern.thickness_mm:g} mm thick"]
    material = [f"Material: {style.material}"] if style.material else []
    lines = [
        f"Piece Name: {name}",
        f"Size: {style.size}",
        f"Category: {pattern.part}",
        *thickness,
        f"Quantity: {quantity}",
        *material,
    ]
    return _stacked(lines, pattern, motion)


def _stacked(lines: Sequence[str], pattern: FlatPattern, motion: Rigid2) -> tuple[Label, ...]:
    """Return lines that begin below each other, the middle of all at the place of the part's name."""
    wide = LETTER_WIDTH * max(map(len, lines))
    high = LINE_STEP * len(lines)
    fits = 2.0 * LABEL_FILL * room(pattern) / float(np.hypot(wide, high))
    height = float(np.clip(fits, LABEL_LEAST_MM, PIECE_MOST_MM))
    middle, angle = apply(motion, pattern.label_at[None, :])[0], np.radians(motion.angle_deg)
    along, up = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    first = middle - wide / 2.0 * height * along + (high / 2.0 - 1.0) * height * up
    return tuple(
        Label("PIECE_TEXT", text, first - number * LINE_STEP * height * up, height, motion.angle_deg)
        for number, text in enumerate(lines)
    )


def style_text(style: Style, chord_mm: float, corner: tuple[float, float]) -> tuple[Label, ...]:
    """Return the texts of the style, below all that is drawn.  corner: the lower left one of it."""
    values = (style.name, "01-01-2000", "12:00", "planish", style.size, "NONE", UNITS)
    pairs = (f"{key}: {value}" for key, value in zip(STYLE_KEYS, values, strict=True))
    lines = chain((STANDARD_TEXT,), pairs, (f"Curve Tolerance: {chord_mm:g}",))
    low_x, low_y = corner
    return tuple(
        Label("PIECE_TEXT", text, np.array([low_x, low_y - BELOW_MM - number * LINE_STEP * STYLE_HEIGHT_MM]),
              STYLE_HEIGHT_MM, 0.0)
        for number, text in enumerate(lines)
    )  # fmt: skip
