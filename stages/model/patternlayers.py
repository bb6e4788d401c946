"""The layers of a pattern file as ASTM D6673-10 numbers them (which is DXF-AAMA, ANSI/AAMA-292, with more layers).

Each meaning has its number and a colour; meanings that share a number are told apart by the colour.  What a knife draws
but does not cut lies on 8, what it cuts inside a piece on 11.  The standard knows no stock: a sheet and its defects are
lines that are drawn.  Stripe and plaid lines (9, 10) are of cloth and are never written; neither is 12, left blank.

Source: ASTM D6673-10, table of layers, as given by the documentation of Patro ("DXF ASTM File Format").
"""

from stages.model.cutfile import LAYER_COLOURS, Layer
from stages.model.features import NotchKind

BOUNDARY, TURN, CURVE = "1", "2", "3"
GRAIN, INTERNAL, CUT_OUT, DRILL, SEW, ANNOTATION = "7", "8", "11", "13", "14", "15"
STANDARD = frozenset([*map(str, range(1, 16)), *map(str, range(80, 88))])
"""All layers of the standard."""

NOTCH_LAYERS: dict[NotchKind, str] = {"v": "4", "slit": "4", "t": "80", "castle": "81", "u": "83"}
"""A V notch has a width, a slit none; 82 is for a check notch, of which one side is square to the edge."""

VALIDATION = {BOUNDARY: "84", INTERNAL: "85", CUT_OUT: "86", SEW: "87"}
"""Where the curve that lines of a layer stand for is given finer, so that who draws a curve of his own can compare."""

FLAGGED = frozenset(VALIDATION)
"""The layers whose vertices are turn points or curve points."""

POINTS_ONLY = frozenset({TURN, CURVE, DRILL, *NOTCH_LAYERS.values()})

_NUMBERS = {"CUT_OUTER": BOUNDARY, "CUT_INNER": CUT_OUT, "CUT_SLIT": CUT_OUT, "SEW": SEW, "LABEL": ANNOTATION}
_ADDED = {"PIECE_TEXT": Layer(BOUNDARY, LAYER_COLOURS["LABEL"]), "GRAIN": Layer(GRAIN, 7)}

PATTERN_LAYERS: dict[str, Layer] = {
    **{meaning: Layer(_NUMBERS.get(meaning, INTERNAL), colour) for meaning, colour in LAYER_COLOURS.items()},
    **_ADDED,
}
"""The layers of paths and texts by what they mean, as in profiles of other files."""

POINT_COLOUR = 7
"""Of points and of validation curves: white or black, whatever the background is not."""


def is_pattern_profile(layers: object) -> bool:
    """Return whether layers, by what they mean, are those of a pattern file."""
    return isinstance(layers, dict) and layers.keys() >= _ADDED.keys()
