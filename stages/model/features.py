"""What is cut into, drawn on and notched into a part besides its outline: the tables of a job file for them.

A place is `[u, v]` on a curved part, `[x, y]` on a plate, or `[x, y, z]` in space, whence it is pulled back onto the
surface as it is given; the same holds for the points of a curve.  u and v are pure numbers, whatever the units of the
job: u runs from 0 on c0 to 1 on c1, v from i to i + 1 on piece i.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Annotated, Literal

from msgspec import Meta, field

from stages.model.caps import MOST_FEATURES
from stages.model.curves import (
    CurveSpec,
    PlanePoint,
    Table,
    Trouble,
    coordinates,
    dimensions,
    is_flat,
    not_positive,
)
from stages.model.scalars import Angle, Length, Number

Name = Annotated[str, Meta(max_length=80)]


class CircleHole(Table, frozen=True, kw_only=True, tag_field="kind", tag="circle"):
    """A circle of the flat pattern about a place."""

    at: PlanePoint
    diameter: Length
    name: Name = ""

    def troubles(self) -> Iterator[Trouble]:
        """Yield a diameter that makes no circle."""
        yield from not_positive(self, "diameter")


class DrilledHole(Table, frozen=True, kw_only=True, tag_field="kind", tag="drill"):
    """What a cylinder along the normal at a place cuts out of the surface: round in space, not in the pattern."""

    at: PlanePoint
    diameter: Length
    name: Name = ""

    def troubles(self) -> Iterator[Trouble]:
        """Yield a diameter that makes no cylinder."""
        yield from not_positive(self, "diameter")


class CurveHole(Table, frozen=True, kw_only=True, tag_field="kind", tag="curve"):
    """A hole bounded by a closed curve; one in space is pulled back onto the surface point by point."""

    curve: CurveSpec
    name: Name = ""


HoleSpec = CircleHole | DrilledHole | CurveHole


class RulingMarks(Table, frozen=True, kw_only=True, tag_field="kind", tag="rulings"):
    """Lines to be etched: `count` rulings at equal turning of the normal, or one per `max_angle` of turning."""

    name: Name = "rulings"
    count: Annotated[int, Meta(ge=1, le=MOST_FEATURES)] | None = None
    max_angle: Angle | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield neither or both of count and max_angle."""
        if (self.count is None) == (self.max_angle is None):
            yield Trouble("count", "exactly one of count and max_angle", "say how many rulings are marked")
        if self.max_angle is not None and self.max_angle <= 0:
            yield Trouble("max_angle", f"{float(self.max_angle):g} deg", "must be above 0")


class PointMark(Table, frozen=True, kw_only=True, tag_field="kind", tag="point"):
    """A cross of two lines, `size` from tip to tip, along the ruling and across it; cut off where the part ends."""

    at: PlanePoint
    size: Length = field(default_factory=lambda: Length(4))
    name: Name = ""

    def troubles(self) -> Iterator[Trouble]:
        """Yield a size that makes no cross."""
        yield from not_positive(self, "size")


class CurveMark(Table, frozen=True, kw_only=True, tag_field="kind", tag="curve"):
    """A curve to be etched, open or closed; one in space is pulled back onto the surface point by point."""

    curve: CurveSpec
    name: Name = ""


class TextMark(Table, frozen=True, kw_only=True, tag_field="kind", tag="text"):
    """A text with its middle at a place; `angle` turns it counter-clockwise from the ruling (from x on a plate)."""

    at: PlanePoint
    text: Annotated[str, Meta(min_length=1, max_length=200)]
    height: Length
    angle: Angle = field(default_factory=Angle)
    name: Name = ""

    def troubles(self) -> Iterator[Trouble]:
        """Yield a height of nothing and letters that a drawing does not hold."""
        yield from not_positive(self, "height")
        if not (self.text.isascii() and self.text.isprintable()):
            yield Trouble("text", "letters that are not ASCII", "cutting software reads plain letters only")


MarkSpec = RulingMarks | PointMark | CurveMark | TextMark


NotchKind = Literal["v", "slit", "t", "castle", "u"]
OUTLINED: frozenset[NotchKind] = frozenset({"v", "castle", "u"})
"""Notches that enclose an area: they can be part of an outline."""


