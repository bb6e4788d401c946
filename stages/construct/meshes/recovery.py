"""A mesh as the exact surface that it was made from, where it is one: a plate, a cylinder, a cone, a developable.

    recovered(part, mesh, loops, tol) -> Recovery | None

Planes, cylinders of revolution and right circular cones are recognised by their vertices (`geometry.mesh.recognise`).
The boundary's points go into the plane by closed forms; smooth edges are put through them there, lines, arcs and
splines (`geometry.curves.refit`).  Where they are the four edges of a patch the surface is that patch, otherwise it
carries them as its trim.  Flanges, bends and folds with parallel rulings make a strip (`mesh.bending`).  Any other
developable is fitted as the envelope of its tangent planes (`developable`).  None where the vertices are not explained
by such a surface: then the mesh itself has to be flattened.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stages.construct.curves import plane_axes
from stages.construct.meshes.bends import bent_sheet
from stages.construct.meshes.developable import developable
from stages.geometry.arrays import Array, Numbers, Vector2, diagonal, norm
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.curves.refit import refitted
from stages.geometry.mesh.chart import Pulled, Unrolled, chart, pulled, unrolled
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import Plane
from stages.geometry.mesh.recognise import Deviation, Recognised, recognised
from stages.model.material import Part
from stages.model.report import Finding, Metric
from stages.model.surface import Plate, RuledSurface, Trim, whole_spans
from stages.model.tolerances import Tolerances

Loops = Sequence[Numbers]
"""Boundary loops by the numbers of their vertices, the surface on their left, the outer one first."""


@dataclass(frozen=True, slots=True, eq=False)
class Recovery:
    """The surface, its deviation as metrics, the parameters found, and what is to be told of it.

    frame: origin, x and y of a plate's plane as rows, shape (3, 3); None of a ruled surface.
    """

    surface: RuledSurface | Plate
    metrics: tuple[Metric, ...]
    detail: dict[str, object] = field(default_factory=dict)
    frame: Array | None = None
    findings: tuple[Finding, ...] = ()


def recovered(part: Part, mesh: Mesh, loops: Loops, tol: Tolerances) -> Recovery | None:
    """Return the exact surface of a mesh that is one oriented disc, maybe with holes; None where it is none known."""
    found = recognised(mesh, chord_mm=tol.chord_mm)
    if found is None:
        return _bent(part, mesh, loops, tol) or _developable(part, mesh, loops, tol)
    size = diagonal(mesh.vertices)
    accuracy = max(KEPT * found.deviation.most_mm, found.deviation.rounding_mm, ROUNDING * size)
    metrics, detail = _metrics(found.deviation, tol), _detail(found)
    if isinstance(found.primitive, Plane):
        plate, frame = _plate(part, mesh, loops, found.primitive, accuracy)
        return Recovery(plate, metrics, detail, frame)
    made = unrolled(mesh, found.primitive)
    ranged = _Ranged(made, loops, accuracy)
    return Recovery(_rolled(part, mesh, ranged), metrics, detail)


def _bent(part: Part, mesh: Mesh, loops: Loops, tol: Tolerances) -> Recovery | None:
    made = bent_sheet(part, mesh, loops, tol)
    if made is None:
        return None
    metrics = (*_metrics(made.deviation, tol), *made.metrics)
    return Recovery(made.surface, metrics, made.detail, findings=made.findings)


def _developable(part: Part, mesh: Mesh, loops: Loops, tol: Tolerances) -> Recovery | None:
    made = developable(part, mesh, loops, tol)
    return Recovery(made.surface, _metrics(made.deviation, tol), made.detail) if made is not None else None


KEPT = 2.0
"""Boundary points are displaced along the surface as well as off it."""
ROUNDING = 1e-12
"""Of flat positions, as a share of the size."""


def _metrics(deviation: Deviation, tol: Tolerances) -> tuple[Metric, ...]:
    return (
        Metric("fit_deviation_mm", deviation.most_mm, "mm", "proved", tol.chord_mm),
        Metric("fit_rms_mm", deviation.rms_mm, "mm", "proved"),
    )


def _detail(found: Recognised) -> dict[str, object]:
    """Return what was recognised, with its parameters."""
    rounding: dict[str, object] = {"rounding_mm": found.deviation.rounding_mm}
    if isinstance(found.primitive, Plane):
        plane = found.primitive
        named: dict[str, object] = {"kind": "plane", "point": plane.point.tolist(), "normal": plane.normal.tolist()}
        return {"recognised": named | rounding}
    surface, apex = found.primitive, found.primitive.apex
    named = {"kind": "cylinder" if apex is None else "cone", "axis": surface.axis.tolist()}
    if apex is None:
        named |= {"point": surface.point.tolist(), "radius_mm": surface.radius}
    else:
        named |= {"apex": apex.tolist(), "half_angle_deg": float(np.degrees(surface.half_angle_rad))}
    return {"recognised": named | rounding}


# Plates


def _plate(part: Part, mesh: Mesh, loops: Loops, plane: Plane, accuracy: float) -> tuple[Plate, Array]:
    """Return the plate seen from the mesh's outside, and its frame."""
    frame = _plane_frame(plane)
    flat = (mesh.vertices - frame[0]) @ frame[1:].T
    outline, *holes = (refitted(flat[loop], accuracy=accuracy).edges for loop in loops)
    size = diagonal(flat)
    return Plate(part, outline, tuple(holes), size), frame


