"""Planes, cylinders of revolution and right circular cones through the vertices of a mesh, by least squares.

The vertices of a good mesh lie on the surface that it was made from, to the rounding of its file; its facets do not.
So the sum of squares of the vertices' distances is minimised (Levenberg and Marquardt), from starts that facets give:
on a cylinder and on a cone the normals lie on a circle of the unit sphere, so their least principal axis is the axis;
where they hardly spread, the quadric over the plane of the vertices gives it.  A cone's apex lies in all its tangent
planes [1]_.

A cylinder and a cone are both given near the vertices: by the point of the axis beside their centroid, the radius
there, and (cone) the half angle.  So a cone that is almost a cylinder is as well conditioned as any other.

.. [1] G. Lukacs, R. Martin, D. Marshall, "Faithful least-squares fitting of spheres, cylinders, cones and tori for
   reliable segmentation", ECCV 1998: why distances, and parameters near the data.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import EPS, Array, ArrayValue, Points3, Values, Vector3, cross3, dot, norm, unit
from stages.geometry.mesh.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Plane(ArrayValue):
    """A plane through a point, with the unit normal on the side of the mesh's outside."""

    point: Vector3
    normal: Vector3


@dataclass(frozen=True, slots=True, eq=False)
class Rotational(ArrayValue):
    """A cylinder (half angle 0) or a cone: a point of the axis, its unit direction, the radius at that point.

    The radius grows along the axis, by tan(half_angle_rad) per mm.
    """

    point: Vector3
    axis: Vector3
    radius: float
    half_angle_rad: float = 0.0

    @property
    def apex(self) -> Vector3 | None:
        """Return the apex; None on a cylinder."""
        if self.half_angle_rad == 0.0:
            return None
        apex: Vector3 = self.point - self.radius / np.tan(self.half_angle_rad) * self.axis
        return apex


Primitive = Plane | Rotational


def distances(primitive: Primitive, points: Points3) -> Values:
    """Return the signed distances of points, mm: on a rotational surface positive outside."""
    if isinstance(primitive, Plane):
        return dot(points - primitive.point, np.broadcast_to(primitive.normal, points.shape))
    return _beside(points, primitive.point, primitive.axis, primitive.radius, primitive.half_angle_rad)


def _beside(points: Points3, point: Vector3, axis: Vector3, radius: float, angle: float) -> Values:
    """Return the signed distances from the cone with these parameters."""
    offset = points - point
    height = offset @ axis
    away = norm(offset - height[:, None] * axis)
    distance: Values = (away - radius) * np.cos(angle) - height * np.sin(angle)
    return distance


def normals(primitive: Primitive, points: Points3) -> Points3:
    """Return the unit normals beside points: outward on a rotational surface."""
    if isinstance(primitive, Plane):
        return np.broadcast_to(primitive.normal, points.shape)
    offset = points - primitive.point
    outward = unit(offset - (offset @ primitive.axis)[:, None] * primitive.axis)
    cosine, sine = np.cos(primitive.half_angle_rad), np.sin(primitive.half_angle_rad)
    found: Points3 = cosine * outward - sine * primitive.axis
    return found


