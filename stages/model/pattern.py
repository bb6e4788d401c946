"""The flat pattern: exact edges, the lines and arcs that will be cut, and what is drawn on it.

Flat frame, mm: c0(0) at the origin, the first ruling along +x, seen from the side of p x c0'.
"""

from dataclasses import dataclass
from typing import Literal, get_args

from stages.geometry.arrays import ArrayValue, Points2, Vector2
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import Side
from stages.model.features import NotchKind
from stages.model.sheet import Quality

Purpose = Literal["cut", "drill", "stitch"]


@dataclass(frozen=True, slots=True)
class Traced:
    """What a pattern file says of a contour of chords: which vertices are turn points, and the same contour finer."""

    turns: tuple[bool, ...]
    finer: ArcPath


@dataclass(frozen=True, slots=True)
class Contour:
    """A closed contour: outer counter-clockwise, inner clockwise.

    edges: the exact edges in order, each beginning where the one before ends (to rounding).
    path: closed lines and arcs within `chord_mm` of the edges; what is nested, written and cut.
    side: on which side of the edges the path may lie; outside: the part only grows, a hole only shrinks.
    purpose: of a hole: one that is drilled, a round one that is stitched through, or any other.
    traced: where the path is one of a pattern file.
    nominal: the path as it was, where the one that is written lies half a kerf beside it.
    """

    edges: tuple[PlaneCurve, ...]
    path: ArcPath
    chord_mm: float
    name: str = ""
    purpose: Purpose = "cut"
    side: Side = "either"
    traced: Traced | None = None
    nominal: ArcPath | None = None


LETTER_WIDTH = 1.0
"""Width of a letter in heights: the widest letters of the fonts that readers put in for STANDARD."""

MarkLayer = Literal["MARK", "BEND_UP", "BEND_DOWN", "ROLL", "ENGRAVE", "SEW", "CUT_SLIT"]
MARK_LAYERS: tuple[MarkLayer, ...] = get_args(MarkLayer)


@dataclass(frozen=True, slots=True)
class Mark:
    """A line beside the contours: etched, drawn for whoever bends, rolls or sews the part, or (CUT_SLIT) a slit."""

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


Spot = tuple[int, float]
"""A place on an outline: the number of the edge, and t on it."""


@dataclass(frozen=True, slots=True, eq=False)
class NotchPlace(ArrayValue):
    """A notch: where it is on the edge that is cut, as that was before, and the unit vector into the part.

    in_outline: whether its shape is part of the outer contour; else it is lines on MARK or CUT_SLIT of its name.
    spot: where that is on the outline without notches.  is_cut: whether it is cut, or only marked.
    """

    name: str
    kind: NotchKind
    at: Vector2
    inward: Vector2
    depth_mm: float
    width_mm: float
    in_outline: bool
    spot: Spot
    is_cut: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Drill(ArrayValue):
    """A round hole that a pattern file says by its centre and diameter, for a machine with a drill or a punch."""

    name: str
    at: Vector2
    diameter_mm: float
    purpose: Purpose = "drill"


@dataclass(frozen=True, slots=True)
class EdgeRun:
    """A named edge of a pattern: edges first to last (exclusive) of its outline; `backwards`: it runs against that."""

    name: str
    first: int
    last: int
    backwards: bool = False


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
    notches: along the outline.  boundary: the outer contour before they were cut into it; None: they were not.
    sides: of the boundary by name, those of the surface that was laid flat.
    drills: round holes that are not among the inner contours, since a pattern file says them otherwise.
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
    notches: tuple[NotchPlace, ...] = ()
    boundary: Contour | None = None
    drills: tuple[Drill, ...] = ()
    sides: tuple[EdgeRun, ...] = ()
