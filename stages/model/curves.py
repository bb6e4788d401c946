"""Curves as a job file describes them: one key of a table names the sort, its value the data.

Circles and arcs start along the x axis of DXF's arbitrary-axis rule and run counter-clockwise about `normal`; an
ellipse starts at center + major, towards minor.  Values are exact (see `stages.model.scalars`); what they look like as
functions is decided in `stages.construct.curves`.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, NamedTuple

from msgspec import Meta, Struct, field
from msgspec.structs import replace

from stages.model.caps import LARGEST_MM, MOST_PIECES, MOST_POINTS
from stages.model.scalars import FULL_TURN, Angle, Coordinate, Direction, Length, Number, coordinate, is_zero

PlanePoint = Annotated[tuple[Coordinate, ...], Meta(min_length=2, max_length=3)]
"""Two or three coordinates; two only on flat parts and stock, and as u and v of a place on a surface."""


class Trouble(NamedTuple):
    """A rule that the values of a table break: which key, what is wrong, what would be right."""

    key: str
    message: str
    hint: str


class Table(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of the job file."""

    def troubles(self) -> Iterator[Trouble]:
        """Yield the rules that the values break, beyond types and ranges of single values."""
        yield from ()


def not_positive(table: Table, *keys: str) -> Iterator[Trouble]:
    """Yield the values that are given and not above 0."""
    for key in keys:
        value = getattr(table, key)
        if value is not None and value <= 0:
            yield Trouble(key, f"{float(value):g}", "must be above 0")


def negatives(table: Table, *keys: str) -> Iterator[Trouble]:
    """Yield the values that are given and below 0."""
    for key in keys:
        value = getattr(table, key)
        if value is not None and value < 0:
            yield Trouble(key, f"{float(value):g}", "may not be negative")


class BSplineSpec(Table, frozen=True, kw_only=True):
    """A B-spline: knots in full (count = points + degree + 1), weights for a rational one."""

    degree: Annotated[int, Meta(ge=1, le=15)]
    knots: Annotated[tuple[Number, ...], Meta(max_length=2 * MOST_POINTS)]
    points: Annotated[tuple[PlanePoint, ...], Meta(min_length=2, max_length=MOST_POINTS)]
    weights: Annotated[tuple[Number, ...], Meta(max_length=MOST_POINTS)] | None = None

    def troubles(self) -> Iterator[Trouble]:
        """Yield what is wrong with counts, order of knots and weights."""
        wanted = len(self.points) + self.degree + 1
        if len(self.points) <= self.degree:
            yield Trouble("points", f"{len(self.points)} points for degree {self.degree}", "give more than the degree")
        elif len(self.knots) != wanted:
            yield Trouble("knots", f"{len(self.knots)} knots", f"points + degree + 1 = {wanted} are needed")
        elif any(a > b for a, b in zip(self.knots, self.knots[1:], strict=False)):
            yield Trouble("knots", "knots decrease", "give them in rising order")
        elif self.knots[self.degree] == self.knots[-self.degree - 1]:
            yield Trouble("knots", "the knots span no interval", "first and last inner knot must differ")
        elif any(a == b for a, b in zip(self.knots[1:-1], self.knots[self.degree + 1 : -1], strict=False)):
            yield Trouble("knots", "an inner knot is repeated more than degree times", "the curve would fall apart")
        if self.weights is not None and len(self.weights) != len(self.points):
            yield Trouble("weights", f"{len(self.weights)} weights", f"one per point: {len(self.points)}")
        if self.weights is not None and any(weight <= 0 for weight in self.weights):
            yield Trouble("weights", "a weight is not positive", "all weights must be above 0")


class CircleSpec(Table, frozen=True, kw_only=True):
    """A full circle."""

    center: PlanePoint
    radius: Coordinate
    normal: Direction = field(default_factory=lambda: (Number(0), Number(0), Number(1)))

    def troubles(self) -> Iterator[Trouble]:
        """Yield a radius or normal that makes no circle."""
        if self.radius <= 0:
            yield Trouble("radius", f"{float(self.radius):g} mm", "a radius must be above 0")
        if is_zero(self.normal):
            yield Trouble("normal", "the vector has length 0", "give the direction of the axis")


