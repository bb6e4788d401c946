"""A part as it is asked for: its surface by kind, quantity, holes, marks, notches.

One class per kind of surface; `SurfaceSpec` is their union, told apart by the key `kind`.  The names of the fields are
those of the job file.  The paper's patches are in `stages.model.quintics`.
"""

from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction
from typing import Annotated, Literal, get_args

from msgspec import Meta, field
from msgspec.structs import replace

from stages.model.caps import MOST_ANGLES, MOST_COPIES, MOST_FEATURES, MOST_PIECES
from stages.model.curves import CurveSpec, Table, Trouble, absurd_lengths, plane_curves
from stages.model.developables import BezierPair, Slope, Tangent
from stages.model.ducts import Elbow, Saddle, Tee, Transition, blank_count, set_troubles
from stages.model.envelopes import Ribbon, Strap
from stages.model.face import Face
from stages.model.faces import FaceFile
from stages.model.features import Ground, HoleSpec, MarkSpec, NotchSpec, feature_troubles
from stages.model.forming import BendSpec
from stages.model.meshes import MeshFile
from stages.model.quintics import QuinticCone, QuinticCylinder, QuinticPlanar, QuinticRuled, bad_fraction
from stages.model.quinticstrip import QuinticStrip
from stages.model.rails import Rails
from stages.model.scalars import Angle, Direction, Length, Number, Point, is_zero
from stages.model.sewing import EDGES, Edge, SeamSpec, StitchSpec, blank_troubles, seam_troubles, seams_on
from stages.model.sheet import Quality


class Ruled(Table, frozen=True, kw_only=True, tag_field="kind", tag="ruled"):
    """Straight rulings between two curves, equal parameter to equal parameter."""

    c0: CurveSpec
    c1: CurveSpec

    def troubles(self) -> Iterator[Trouble]:
        """Yield curves that are not in space, and one curve given twice."""
        yield from plane_curves(self, "c0", "c1")
        if self.c0 == self.c1:
            yield Trouble("c1", "the same curve as c0", "the two curves must differ")


class Flat(Table, frozen=True, kw_only=True, tag_field="kind", tag="flat"):
    """A plate: a closed planar outline, and holes."""

    outline: CurveSpec
    holes: Annotated[tuple[CurveSpec, ...], Meta(max_length=MOST_FEATURES)] = ()


class Plane(Table, frozen=True, kw_only=True):
    """A plane by a point and a normal."""

    point: Point
    normal: Direction

    def troubles(self) -> Iterator[Trouble]:
        """Yield a normal of length 0."""
        if is_zero(self.normal):
            yield Trouble("normal", "the vector has length 0", "give the direction across the plane")

    def height_of(self, point: Sequence[Fraction] | None) -> Fraction | None:
        """Return how far a point lies along the normal, in its lengths, exactly; None for no point."""
        if point is None:
            return None
        return sum((Fraction(n * (x - p)) for n, x, p in zip(self.normal, point, self.point, strict=True)), Fraction(0))

    def is_same(self, other: "Plane") -> bool:
        """Return whether another plane is the same one, exactly."""
        (a, b, c), (x, y, z) = self.normal, other.normal
        return self.height_of(other.point) == 0 and (b * z, c * x, a * y) == (c * y, a * z, b * x)