class NotchSpec(Table, frozen=True, kw_only=True):
    """A notch in an edge or seam, at a parameter (`at`), a length along it (`distance`), a share of it (`fraction`).

    kind: "v", "u" (a slot with a round end), "castle" (a square one): `width` wide and `depth` deep; "slit": a line
        `depth` into the part; "t": a slit with a bar of `width` across its end.
    cut: v, u and castle are cut into the outline unless this is false, slit and t only marked unless this is true.
    edge: c0 and c1 run with v, start and end (first and last ruling) with u; a plate has "outline", without at.
        A length along an edge counts on the given surface.
    seam: instead of an edge, that seam of the part; mate: the seam that it is sewn to has the notch as well.
    """

    edge: Literal["c0", "c1", "start", "end", "outline"] | None = None
    seam: str | None = None
    kind: NotchKind = "v"
    at: Number | None = None
    distance: Length | None = None
    fraction: Number | None = None
    width: Length = field(default_factory=lambda: Length(3))
    depth: Length = field(default_factory=lambda: Length(3))
    cut: bool | None = None
    mate: bool = True
    name: Name = ""

    @property
    def is_cut(self) -> bool:
        """Whether it is cut, or only marked."""
        return self.kind in OUTLINED if self.cut is None else self.cut

    def troubles(self) -> Iterator[Trouble]:
        """Yield a place that is missing, doubled or off the edge, and sizes that are no notch."""
        yield from not_positive(self, "width", "depth")
        if (self.edge is None) == (self.seam is None):
            yield Trouble("edge", "exactly one of edge and seam", "say what the notch is in")
        if self.seam is None and self.fraction is not None:
            yield Trouble("fraction", "of an edge that is not sewn", "give seam instead of edge, or at or distance")
        keys = ("at", "distance") if self.seam is None else ("distance", "fraction")
        if sum(getattr(self, key) is not None for key in keys) != 1:
            yield Trouble(keys[0], f"exactly one of {' and '.join(keys)}", "say where on the edge the notch is")
        if self.kind == "u" and self.depth < self.width / 2:
            yield Trouble("depth", f"{float(self.depth):g} mm", "a u is at least half as deep as it is wide")
        yield from self._place_troubles()

    def _place_troubles(self) -> Iterator[Trouble]:
        """Yield places off the edge."""
        if self.at is not None and self.edge in ("outline", None):
            yield Trouble("at", f"{self.edge or 'a seam'} has no parameter", "give distance, from its beginning")
        if self.distance is not None and self.distance < 0:
            yield Trouble("distance", f"{float(self.distance):g} mm", "may not be negative")
        if self.fraction is not None and not 0 <= self.fraction <= 1:
            yield Trouble("fraction", f"{float(self.fraction):g}", "from 0 to 1 of the length of the seam")
        most = 1 if self.edge in ("start", "end") else None
        if self.at is not None and (self.at < 0 or (most is not None and self.at > most)):
            yield Trouble("at", f"{float(self.at):g}", "u from 0 to 1" if most else "v from 0 on")


Feature = HoleSpec | MarkSpec | NotchSpec


def name_of(feature: Feature, number: int) -> str:
    """Return the name of a feature; without one of its own what it is and its number among its kind."""
    if isinstance(feature, CircleHole | DrilledHole | CurveHole):
        return feature.name or f"hole-{number}"
    return feature.name or (f"notch-{number}" if isinstance(feature, NotchSpec) else f"mark-{number}")


Ground = Literal["plate", "strip", "mesh", "face"]
"""What features are put on: a face of a CAD file may turn out to be a plate, a strip, or part of one."""


def feature_troubles(
    holes: Sequence[HoleSpec], marks: Sequence[MarkSpec], notches: Sequence[NotchSpec], *, on: Ground
) -> Iterator[Trouble]:
    """Yield what the features of a part break that only shows beside its kind of surface."""
    for key, features in (("hole", holes), ("mark", marks)):
        for i, feature in enumerate(features):
            for trouble in _troubles(feature, plate=on == "plate"):
                yield trouble._replace(key=f"{key}[{i}].{trouble.key}")
            if on == "mesh" and _in_plane(feature):
                place = "curve" if isinstance(feature, CurveHole | CurveMark) else "at"
                yield Trouble(f"{key}[{i}].{place}", "two numbers: a mesh has no u and v", "give points as [x, y, z]")
    for i, notch in enumerate(notches):
        if notch.edge is None:
            continue
        if (notch.edge == "outline") != (on != "strip") and on != "face":
            hint = "one of c0, c1, start, end" if on == "strip" else f"a {on} has outline only"
            yield Trouble(f"notch[{i}].edge", f'no edge "{notch.edge}" on this kind', hint)


def _in_plane(feature: HoleSpec | MarkSpec) -> bool:
    """Return whether a feature is given by two coordinates."""
    if isinstance(feature, RulingMarks):
        return False
    if isinstance(feature, CurveHole | CurveMark):
        return is_flat(feature.curve)
    return len(feature.at) == len("uv")


def _troubles(feature: HoleSpec | MarkSpec, *, plate: bool) -> Iterator[Trouble]:
    if isinstance(feature, RulingMarks):
        if plate:
            yield Trouble("kind", "a plate has no rulings", "mark points, curves or texts")
        return
    if isinstance(feature, CurveHole | CurveMark):
        if len(dimensions(feature.curve)) > 1:
            yield Trouble("curve", "points of two and of three coordinates", "the same for all points of a curve")
        if not plate and is_flat(feature.curve):
            yield from _with_unit("curve", feature.curve)
    elif not plate and len(feature.at) == len("uv"):
        yield from _with_unit("at", feature.at)
        if not any(x.plain is None for x in feature.at):
            yield from _off_surface(*(x.plain or Fraction(0) for x in feature.at))


def _with_unit(key: str, value: object) -> Iterator[Trouble]:
    if any(x.plain is None for x in coordinates(value)):
        yield Trouble(key, "u and v with a unit", "on a curved part [u, v] are pure numbers; [x, y, z] are lengths")


def _off_surface(u: Fraction, v: Fraction) -> Iterator[Trouble]:
    if not 0 <= u <= 1:
        yield Trouble("at[0]", f"u = {float(u):g}", "u runs from 0 on c0 to 1 on c1; lengths take [x, y, z]")
    if v < 0:
        yield Trouble("at[1]", f"v = {float(v):g}", "v runs from 0 on the first ruling, by 1 on each piece")