class ArcSpec(CircleSpec, frozen=True, kw_only=True):
    """A circular arc from `start` to `end`, degrees; `end` below `start` runs clockwise."""

    start: Angle
    end: Angle

    def troubles(self) -> Iterator[Trouble]:
        """Yield what makes no arc."""
        yield from CircleSpec.troubles(self)
        if self.start == self.end:
            yield Trouble("end", "the arc has no sweep", "start and end must differ; a full turn is a circle")
        if abs(self.end - self.start) > FULL_TURN:
            yield Trouble("end", f"a sweep of {float(self.end - self.start):g} deg", "at most 360 deg")


class EllipseSpec(Table, frozen=True, kw_only=True):
    """A full ellipse by its two semi-axes as vectors."""

    center: PlanePoint
    major: PlanePoint
    minor: PlanePoint

    def troubles(self) -> Iterator[Trouble]:
        """Yield semi-axes of length 0."""
        for key in ("major", "minor"):
            if is_zero(getattr(self, key)):
                yield Trouble(key, "the semi-axis has length 0", "give a vector from the centre")


class HelixSpec(Table, frozen=True, kw_only=True):
    """A helix about z from (radius, 0, 0), rising `pitch` per turn."""

    radius: Length
    pitch: Length
    turns: Number

    def troubles(self) -> Iterator[Trouble]:
        """Yield a radius or a number of turns that makes no helix."""
        if self.radius <= 0:
            yield Trouble("radius", f"{float(self.radius):g} mm", "a radius must be above 0")
        if self.turns <= 0:
            yield Trouble("turns", f"{float(self.turns):g}", "the number of turns must be above 0")
        if self.turns > MOST_TURNS:
            yield Trouble("turns", f"{float(self.turns):g}", f"at most {MOST_TURNS} turns")


MOST_TURNS = 30
"""A blank of one turn lies on itself in the flat, as a rule; how far is counted in a second for thirty, and in the cube
of that for more."""


class CurveSpec(Table, frozen=True, kw_only=True, omit_defaults=True):
    """A curve: exactly one of its keys (`layer` goes with `file`).

    points: interpolated by a cubic spline, chord-length parameter, not-a-knot; last = first: periodic.
    polyline: straight segments, each an equal share of the parameter.
    chain: curves that join end to end.
    """

    bezier: Annotated[tuple[PlanePoint, ...], Meta(min_length=2, max_length=16)] | None = None
    bspline: BSplineSpec | None = None
    points: Annotated[tuple[PlanePoint, ...], Meta(min_length=3, max_length=MOST_POINTS)] | None = None
    polyline: Annotated[tuple[PlanePoint, ...], Meta(min_length=2, max_length=MOST_POINTS)] | None = None
    line: tuple[PlanePoint, PlanePoint] | None = None
    arc: ArcSpec | None = None
    circle: CircleSpec | None = None
    ellipse: EllipseSpec | None = None
    helix: HelixSpec | None = None
    chain: "Annotated[tuple[CurveSpec, ...], Meta(min_length=1, max_length=MOST_PIECES)] | None" = None
    file: Annotated[str, Meta(max_length=500)] | None = None
    layer: Annotated[str, Meta(max_length=255)] | None = None

    def sorts(self) -> list[str]:
        """Return the keys that are given, `layer` apart."""
        return [key for key in CURVE_KEYS if getattr(self, key) is not None]

    def troubles(self) -> Iterator[Trouble]:
        """Yield a missing or doubled key and points that coincide."""
        given = self.sorts()
        if len(given) != 1:
            found = " and ".join(given) or "none"
            yield Trouble("", f"a curve has exactly one sort, here {found}", "one of " + ", ".join(CURVE_KEYS))
        if self.layer is not None and self.file is None:
            yield Trouble("layer", "a layer without a file", 'give file = "....dxf" too')
        for key in ("points", "polyline", "line"):
            points = getattr(self, key) or ()
            for i, (a, b) in enumerate(pairwise(points)):
                if a == b:
                    yield Trouble(f"{key}[{i + 1}]", "the point repeats the one before", "leave one of them out")
        if self.bezier is not None and len(set(self.bezier)) == 1:
            yield Trouble("bezier", "all control points coincide", "give at least two different points")


