"""Entities of a DXF drawing -> curves of the job file's sorts, and pieces that meet -> one curve.

LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE and POLYLINE (2D and 3D) are read without approximation; an arc of an
ellipse becomes a rational spline.  Anything else on the layer is refused rather than left out.  Ends that are nearer
than `GAP_MM` are one point; where more than two meet, the way on is not defined, and that is refused too.  A chain runs
as its first entity in the file does.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise, product
from math import dist, isclose, tau

from ezdxf.entities.arc import Arc
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfentity import DXFEntity
from ezdxf.entities.ellipse import Ellipse
from ezdxf.entities.line import Line
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from ezdxf.entities.spline import Spline
from ezdxf.math import BSpline, Vec3

from pipeline.units import UnreadableError, coordinate_of, quantity
from stages.model.curves import ArcSpec, BSplineSpec, CircleSpec, CurveSpec, EllipseSpec
from stages.model.scalars import Angle, Coordinate, Direction, Number

XYZ = tuple[float, float, float]

GAP_MM = 0.01
"""Ends nearer than this are one point, whatever `tolerance.join` says: drawings made in CAD meet far better, traced
ones far worse, and an outline put together over a wider gap would be refused once it is laid flat, as its edges must
meet within a share of `tolerance.chord`.  Where the ends of a drawing are further apart, how far is said instead."""
READ = "LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE and POLYLINE are read"
FULL_TURN = 360.0


@dataclass(frozen=True, slots=True)
class Piece:
    """Curves end to end; both ends in mm."""

    links: tuple[CurveSpec, ...]
    start: XYZ
    end: XYZ
    closed: bool = False

    def spec(self) -> CurveSpec:
        """Return the piece as one curve."""
        return self.links[0] if len(self.links) == 1 else CurveSpec(chain=self.links)

    def backwards(self) -> "Piece":
        """Return the piece run the other way."""
        return Piece(tuple(backwards(link) for link in self.links[::-1]), self.end, self.start, self.closed)


def backwards(spec: CurveSpec) -> CurveSpec:
    """Return an open curve run the other way."""
    if spec.line is not None:
        return CurveSpec(line=(spec.line[1], spec.line[0]))
    if spec.polyline is not None:
        return CurveSpec(polyline=spec.polyline[::-1])
    if spec.arc is not None:
        arc = spec.arc
        return CurveSpec(
            arc=ArcSpec(center=arc.center, radius=arc.radius, normal=arc.normal, start=arc.end, end=arc.start)
        )
    if spec.bspline is None:
        raise ValueError("only lines, polylines, arcs and splines are chained")
    old = spec.bspline
    knots = tuple(Number(old.knots[0] + old.knots[-1] - knot) for knot in old.knots[::-1])
    weights = None if old.weights is None else old.weights[::-1]
    return CurveSpec(bspline=BSplineSpec(degree=old.degree, knots=knots, points=old.points[::-1], weights=weights))


def pieces(entity: DXFEntity, unit: str) -> Iterator[Piece]:
    """Yield the curves of an entity; `UnreadableError` for one that is no curve."""
    if isinstance(entity, Line):
        yield from _polyline([entity.dxf.start, entity.dxf.end], unit, entity)
    elif isinstance(entity, Arc):
        yield _arc(entity, unit)
    elif isinstance(entity, Circle):
        yield _circle(entity, unit)
    elif isinstance(entity, Ellipse):
        yield _ellipse(entity, unit)
    elif isinstance(entity, Spline):
        yield _spline(entity.construction_tool(), unit, entity)
    elif isinstance(entity, LWPolyline | Polyline):
        yield from _any_polyline(entity, unit)
    else:
        raise UnreadableError(f"{_called(entity)} is no curve", f"{READ}; move or explode it")


def _called(entity: DXFEntity) -> str:
    return f"{entity.dxftype()} #{entity.dxf.handle} on the layer {entity.dxf.layer}"


def _length(value: float, unit: str) -> Coordinate:
    return coordinate_of(float(value), unit)


def _point(point: Vec3, unit: str) -> tuple[Coordinate, Coordinate, Coordinate]:
    return _length(point.x, unit), _length(point.y, unit), _length(point.z, unit)


def _direction(vector: Vec3) -> Direction:
    return quantity(Number, vector.x), quantity(Number, vector.y), quantity(Number, vector.z)


def _mm(point: Vec3, unit: str) -> XYZ:
    x, y, z = _point(point, unit)
    return float(x), float(y), float(z)


def _polyline(points: Sequence[Vec3], unit: str, entity: DXFEntity) -> Iterator[Piece]:
    """Yield straight segments; a vertex that repeats the one before says nothing and is left out."""
    kept = [points[0], *(b for a, b in pairwise(points) if not a.isclose(b, rel_tol=0.0, abs_tol=0.0))]
    if len(kept) < len("ab"):
        raise UnreadableError(f"{_called(entity)} has no length", "remove it from the drawing")
    exact = [_point(point, unit) for point in kept]
    spec = CurveSpec(line=(exact[0], exact[1])) if len(exact) == len("ab") else CurveSpec(polyline=tuple(exact))
    yield Piece((spec,), _mm(kept[0], unit), _mm(kept[-1], unit), exact[0] == exact[-1])


def _any_polyline(entity: LWPolyline | Polyline, unit: str) -> Iterator[Piece]:
    """Yield a polyline as straight segments, or as the lines and arcs that its bulges make."""
    if isinstance(entity, Polyline) and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
        raise UnreadableError(f"{_called(entity)} is a mesh", READ)
    if isinstance(entity, Polyline) and entity.dxf.flags & SMOOTHED:
        raise UnreadableError(f"{_called(entity)} is a smoothed polyline", "explode it, or draw a SPLINE")
    if entity.has_arc:
        parts = [piece for part in entity.virtual_entities() if not _empty(part) for piece in pieces(part, unit)]
        if not parts:
            raise UnreadableError(f"{_called(entity)} has no length", "remove it from the drawing")
        yield _in_order(parts)
        return
    points = _corners(entity)
    yield from _polyline([*points, points[0]] if entity.is_closed else points, unit, entity)


SMOOTHED = 2 | 4
"""Flags of a POLYLINE whose vertices were added by a smoothing of the CAD program."""


def _corners(entity: LWPolyline | Polyline) -> list[Vec3]:
    if isinstance(entity, LWPolyline):
        return list(entity.vertices_in_wcs())
    return list(entity.points()) if entity.is_3d_polyline else list(entity.points_in_wcs())


def _empty(entity: DXFEntity) -> bool:
    return isinstance(entity, Line) and bool(entity.dxf.start == entity.dxf.end)


def _in_order(parts: Sequence[Piece]) -> Piece:
    """Return one piece of the parts of a polyline, each turned so that it begins where the one before ends."""
    first = parts[0]
    if len(parts) > 1:
        second = (parts[1].start, parts[1].end)
        if min(dist(first.start, end) for end in second) < min(dist(first.end, end) for end in second):
            first = first.backwards()
    joined = first
    for part in parts[1:]:
        turned = part if dist(joined.end, part.start) <= dist(joined.end, part.end) else part.backwards()
        joined = Piece((*joined.links, *turned.links), joined.start, turned.end)
    return replace(joined, closed=dist(joined.start, joined.end) <= GAP_MM)


def _arc(entity: Arc, unit: str) -> Piece:
    start, normal = entity.dxf.start_angle, entity.dxf.extrusion
    sweep = (entity.dxf.end_angle - start) % FULL_TURN or FULL_TURN
    spec = ArcSpec(
        center=_point(entity.ocs().to_wcs(entity.dxf.center), unit),
        radius=_radius(entity, unit),
        normal=_direction(normal),
        start=quantity(Angle, start),
        end=quantity(Angle, start + sweep),
    )
    ends = [_mm(point, unit) for point in (entity.start_point, entity.end_point)]
    return Piece((CurveSpec(arc=spec),), ends[0], ends[1], sweep == FULL_TURN)


def _circle(entity: Circle, unit: str) -> Piece:
    centre = entity.ocs().to_wcs(entity.dxf.center)
    spec = CircleSpec(
        center=_point(centre, unit), radius=_radius(entity, unit), normal=_direction(entity.dxf.extrusion)
    )
    return Piece((CurveSpec(circle=spec),), _mm(centre, unit), _mm(centre, unit), closed=True)


def _radius(entity: Circle, unit: str) -> Coordinate:
    radius = _length(entity.dxf.radius, unit)
    if radius <= 0:
        raise UnreadableError(f"{_called(entity)} has the radius {float(radius):g}", "a radius must be above 0")
    return radius


def _ellipse(entity: Ellipse, unit: str) -> Piece:
    """Return a full ellipse as such, a part of one as a rational spline."""
    sweep = (entity.dxf.end_param - entity.dxf.start_param) % tau
    if not (isclose(sweep, 0.0, abs_tol=FULL_ELLIPSE) or isclose(sweep, tau, abs_tol=FULL_ELLIPSE)):
        return _spline(BSpline.from_ellipse(entity.construction_tool()), unit, entity)
    centre = _point(entity.dxf.center, unit)
    spec = EllipseSpec(center=centre, major=_point(entity.dxf.major_axis, unit), minor=_point(entity.minor_axis, unit))
    at = _mm(entity.dxf.center, unit)
    return Piece((CurveSpec(ellipse=spec),), at, at, closed=True)


FULL_ELLIPSE = 1e-6
"""rad; drawings write a full turn with six decimals or more, 6.283185 is 3e-7 short; nobody leaves so small a gap."""


def _spline(curve: BSpline, unit: str, entity: DXFEntity) -> Piece:
    knots, weights = list(curve.knots()), list(curve.weights())
    spec = BSplineSpec(
        degree=curve.degree,
        knots=tuple(quantity(Number, float(knot)) for knot in knots),
        points=tuple(_point(point, unit) for point in curve.control_points),
        weights=tuple(quantity(Number, float(weight)) for weight in weights) if weights else None,
    )
    for trouble in spec.troubles():
        raise UnreadableError(f"{_called(entity)}: {trouble.message}", trouble.hint)
    start, end = (_mm(curve.point(knot), unit) for knot in (knots[curve.degree], knots[-curve.degree - 1]))
    return Piece((CurveSpec(bspline=spec),), start, end, dist(start, end) <= GAP_MM)


def least_gap(curves: Sequence[Piece]) -> float | None:
    """Return how near ends of two curves come to each other, mm; None for closed ones, and for too many to be meant."""
    open_ones = [curve for curve in curves if not curve.closed]
    if len(open_ones) > MOST_COMPARED:
        return None
    pairs = (pair for a, b in combinations(open_ones, 2) for pair in product((a.start, a.end), (b.start, b.end)))
    return min((dist(*pair) for pair in pairs), default=None)


MOST_COMPARED = 50
"""Open curves of a layer among which the nearest ends are looked for: some 5000 pairs."""


def chains(parts: Sequence[Piece]) -> list[Piece]:
    """Return the curves that the pieces make, in the order of their first pieces."""
    ends = [(i, point) for i, part in enumerate(parts) if not part.closed for point in (part.start, part.end)]
    meeting = _neighbours(ends)
    used: set[int] = set()
    found: list[Piece] = []
    for i, part in enumerate(parts):
        if i in used:
            continue
        used.add(i)
        curve = part if part.closed else _extended(parts, meeting, used, part)
        if not curve.closed:
            curve = _extended(parts, meeting, used, curve.backwards()).backwards()
        found.append(curve)
    return found


Meeting = dict[XYZ, list[int]]


def _neighbours(ends: Sequence[tuple[int, XYZ]]) -> Meeting:
    """Return for each end the pieces that have an end there, itself included."""
    cells: dict[tuple[int, ...], list[tuple[int, XYZ]]] = {}
    for entry in ends:
        cells.setdefault(_cell(entry[1]), []).append(entry)
    meeting: Meeting = {}
    for _, point in ends:
        around = product(*((step - 1, step, step + 1) for step in _cell(point)))
        near = [i for cell in around for i, other in cells.get(cell, ()) if dist(point, other) <= GAP_MM]
        if len(near) > len("ab"):
            place = ", ".join(f"{x:.6g}" for x in point)
            raise UnreadableError(f"{len(near)} ends meet at ({place}) mm", "remove doubled or branching lines")
        meeting[point] = near
    return meeting


def _cell(point: XYZ) -> tuple[int, ...]:
    return tuple(int(x // GAP_MM) for x in point)


def _extended(parts: Sequence[Piece], meeting: Meeting, used: set[int], curve: Piece) -> Piece:
    """Return the curve with every piece that follows on its end."""
    links, end = list(curve.links), curve.end
    while following := [i for i in meeting[end] if i not in used]:
        used.add(following[0])
        part = parts[following[0]]
        part = part if dist(part.start, end) <= dist(part.end, end) else part.backwards()
        links += part.links
        end = part.end
    closed = dist(curve.start, end) <= GAP_MM and len(links) > 1
    return Piece(tuple(links), curve.start, end, closed)