class Cone(Table, frozen=True, kw_only=True, tag_field="kind", tag="cone"):
    """A cone over any directrix, or a right frustum (axis z, radius0 at z = 0, seam at +x).

    start_plane, end_plane: the rulings begin or end on a plane instead, within or beyond those ends.
    """

    apex: Point | None = None
    directrix: CurveSpec | None = None
    fraction: tuple[Number, Number] = field(default_factory=lambda: (Number(0), Number(1)))
    radius0: Length | None = None
    radius1: Length | None = None
    height: Length | None = None
    sweep: Angle = field(default_factory=lambda: Angle(360))
    start_plane: Plane | None = None
    end_plane: Plane | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a mixture of the two ways to describe a cone, and values that make none."""
        general = [key for key in ("apex", "directrix") if getattr(self, key) is not None]
        frustum = [key for key in ("radius0", "radius1", "height") if getattr(self, key) is not None]
        if general and frustum:
            yield Trouble(frustum[0], f"beside {general[0]}", "either apex and directrix, or radius0, radius1, height")
        elif len(general) == 1 or not (general or frustum):
            yield Trouble("", "apex and directrix go together", "or give radius0, radius1 and height")
        elif frustum and len(frustum) < len(("radius0", "radius1", "height")):
            yield Trouble("", f"only {' and '.join(frustum)}", "a frustum takes radius0, radius1 and height")
        yield from bad_fraction(self.fraction)
        if self.directrix is not None:
            yield from plane_curves(self, "directrix")
        if len(frustum) == len(("radius0", "radius1", "height")):
            yield from self._frustum_troubles()
        yield from self._plane_troubles()

    def _plane_troubles(self) -> Iterator[Trouble]:
        for i, (key, plane) in enumerate((("start_plane", self.start_plane), ("end_plane", self.end_plane))):
            if plane is None or is_zero(plane.normal):
                continue
            if self.fraction[i] != i:
                yield Trouble(f"fraction[{i}]", f"beside {key}", "the rulings end on one of them: leave the other out")
            if plane.height_of(self._apex()) == 0:
                hint = "move it, or leave it out: uncut rulings run to the apex"
                yield Trouble(f"{key}.point", "the plane passes through the apex", hint)
            if self.radius0 is not None and self.radius0 == self.radius1 and plane.normal[2] == 0:
                yield Trouble(f"{key}.normal", "the plane is parallel to the axis", "the rulings never meet it")
        if self.start_plane and self.end_plane and self.start_plane.is_same(self.end_plane):
            yield Trouble("end_plane", "the same plane as start_plane", "the surface would have no area")

    def _apex(self) -> Sequence[Fraction] | None:
        """Return the apex, exactly; that of a frustum by its radii, None for equal ones."""
        if self.radius0 is None or self.radius1 is None or self.height is None:
            return self.apex
        if self.radius0 == self.radius1:
            return None
        return Fraction(0), Fraction(0), Fraction(self.radius0 * self.height / (self.radius0 - self.radius1))

    def _frustum_troubles(self) -> Iterator[Trouble]:
        radii = (self.radius0 or 0, self.radius1 or 0)
        for key, value in zip(("radius0", "radius1"), radii, strict=True):
            if value < 0:
                yield Trouble(key, f"{float(value):g} mm", "a radius may not be negative")
        if radii == (0, 0):
            yield Trouble("radius1", "both radii are 0", "one of them must be above 0")
        if self.height == 0 and radii[0] == radii[1]:
            yield Trouble("height", "0 mm between equal radii", "the surface would have no area")
        if (self.height or 0) < 0:
            yield Trouble("height", f"{float(self.height or 0):g} mm", "the height may not be negative")
        if not 0 < self.sweep <= Angle(360):
            yield Trouble("sweep", f"{float(self.sweep):g} deg", "above 0 and at most 360 deg")


class Cylinder(Table, frozen=True, kw_only=True, tag_field="kind", tag="cylinder"):
    """Parallel rulings over any directrix, cut by length, by planes, or by a pipe that crosses at `length`."""

    directrix: CurveSpec
    direction: Direction
    length: Length | None = None
    start_plane: Plane | None = None
    end_plane: Plane | None = None
    saddle: Saddle | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield a direction of length 0 and an end that is missing, doubled or at no distance."""
        yield from plane_curves(self, "directrix")
        if self.saddle is not None and not {"circle", "arc", "ellipse"} & {*self.directrix.sorts()}:
            yield Trouble("saddle", "on a directrix that has no centre", "give a circle, an arc or an ellipse")
        if self.saddle is not None and self.end_plane is not None:
            yield Trouble("saddle", "beside end_plane", "the rulings end on one of them")
        if is_zero(self.direction):
            yield Trouble("direction", "the vector has length 0", "give the direction of the rulings")
        if (self.length is None) == (self.end_plane is None):
            yield Trouble("length", "exactly one of length and end_plane", "say where the rulings end")
        if self.length is not None and self.length <= 0:
            yield Trouble("length", f"{float(self.length):g} mm", "must be above 0")
        for key in ("start_plane", "end_plane"):
            plane = getattr(self, key)
            if plane is not None and sum(a * b for a, b in zip(plane.normal, self.direction, strict=True)) == 0:
                yield Trouble(f"{key}.normal", "the plane is parallel to the direction", "the rulings never meet it")


