"""What stands in the side file of a drawing, schema planish-cut/1: every line for whoever cuts, bends or rolls by it.

Lengths are in mm, areas in mm2, angles in degrees, at full precision.  A point of a part's flat frame is a pair x, y;
`in_drawing` is the same point in the drawing, moved by the `matrix` of its copy: rows (a, c, e), (b, d, f) of

    x' = a x + c y + e,    y' = b x + d y + f.

`side` and the sign of an angle are those seen in the part's flat frame, up towards the viewer.  `layer` is that of the
drawing: on a copy that is turned over, up is down.
"""

from typing import Literal

from msgspec import Struct

Pair = tuple[float, float]
Ends = tuple[Pair, Pair]
Row3 = tuple[float, float, float]
Side = Literal["up", "down"]
Purpose = Literal["cut", "drill", "stitch"]
NotchKind = Literal["v", "u", "castle", "slit", "t"]


class JobSide(Struct, frozen=True):
    """Whose job it is; digest: as in its report."""

    name: str
    customer: str | None
    revision: str | None
    digest: str


class MaterialSide(Struct, frozen=True):
    """The sheet; thickness_mm: null where it is not known."""

    name: str
    thickness_mm: float | None


class FileSide(Struct, frozen=True):
    """The drawing in one format, below the output folder."""

    path: str
    sha256: str


class LayerSide(Struct, frozen=True):
    """What the file calls a layer, its AutoCAD colour index, and how many paths of which length lie on it."""

    name: str
    colour: int
    paths: int
    length_mm: float


class SheetSide(Struct, frozen=True):
    """A sheet in the drawing, and how far along x it was moved there: not at all, unless it lies beside others."""

    stock: str
    index: int
    shift_mm: float


class PlacementSide(Struct, frozen=True):
    """A copy on a sheet, as the report says it.

    drawn_as: what labels and file names call the part.  turned_over: mirrored, and not because it is a mirror image.
    """

    part: str
    drawn_as: str
    copy: int
    stock: str
    index: int
    x: float
    y: float
    angle: float
    mirrored: bool
    turned_over: bool
    matrix: tuple[Row3, Row3]


class ContourSide(Struct, frozen=True):
    """A contour that is cut, as the file reads.

    part: null for a cut that two parts share.  copy: null where the part lies in its own flat frame.
    contour: 0 the outer one.  purpose: what a hole is for, null for a cut that is no contour.
    circle: x, y and diameter of a round hole that is drilled or stitched through, exact where the file holds chords.
    area_mm2: what it encloses, null for what is not closed.
    box: x least, y least, x most, y most in the drawing.
    """

    part: str | None
    copy: int | None
    contour: int | None
    name: str
    layer: str
    purpose: Purpose | None
    circle: Row3 | None
    area_mm2: float | None
    length_mm: float
    box: tuple[float, float, float, float]


class MarkSide(Struct, frozen=True):
    """A mark as the file has it: its name, and what its layer means."""

    name: str
    layer: str


class NotchSide(Struct, frozen=True):
    """A notch: where it is on the edge, and the unit vector into the part.

    in_outline: whether its shape is part of the outline; else it is drawn beside it.  cut: or else only marked.
    """

    name: str
    kind: NotchKind
    at: Pair
    inward: Pair
    depth_mm: float
    width_mm: float
    in_outline: bool
    cut: bool


class DrillSide(Struct, frozen=True):
    """A round hole that the file says by a point: it is no contour there."""

    name: str
    purpose: Purpose
    at: Pair
    diameter_mm: float


class FeatureSide(Struct, frozen=True):
    """What a part was given and its drawing does not say: names in the order of the file, places in the flat frame.

    marks: strokes of texts among them, a grain line not.  texts: those that the drawing has as texts.
    boundary: x, y and bulge of each vertex of the outline before notches were cut into it; null: none were.
    """

    marks: tuple[MarkSide, ...]
    texts: tuple[str, ...]
    notches: tuple[NotchSide, ...]
    drills: tuple[DrillSide, ...]
    boundary: tuple[Row3, ...] | None


class BendSide(Struct, frozen=True, kw_only=True):
    """A bend line of a copy.

    order: from the first ruling of its part on.  v: its place on the surface.  ends: of the ruling, from c0 to c1.
    pieces: what of the ruling lies on the part, and is drawn.  radius_mm: inside, at both ends.
    allowance_mm: what the bend takes of the flat pattern at both ends, angle (radius + K thickness); nothing at a fold.
    pitch_mm: to the next line, across the rulings, at both ends.
    """

    part: str
    copy: int | None
    order: int
    name: str
    v: float
    face: int | None
    side: Side
    layer: Literal["BEND_UP", "BEND_DOWN"]
    angle_deg: float
    fold: bool
    radius_mm: tuple[float | None, float | None]
    k_factor: float | None
    allowance_mm: tuple[float | None, float | None]
    facet_error_mm: float
    pitch_mm: Pair | None
    ends: Ends
    pieces: tuple[Ends, ...]
    in_drawing: Ends
    pieces_in_drawing: tuple[Ends, ...]


class RollSide(Struct, frozen=True, kw_only=True):
    """A ruling of a part at which the roll is set; rulings lie at equal turning, and where it is sharpest.

    distance_mm: fed across the rulings up to there.  radius_mm: inside, at c0 and at c1.  cone_tilt_deg: of the roll.
    tool_radius_mm: to bend to, so that this radius is left; null where nothing is known of it.
    """

    part: str
    order: int
    v: float
    face: int | None
    side: Side
    distance_mm: float
    radius_mm: tuple[float | None, float | None]
    cone_tilt_deg: float | None
    tool_radius_mm: tuple[float | None, float | None] | None
    tool_radius_by: str | None
    note: str | None
    ends: Ends


class SideFile(Struct, frozen=True, kw_only=True):
    """The side file of one drawing.

    frame: of the drawing, that of a part or that of a sheet.
    bends, rolls: null where the parts come from drawings, which say nothing of it: their own jobs have it.
    rolls: null on a sheet too: parts are rolled once they are cut, by the side files of their own.
    features: of a part in its flat frame, null for all else.
    """

    schema: Literal["planish-cut/1"]
    version: str
    job: JobSide
    material: MaterialSide
    units: dict[str, str]
    frame: Literal["flat", "sheet"]
    files: tuple[FileSide, ...]
    layers: dict[str, LayerSide]
    sheets: tuple[SheetSide, ...]
    placements: tuple[PlacementSide, ...]
    contours: tuple[ContourSide, ...]
    bends: tuple[BendSide, ...] | None
    rolls: tuple[RollSide, ...] | None
    features: FeatureSide | None


UNITS = {"length": "mm", "area": "mm2", "angle": "deg"}