def facets(mesh: Mesh) -> tuple[Points3, Points3]:
    """Return the centroids of the facets, and their normals with twice their areas as lengths, mm and mm2."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    return (a + b + c) / 3.0, cross3(b - a, c - a)


def plane(mesh: Mesh) -> Plane:
    """Return the plane of least squares."""
    centroid = mesh.vertices.mean(axis=0)
    axes = np.linalg.svd(mesh.vertices - centroid, full_matrices=False)[2]
    way = float(np.sign(facets(mesh)[1].sum(axis=0) @ axes[2])) or 1.0
    return Plane(centroid, way * axes[2])


def cylinder(mesh: Mesh) -> Rotational | None:
    """Return the cylinder of least squares; None where no start leads to one."""
    return _best(mesh, _cylinder_start, cone=False)


def cone(mesh: Mesh) -> Rotational | None:
    """Return the cone of least squares, its axis away from the apex; None where no start leads to one.

    A start that has no apex is that of a cylinder.
    """
    return _best(mesh, lambda cloud, axis: _cone_start(cloud, axis) or _cylinder_start(cloud, axis), cone=True)


@dataclass(frozen=True, slots=True, eq=False)
class _Cloud(ArrayValue):
    """Vertices about their centroid in units of their extent; centres and vector areas of facets likewise, (m, 3)."""

    points: Points3
    centres: Array
    areas: Array


Start = Callable[[_Cloud, Vector3], Rotational | None]


def _best(mesh: Mesh, start: Start, *, cone: bool) -> Rotational | None:
    """Return the fit with the least sum of squares from all starts, in mm."""
    centroid = mesh.vertices.mean(axis=0)
    extent = float(norm(mesh.vertices - centroid).max())
    centres, areas = facets(mesh)
    cloud = _Cloud((mesh.vertices - centroid) / extent, (centres - centroid) / extent, areas / extent**2)
    some = cloud.points[:: len(cloud.points) // MOST_AT_FIRST + 1]
    best, least = None, np.inf
    for axis in _axes(cloud):
        begun = start(cloud, axis)
        fit = _fitted(some, begun, cone=cone) if begun is not None else None
        off = float(np.abs(distances(fit, some)).max()) if fit is not None else np.inf
        if off < least:
            best, least = fit, off
        if least <= FOUND:
            break
    best = _fitted(cloud.points, best, cone=cone) if best is not None else None
    if best is None:
        return None
    return Rotational(centroid + extent * best.point, best.axis, extent * best.radius, best.half_angle_rad)


MOST_AT_FIRST = 2000
"""Vertices, evenly taken, that starts are tried on; the best is refined on all."""
FOUND = 1e-6
"""Of the extent: a start that leads to less needs no rival."""


def _axes(cloud: _Cloud) -> list[Vector3]:
    """Return directions that the axis may have: by the normals about their mean, about 0, and by a quadric."""
    weight = norm(cloud.areas)
    facing = unit(cloud.areas)
    mean = (weight @ facing) / weight.sum()
    found = [np.linalg.eigh((weight * (facing - m).T) @ (facing - m))[1][:, 0] for m in (mean, np.zeros(3))]
    return [*found, _quadric_axis(cloud)]


def _quadric_axis(cloud: _Cloud) -> Vector3:
    """Return the direction of least curvature of the quadric over the plane of the vertices."""
    x, y, z = np.linalg.svd(cloud.points, full_matrices=False)[2]
    a, b, h = cloud.points @ x, cloud.points @ y, cloud.points @ z
    rows = np.column_stack([a * a / 2.0, a * b, b * b / 2.0, a, b, np.ones_like(a)])
    xx, xy, yy, *_ = np.linalg.lstsq(rows, h, rcond=None)[0]
    bends, ways = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
    way = ways[:, int(np.argmin(np.abs(bends)))]
    return np.asarray(way[0] * x + way[1] * y)


def _cylinder_start(cloud: _Cloud, axis: Vector3) -> Rotational | None:
    """Return the cylinder about an axis: the circle of least squares of the vertices seen along it (after Kasa)."""
    x, y = frame_about(axis)
    p = np.column_stack([cloud.points @ x, cloud.points @ y])
    rows = np.column_stack([2.0 * p, np.ones(len(p))])
    (cx, cy, rest), _, rank, _ = np.linalg.lstsq(rows, dot(p, p), rcond=None)
    square = rest + cx * cx + cy * cy
    if rank < rows.shape[1] or not FINITE_RADIUS**-2 < square < FINITE_RADIUS**2:
        return None
    return Rotational(cx * x + cy * y, axis, float(np.sqrt(square)))


FINITE_RADIUS = 1e5
"""Radii beyond so many extents bend by less than 1e-5 rad over the part; below its inverse the part is a line."""


def _cone_start(cloud: _Cloud, axis: Vector3) -> Rotational | None:
    """Return the cone about an axis whose apex is nearest to all tangent planes of the facets."""
    weight, facing = norm(cloud.areas), unit(cloud.areas)
    matrix = (weight * facing.T) @ facing
    right = (weight * facing.T) @ dot(facing, cloud.centres)
    apex = np.linalg.lstsq(matrix, right, rcond=EPS)[0]
    way = -float(np.sign(apex @ axis)) or 1.0
    axis = way * axis
    offset = cloud.points - apex
    height = offset @ axis
    away = norm(offset - height[:, None] * axis)
    slope = float(away @ height / max(float(height @ height), EPS))
    middle = float(-apex @ axis)
    if not (slope > 0.0 and middle > 0.0):
        return None
    return Rotational(apex + middle * axis, axis, slope * middle, float(np.arctan(slope)))


def frame_about(axis: Vector3) -> tuple[Vector3, Vector3]:
    """Return x and y, unit vectors that make a right-handed frame x, y, axis."""
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = np.cross(axis, least)
    x /= float(norm(x))
    return x, np.cross(axis, x)


def _fitted(points: Points3, start: Rotational, *, cone: bool) -> Rotational | None:
    """Return the surface of least squares near a start; None where the radius or the angle is none.

    Unknown are two tilts of the axis, two shifts of its point, the radius and (cone) the half angle, each time about
    the last estimate.  A step that does not help is tried shorter (Marquardt's damping).
    """
    found, damping = start, FIRST_DAMPING
    off = distances(found, points)
    for _ in range(MOST_STEPS):
        x, y = frame_about(found.axis)
        slopes = _slopes(found, points, x, y)[:, : None if cone else -1]
        scale = norm(slopes.T)
        rows = np.vstack([slopes, np.diag(np.sqrt(damping) * scale)])
        step = np.linalg.lstsq(rows, np.concatenate([-off, np.zeros(scale.size)]), rcond=EPS)[0]
        tried = _moved(found, step, x, y)
        off_tried = distances(tried, points)
        better = bool(off_tried @ off_tried < off @ off)
        if better:
            found, off = tried, off_tried
        damping = max(damping / SOONER, LEAST_DAMPING) if better else damping * LATER
        if (not better and float(np.abs(step * scale).max()) <= AT_REST * np.sqrt(len(points))) or damping > HOPELESS:
            break
    return _normal(found)


FIRST_DAMPING, LEAST_DAMPING, HOPELESS = 1e-4, 1e-12, 1e6
SOONER, LATER = 100.0, 10.0
"""Damping as a share of the squared slopes, and how it changes: a good start is all but undamped after three steps."""
AT_REST = 1e-10
"""A step that moves the surface by less, as a share of the extent, and does not help is the last one: the one before
has squared its error."""
MOST_STEPS = 100
"""Of a fit that begins near the surface: a few do; what is not at rest after so many is no such surface."""


def _slopes(at: Rotational, points: Points3, x: Vector3, y: Vector3) -> Array:
    """Return d distance / d (tilt x, tilt y, shift x, shift y, radius, half angle), shape (n, 6)."""
    offset = points - at.point
    height = offset @ at.axis
    radial = offset - height[:, None] * at.axis
    away, outward = norm(radial), unit(radial)
    cosine, sine = np.cos(at.half_angle_rad), np.sin(at.half_angle_rad)
    ways = np.stack([outward @ x, outward @ y])
    tilts, shifts = -ways * (height * cosine + away * sine), -ways * cosine
    grown = np.full(len(points), -cosine)
    opened = -(away - at.radius) * sine - height * cosine
    return np.column_stack([*tilts, *shifts, grown, opened])


def _moved(at: Rotational, step: Values, x: Vector3, y: Vector3) -> Rotational:
    """Return the surface with changed parameters."""
    tilted = at.axis + step[0] * x + step[1] * y
    point = at.point + step[2] * x + step[3] * y
    opened = float(step[5]) if step.size > CYLINDRICAL else 0.0
    return Rotational(point, tilted / float(norm(tilted)), at.radius + float(step[4]), at.half_angle_rad + opened)


CYLINDRICAL = 5
"""Parameters of a cylinder; a cone has one more."""


def _normal(fit: Rotational) -> Rotational | None:
    """Return the surface with its point beside the centroid (0) and a half angle from 0 to 90 deg, else None."""
    axis, angle = (fit.axis, fit.half_angle_rad) if fit.half_angle_rad >= 0.0 else (-fit.axis, -fit.half_angle_rad)
    height = -float(fit.point @ axis)
    radius = fit.radius + height * np.tan(angle)
    if not (0.0 < radius < FINITE_RADIUS and angle < np.pi / 2.0):
        return None
    return Rotational(fit.point + height * axis, axis, float(radius), float(angle))
