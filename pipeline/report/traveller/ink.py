"""Texts, lines and areas on a page of the traveller, as operators of PDF in mm; y runs upwards.

Colours are few: ink, a quieter grey, hairlines, one tint, and the colours that mean something (`GOOD`, `BAD`).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from math import cos, radians, sin
from typing import Literal

from stages.write.helvetica import MM_PER_POINT, REGULAR, Face, encoded, width_mm

Colour = tuple[float, float, float]
Align = Literal["left", "middle", "right"]

INK: Colour = (0.10, 0.11, 0.13)
QUIET: Colour = (0.42, 0.44, 0.47)
HAIR: Colour = (0.78, 0.79, 0.81)
TINT: Colour = (0.955, 0.96, 0.97)
PAPER: Colour = (1.0, 1.0, 1.0)
GOOD: Colour = (0.0, 0.36, 0.55)
BAD: Colour = (0.75, 0.22, 0.0)
BENDING: Colour = (0.55, 0.20, 0.45)
"""Blue and vermilion of Okabe and Ito, darkened for thin lines: told apart by all eyes and on a grey print."""

HAIR_MM, THIN_MM, LINE_MM, OUTLINE_MM = 0.12, 0.18, 0.3, 0.4


KEPT = 1024
"""Of what is said again and again, how much is kept: pens and lines are few, scales of patterns some hundred."""


@dataclass(frozen=True, slots=True)
class Pen:
    """How a text is set."""

    size_pt: float
    face: Face = REGULAR
    colour: Colour = INK
    align: Align = "left"
    angle_deg: float = 0.0


SHARES = {"left": 0.0, "middle": 0.5, "right": 1.0}
"""Of its width, how far a text lies left of its place."""


def numbers(values: Iterable[float]) -> str:
    """Return numbers as operators take them, to a micrometre: nothing that is measured is drawn here."""
    return " ".join([f"{value:.3f}".rstrip("0").rstrip(".") for value in values])


def said(x: float, y: float, text: str, pen: Pen) -> str:
    """Return a text, its baseline at a place."""
    back = SHARES[pen.align] * width_mm(text, pen.size_pt, pen.face) if pen.align != "left" else 0.0
    if pen.angle_deg == 0.0:
        return line_of([(x - back, y, text)], pen)
    c, s = cos(radians(pen.angle_deg)), sin(radians(pen.angle_deg))
    place = numbers((c, s, -s, c, x - back * c, y - back * s))
    return f"{_begun(pen)} {place} Tm {encoded(text)} Tj ET\n"


def line_of(texts: Iterable[tuple[float, float, str]], pen: Pen) -> str:
    """Return upright texts in letters of one kind, each from where its baseline begins."""
    made = [f"1 0 0 1 {x:.2f} {y:.2f} Tm {encoded(text)} Tj" for x, y, text in texts]
    return f"{_begun(pen)} {' '.join(made)} ET\n" if made else ""


@lru_cache(maxsize=KEPT)
def _begun(pen: Pen) -> str:
    """Return how a text begins: its typeface, size and colour."""
    return f"BT /{pen.face.key} {numbers((pen.size_pt * MM_PER_POINT,))} Tf {filled(pen.colour)}"


@lru_cache(maxsize=KEPT)
def filled(colour: Colour) -> str:
    """Return the colour that areas and letters have from here on."""
    return f"{numbers(colour)} rg"


@lru_cache(maxsize=KEPT)
def stroked(colour: Colour, width_mm: float, dash: str = "[] 0") -> str:
    """Return how lines are from here on."""
    width = f"{width_mm:.6f}".rstrip("0")
    return f"{numbers(colour)} RG {width} w {dash} d\n"


def rule(x: float, y: float, to_x: float, to_y: float) -> str:
    """Return a straight line."""
    return f"{numbers((x, y))} m {numbers((to_x, to_y))} l S\n"


def area(x: float, y: float, width: float, height: float, colour: Colour) -> str:
    """Return a filled rectangle from its lower left corner."""
    return f"{filled(colour)} {numbers((x, y, width, height))} re f\n"


def moved(content: str, x: float, y: float) -> str:
    """Return operators with their origin elsewhere."""
    return f"q 1 0 0 1 {numbers((x, y))} cm\n{content}Q\n"
