"""The flat pattern: exact edges, the lines and arcs that will be cut, and what is drawn on it.

Flat frame, mm: c0(0) at the origin, the first ruling along +x, seen from the side of p x c0'.
"""

from dataclasses import dataclass
from typing import Literal

from stages.geometry.arcpath import ArcPath
from stages.geometry.arrays import ArrayValue, Points2, Vector2
from stages.geometry.plane import PlaneCurve
from stages.model.sheet import Quality


@dataclass(frozen=True, slots=True)
class Contour:
    """A closed contour: outer counter-clockwise, inner clockwise.

    edges: the exact edges in order, each beginning where the one before ends (to rounding).
    path: closed lines and arcs within `chord_mm` of the edges; what is nested, written and cut.
    """

    edges: tuple[PlaneCurve, ...]
    path: ArcPath
    chord_mm: float
    name: str = ""


LETTER_WIDTH = 1.0
"""Width of a letter in heights: the widest letters of the fonts that readers put in for STANDARD."""

MarkLayer = Literal["MARK", "BEND_UP", "BEND_DOWN", "ROLL", "ENGRAVE"]


@dataclass(frozen=True, slots=True)
class Mark:
    """A line that is not cut: etched, or drawn for whoever bends or rolls the part."""

    name: str
    path: ArcPath
    layer: MarkLayer = "MARK"


@dataclass(frozen=True, slots=True, eq=False)
class Text(ArrayValue):
    """A text with its middle at a point, `height_mm` high, its baseline `angle_deg` from x."""

    name: str
    text: str
    at: Vector2
    height_mm: float
    angle_deg: float


@dataclass(frozen=True, slots=True, eq=False)
class FlatPattern(ArrayValue):
    """One part, flat.

    quantity: copies wanted.
    rotations: angles in degrees it may be turned by in the nest, or "free"; None: what the nest allows.
    quality: what zones of a sheet it may lie in.
    axis_deg: direction in the flat frame that goes along the grain of the sheet, either way; None: any.
    axis_band_deg: how far it may stray from it.
    pair: every second copy is the mirror image.
    label_at: a point inside the part where its name may be written, as far from the contours as can be had.
    corners: c0(0), c1(0), c1(1), c0(1) in the flat frame, shape (4, 2); those of the bounding box for a plate.
    """

    part: str
    quantity: int
    outer: Contour
    inner: tuple[Contour, ...]
    marks: tuple[Mark, ...]
    label_at: Vector2
    corners: Points2
    rotations: tuple[float, ...] | Literal["free"] | None = None
    thickness_mm: float | None = None
    density_kg_m3: float | None = None
    texts: tuple[Text, ...] = ()
    quality: Quality = "best"
    axis_deg: float | None = None
    axis_band_deg: float = 0.0
    pair: bool = False