PieceSpec = (
    QuinticRuled | QuinticPlanar | QuinticCylinder | QuinticCone | QuinticStrip | Ruled | Cone | Cylinder
    | BezierPair | Tangent | Slope | Strap | Ribbon | Rails | Transition
)  # fmt: skip
"""The kinds that make one ruled surface of one blank: those that may be pieces of a strip."""


class Strip(Table, frozen=True, kw_only=True, tag_field="kind", tag="strip"):
    """Surfaces of other kinds joined along their end rulings; each is turned such that it joins the one before."""

    pieces: Annotated[tuple[PieceSpec, ...], Meta(min_length=1, max_length=MOST_PIECES)]


SurfaceSpec = PieceSpec | Strip | Flat | Elbow | Tee | FaceFile | MeshFile
KINDS: tuple[type[Table], ...] = get_args(SurfaceSpec)


WIDEST_BAND = 90
"""Degrees either way: everything.  A direction of stretch goes across the grain by as much."""


class PartSpec(Table, frozen=True, kw_only=True):
    """One part: its surface and how often it is needed.

    face: which face of the sheet the surface describes: the middle one, that on the concave side (inner) or on the
        convex side (outer), or that on the side of p x c0' (plus) or away from it (minus).
    bend: bend lines for a part that is bent in steps.
    rotations: angles it may be turned by in the nest, or "free"; absent: what the nest allows.
    grain: direction in the flat frame, degrees, that goes along the grain of the stock, either way; stretch_axis:
        direction that goes across it; grain_band: how far it may stray from there.
    quality: the least quality of a zone of the stock that it accepts, higher is better; "best": it lies outside all
        zones; "any": it may lie in all.
    pair: every second copy is the mirror image.
    seam, stitch: where it is sewn, with allowances outside the pattern, and the holes for the thread.
    cut: "auto" divides a part whose flat pattern overlaps itself along as few rulings as possible.
    """

    name: Annotated[str, Meta(min_length=1, max_length=80)]
    surface: SurfaceSpec
    quantity: Annotated[int, Meta(ge=1, le=MOST_COPIES)] = 1
    face: Face = "middle"
    rotations: Literal["free"] | Annotated[tuple[Angle, ...], Meta(max_length=MOST_ANGLES)] | None = None
    grain: Angle | None = None
    grain_band: Angle = field(default_factory=Angle)
    stretch_axis: Angle | None = None
    quality: Quality = "best"
    pair: bool = False
    cut: Literal["none", "auto"] = "none"
    hole: Annotated[tuple[HoleSpec, ...], Meta(max_length=MOST_FEATURES)] = ()
    mark: Annotated[tuple[MarkSpec, ...], Meta(max_length=MOST_FEATURES)] = ()
    notch: Annotated[tuple[NotchSpec, ...], Meta(max_length=MOST_FEATURES)] = ()
    bend: Annotated[tuple[BendSpec, ...], Meta(max_length=MOST_FEATURES)] = ()
    seam: Annotated[tuple[SeamSpec, ...], Meta(max_length=MOST_FEATURES)] = ()
    stitch: Annotated[tuple[StitchSpec, ...], Meta(max_length=MOST_FEATURES)] = ()

    def troubles(self) -> Iterator[Trouble]:
        """Yield what holes, marks and notches break on this kind of surface."""
        yield from absurd_lengths(self.surface)
        yield from feature_troubles(self.hole, self.mark, self.notch, on=GROUNDS.get(type(self.surface), "strip"))
        yield from seam_troubles(self.seam, self.stitch, self.notch, sides=_sides(self.surface))
        yield from self._laying_troubles()
        if self.cut == "auto" and isinstance(self.surface, Flat):
            yield Trouble("cut", "a plate has no rulings to be divided along", 'leave it out, or write "none"')
        if self.bend and isinstance(self.surface, Flat):
            yield Trouble("bend", "a plate does not bend", "leave it out")
        if self.cut == "auto" and isinstance(self.surface, MeshFile):
            yield Trouble("cut", "a mesh is cut along its seam", 'leave it out, or write "none"')
        if len(self.bend) > 1:
            yield Trouble("bend[1]", "a second set of bend lines", "a part is bent in one way: leave one of them out")
        if self.seam and self.cut == "auto":
            hint = "leave it out, and sew it from parts that lie flat in one piece"
            yield Trouble("cut", "a part with seams is not divided: which blank has how much of one is not said", hint)
        edged = any(notch.edge is not None for notch in self.notch)
        given = [key for key, there in (("hole", self.hole), ("mark", self.mark), ("notch", edged)) if there]
        yield from set_troubles(self.surface, given, matched=bool(self.stitch or self.notch))
        yield from blank_troubles(self.name, blank_count(self.surface), self.seam)

    def _laying_troubles(self) -> Iterator[Trouble]:
        """Yield what is wrong with the way it is to lie on the stock."""
        if self.grain is not None and self.stretch_axis is not None:
            yield Trouble("stretch_axis", "beside grain", "one direction is enough: the other one is across it")
        if not 0 <= self.grain_band <= WIDEST_BAND:
            yield Trouble("grain_band", f"{float(self.grain_band):g} deg", "from 0 to 90 deg, either way")
        if self.grain_band > 0 and self.axis_deg is None:
            yield Trouble("grain_band", "without a direction", "give grain or stretch_axis")
        if self.pair and self.quantity == 1:
            yield Trouble("pair", "a pair of one copy", "give the quantity of both together")

    @property
    def axis_deg(self) -> float | None:
        """The direction in the flat frame that goes along the grain, degrees; None: any."""
        if self.stretch_axis is not None:
            return float(self.stretch_axis) + WIDEST_BAND
        return None if self.grain is None else float(self.grain)

    @property
    def has_features(self) -> bool:
        """Whether anything is cut into it, drawn on it or sewn to it."""
        return bool(self.hole or self.mark or self.notch or self.seam)

    def blank(self, number: int, edges: Collection[str] = EDGES) -> "PartSpec":
        """Return the specification of one piece of the part, `<part>.<n>`: its seams are those on these edges."""
        name = f"{self.name}.{number}"
        seams = seams_on(self.seam, number, edges, (self.name, name))
        sewn = {seam.called for seam in seams}
        rows = tuple(row for row in self.stitch if row.seam in sewn)
        notches = tuple(notch for notch in self.notch if notch.seam is None or notch.seam in sewn)
        return replace(self, name=name, cut="none", seam=seams, stitch=rows, notch=notches)


def _sides(surface: SurfaceSpec) -> tuple[Edge, ...]:
    """Return the edges that a part may have; a face may be a strip with four, or trimmed."""
    match surface:
        case FaceFile() | Tee(hole=True):
            return EDGES
        case Flat() | MeshFile():
            return ("outline",)
    return ("c0", "c1", "start", "end")


GROUNDS: dict[type[Table], Ground] = {Flat: "plate", MeshFile: "mesh", FaceFile: "face"}
"""What the features of a part are put on, where that is no strip."""