CURVE_KEYS = ("bezier", "bspline", "points", "polyline", "line", "arc", "circle", "ellipse", "helix", "chain", "file")


def is_whole(curve: CurveSpec) -> bool:
    """Return whether there is a curve: one of one sort, and no reference to a file that was not read."""
    return len(curve.sorts()) == 1 and curve.file is None and all(is_whole(part) for part in curve.chain or ())


def is_flat(curve: CurveSpec) -> bool:
    """Return whether some point or semi-axis of the curve is given by two coordinates only."""
    return len("xy") in dimensions(curve)


def plane_curves(spec: Table, *keys: str) -> Iterator[Trouble]:
    """Yield the curves with points of two coordinates."""
    for key in keys:
        if is_flat(getattr(spec, key)):
            yield Trouble(key, "a point with two coordinates", "give x, y and z; two are enough on flat parts only")


def dimensions(curve: CurveSpec) -> set[int]:
    """Return by how many coordinates points and semi-axes are given: 2, 3, or both where they are mixed."""
    plain = [*(curve.bezier or ()), *(curve.points or ()), *(curve.polyline or ()), *(curve.line or ())]
    if curve.bspline is not None:
        plain += curve.bspline.points
    plain += [spec.center for spec in (curve.arc, curve.circle) if spec is not None]
    if curve.ellipse is not None:
        plain += [curve.ellipse.center, curve.ellipse.major, curve.ellipse.minor]
    helix = {len("xyz")} if curve.helix is not None else set()
    return {len(point) for point in plain} | helix | {n for part in curve.chain or () for n in dimensions(part)}


def coordinates(value: object) -> Iterator[Coordinate]:
    """Yield all coordinates in a curve, or in a part of its data."""
    yield from (length for length in lengths(value) if isinstance(length, Coordinate))


def lengths(value: object) -> Iterator[Length]:
    """Yield all lengths in a table, or in a part of its data, coordinates among them."""
    if isinstance(value, Length):
        yield value
    elif isinstance(value, tuple):
        yield from (inner for item in value for inner in lengths(item))
    elif isinstance(value, Struct):
        yield from (inner for key in value.__struct_fields__ for inner in lengths(getattr(value, key)))


def absurd_lengths(surface: Table) -> Iterator[Trouble]:
    """Yield the keys of a surface with a length or a coordinate beyond a kilometre."""
    for key, name in zip(surface.__struct_fields__, surface.__struct_encode_fields__, strict=True):
        largest = max((abs(length) for length in lengths(getattr(surface, key))), default=0)
        if largest > LARGEST_MM:
            message = f"{float(largest):.6g} mm: nothing that is cut is larger than a kilometre"
            yield Trouble(f"surface.{name}", message, "check the units; shift coordinates that are far from 0")


def in_numbers(curve: CurveSpec) -> CurveSpec:
    """Return the curve with its coordinates as the pure numbers that were typed: a curve of u and v."""
    made = _in_numbers(curve)
    if not isinstance(made, CurveSpec):
        raise ValueError("a curve became something else")
    return made


def _in_numbers(value: object) -> object:
    if isinstance(value, Coordinate):
        if value.plain is None:
            raise ValueError("a coordinate with a unit passed the checks of the job file")
        return coordinate(value.plain, value.plain)
    if isinstance(value, tuple):
        return tuple(_in_numbers(item) for item in value)
    if isinstance(value, Struct):
        return replace(value, **{key: _in_numbers(getattr(value, key)) for key in value.__struct_fields__})
    return value