def _plane_frame(plane: Plane) -> Array:
    """Return origin, x and y of a plane: those of the file where its normal is z, else by the arbitrary-axis rule."""
    x, y, z = np.eye(3)
    if float(norm(plane.normal - z)) <= LEVEL:
        return np.stack([plane.point[2] * z, x, y])
    return np.stack([float(plane.point @ plane.normal) * plane.normal, *plane_axes(plane.normal)])


LEVEL = 1e-9
"""A normal nearer to z is z."""


# Cylinders and cones


@dataclass(frozen=True, slots=True, eq=False)
class _Ranged:
    """The flat vertices of a rolled mesh, its boundary, and how far its points may be off, mm."""

    made: Unrolled
    loops: Loops
    accuracy: float


def _rolled(part: Part, mesh: Mesh, ranged: _Ranged) -> RuledSurface:
    """Return the patch of a cylinder or cone that holds the mesh, with its trim if it has one."""
    made, polar = ranged.made, ranged.made.polar
    border = polar[np.concatenate(ranged.loops)]
    low, high = np.nanmin(border, axis=0), np.nanmax(border, axis=0)
    size = diagonal(mesh.vertices)
    if len(ranged.loops) == 1 and _fills(ranged, low, high):
        return RuledSurface(part, (chart(made, *_middles(ranged, low, high)).patch,), size, whole_spans(1))
    edges = [refitted(made.flat[loop], accuracy=ranged.accuracy).edges for loop in ranged.loops]
    held = chart(made, *_reach(made, edges, low, high))
    outer, *inner = (pulled(held, loop) for loop in edges)
    return RuledSurface(part, (held.patch,), size, whole_spans(1), trim=Trim(outer, tuple(inner)))


def _fills(ranged: _Ranged, low: Vector2, high: Vector2) -> bool:
    """Return whether neighbours on the boundary lie on one of four edges: two circles and two rulings."""
    made = ranged.made
    polar = made.polar[ranged.loops[0]]
    scale = made.found.radius
    if made.found.half_angle_rad:
        scale = np.abs(polar[:, 0]) * np.sin(made.found.half_angle_rad)
    sides = (
        (polar[:, 0] - low[0]),
        (polar[:, 0] - high[0]),
        (polar[:, 1] - low[1]) * scale,
        (polar[:, 1] - high[1]) * scale,
    )
    on = np.abs(np.stack(sides)) <= ranged.accuracy
    apex = np.isnan(polar[:, 1])
    return bool(np.all((on & np.roll(on, -1, axis=1)).any(axis=0) | apex | np.roll(apex, -1)))


def _middles(ranged: _Ranged, low: Vector2, high: Vector2) -> tuple[Vector2, Vector2]:
    """Return the means of the boundary's points along each of the four edges: their extremes are off by noise."""
    polar = ranged.made.polar[ranged.loops[0]]
    beside = ranged.accuracy / np.array([1.0, ranged.made.found.radius])
    ends = [
        [float(np.mean(column[np.abs(column - end) <= near], dtype=np.float64)) for column, end, near in sides]
        for sides in (zip(polar.T, low, beside, strict=True), zip(polar.T, high, beside, strict=True))
    ]
    return np.array(ends[0]), np.array(ends[1])


def _reach(
    made: Unrolled, edges: Sequence[tuple[PlaneCurve, ...]], low: Vector2, high: Vector2
) -> tuple[Vector2, Vector2]:
    """Return the range that the edges of the outline need: beyond the vertices where they swell between them."""
    first = chart(made, low, high)
    t = np.linspace(0.0, 1.0, SAMPLES)
    places = np.concatenate([Pulled(first, edge).at(t) for edge in edges[0]])
    beyond = np.maximum(np.maximum(-places, places - 1.0).max(axis=0), 0.0)
    grown = np.where(beyond > SWELLS, GROWN * beyond, 0.0) * (high - low)
    least = low - grown
    if made.found.half_angle_rad:
        least[0] = max(least[0], low[0] / GROWN)
    return least, high + grown


SAMPLES, GROWN, SWELLS = 257, 2.0, 1e-12
"""Places on each edge; how much farther than they the range reaches; what is rounding."""
