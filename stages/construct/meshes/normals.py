"""The normals of a mesh along a curve that lies on it: what a band that touches the mesh there is made from.

Places along the curve are pulled to the mesh; around each the surface behind the mesh is fitted
(`geometry.mesh.fit.fitted_at`), whose normal does not know the facets.  Through these normals goes a spline
(`geometry.numeric.smoothing`): on a clean mesh it follows them to `SETTLED`, on a noisy one it smooths them.  No span
is shorter than `LEAST_SPAN` edges of the mesh, between which it says nothing.

Refused: a curve that is off the mesh (another unit, another mesh) or leaves it, and a mesh so coarse, creased or noisy
there that fits of two degrees give unlike normals.  Folds and holes elsewhere in the mesh do not matter.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from types import MappingProxyType

import numpy as np

from stages.construct.bands import LEANING_DEG, positions
from stages.construct.curves import Chain, even
from stages.geometry.arrays import Array, ArrayValue, Points3, Values, cross3, diagonal, dot, floats, norm, unit
from stages.geometry.curves.curves import bezier, exactly
from stages.geometry.mesh.border import beyond
from stages.geometry.mesh.fit import WIDE_DEGREE, fitted_at
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.nearest import nearest
from stages.geometry.mesh.repair import repaired
from stages.geometry.mesh.topology import Edges, edges_of, turned, with_turned
from stages.geometry.numeric.smoothing import followed
from stages.model.meshes import MeshNormals
from stages.model.report import Finding, Metric, Where
from stages.model.tolerances import Tolerances

Meshes = Mapping[MeshNormals, Mesh]
"""The meshes that a part points at, as its file names them, in mm."""
NO_MESHES: Meshes = MappingProxyType({})

OFF = 0.01
"""A curve farther from the surface than this share of its size was meant for another: near its ends it may lean by as
much, half a degree."""
BEYOND = 0.25
"""A curve along the edge of a mesh lies up to an eighth of a side beyond it where it bends by a radian a side."""
CHANGE_DEG = LEANING_DEG
"""Of the normals from one degree of the fit to the next."""
SETTLED = 1e-7
"""Normals that the spline follows as near as this, rad, are followed: fits of clean meshes leave as much."""
MOST = 64
"""Spans of the spline."""
LEAST_SPAN = 3.0
"""Edges of the mesh to a span."""
PER_SPAN = 8
"""Places to a span: some three to an edge."""
INDEPENDENT = 1.0 / PER_SPAN * LEAST_SPAN
"""Of the places, one for each edge: fits an edge apart still share most of their vertices, but not all."""
FEWEST = 3
"""Spans: fewer than 8 coefficients on 9 independent places say nothing of noise."""
SLIPS = (25.4, 1000.0, 10.0, 1.0 / 25.4, 1.0 / 1000.0, 1.0 / 10.0)
"""By which lengths are off where a unit is mistaken."""


@dataclass(frozen=True, slots=True, eq=False)
class Touched(ArrayValue):
    """Places along a curve, and the surface behind a mesh there.

    v: of the curve.  points: on it.  tangents: of it, unit.  normals: of the surface.
    off_mm: how far the surface is from the points.  beyond_mm: how far the points lie beyond the edge of the mesh.
    change_rad: between normals of fits of two degrees.  residual_mm: of the vertices about the fit.
    side_mm: the longest side of the triangle there.
    """

    v: Values
    points: Points3
    tangents: Points3
    normals: Points3
    off_mm: Values
    change_rad: Values
    beyond_mm: Values
    side_mm: Values
    residual_mm: Values


@dataclass(frozen=True, slots=True)
class FromMesh:
    """The normals along a curve, None where there are none, what was measured, and what is found."""

    normals: Chain | None
    metrics: tuple[Metric, ...]
    findings: tuple[Finding, ...]


def mesh_normals(link: Chain, body: Mesh, tol: Tolerances) -> FromMesh:
    """Return the normals of a mesh along a chain, over the chain's parameter."""
    mesh = repaired(body).mesh
    edges = edges_of(mesh)
    over = turned(mesh, edges)
    if over is None:
        message = "the mesh that the normals are taken from has one side only, as a Moebius strip: it has no normals"
        return FromMesh(None, (), (Finding("mesh-one-sided", message, fatal=True),))
    found = _touched(link, with_turned(mesh, over), edges)
    refused = _refused(found, mesh)
    if refused:
        return FromMesh(None, _metrics(found), refused)
    near = followed(
        found.v,
        found.normals,
        (len(found.v) - 1) // PER_SPAN,
        independent=INDEPENDENT * (len(found.v) - 1),
        closed=_closed(found),
        settled=SETTLED,
    )
    metrics = (
        *_metrics(found),
        Metric("normal_spans", float(len(near.pieces)), "", "proved"),
        Metric("normal_residual_deg", float(np.degrees(near.rms)), "deg"),
    )
    leaning = _leaning(found, near.near)
    if leaning:
        return FromMesh(None, metrics, leaning)
    curves = [bezier([exactly(row) for row in piece]) for piece in near.pieces]
    return FromMesh(even(curves), metrics, _off_findings(found, tol))


# The surface along the curve


def _touched(link: Chain, mesh: Mesh, edges: Edges) -> Touched:
    """Return the surface at places along the curve, as close together as the mesh has something to say."""
    edge = float(np.median(norm(mesh.vertices[edges.ends[:, 1]] - mesh.vertices[edges.ends[:, 0]])))
    length = float(sum(norm(np.diff(positions([curve]), axis=0)).sum() for curve in link.curves))
    spans = min(max(ceil(length / (LEAST_SPAN * edge)), FEWEST), MOST)
    v = np.linspace(0.0, 1.0, PER_SPAN * spans + 1)
    points, tangents = _along(link, v)
    there = nearest(mesh, points)
    beside = mesh.faces[there.faces, np.argmax(there.weights, axis=1)]
    fit, other = (fitted_at(mesh, edges, points, beside, degree) for degree in (WIDE_DEGREE, WIDE_DEGREE - 1))
    corners = mesh.vertices[mesh.faces[there.faces]]
    side = norm(corners - np.roll(corners, -1, axis=1)).max(axis=1)
    sound = np.isfinite(fit.residual) & (np.abs(np.abs(fit.heights) - there.distances) <= side)
    change = np.arctan2(norm(cross3(fit.normals, other.normals)), dot(fit.normals, other.normals))
    return Touched(
        v=v,
        points=points,
        tangents=unit(tangents),
        normals=fit.normals,
        off_mm=np.where(sound, np.abs(fit.heights), there.distances),
        change_rad=np.where(sound, change, np.pi),
        beyond_mm=beyond(mesh, edges, points, there),
        side_mm=side,
        residual_mm=np.where(sound, fit.residual, np.inf),
    )


def _along(link: Chain, v: Values) -> Array:
    """Return points and derivatives of a chain, shape (2, n, 3)."""
    breaks = floats(link.breaks)
    piece = np.clip(np.searchsorted(breaks, v, side="right") - 1, 0, len(link.curves) - 1)
    jets = np.zeros((2, v.size, 3))
    for i, curve in enumerate(link.curves):
        mine = piece == i
        jets[:, mine] = curve.jet((v[mine] - breaks[i]) / (breaks[i + 1] - breaks[i]), 1)
    return jets


# What is found


def _closed(found: Touched) -> bool:
    """Return whether the curve ends where it begins."""
    return bool(norm(found.points[-1] - found.points[0]) <= CLOSES * diagonal(found.points))


CLOSES = 1e-9
"""Ends of a curve that are apart by a smaller share of its size are one point."""


def _worst(found: Touched, values: Values) -> tuple[float, Where]:
    worst = int(np.argmax(values))
    x, y, z = (float(value) for value in found.points[worst])
    return float(values[worst]), {"t": float(found.v[worst]), "x": x, "y": y, "z": z}


def _metrics(found: Touched) -> tuple[Metric, ...]:
    off, off_at = _worst(found, found.off_mm)
    change, change_at = _worst(found, np.degrees(found.change_rad))
    known = found.residual_mm[np.isfinite(found.residual_mm)]
    return (
        Metric("mesh_distance_mm", off, "mm", "sampled", OFF * diagonal(found.points), off_at),
        Metric("normal_change_deg", change, "deg", "sampled", CHANGE_DEG, change_at),
        Metric("mesh_noise", float(np.median(known)) if known.size else None, "mm"),
    )


def _refused(found: Touched, mesh: Mesh) -> tuple[Finding, ...]:
    """Return why the mesh has no normals along the curve."""
    gone = found.beyond_mm > BEYOND * found.side_mm
    off, off_at = _worst(found, found.off_mm)
    allowed = OFF * diagonal(found.points)
    if gone.any() and not gone.all() and not (found.off_mm[~gone] > allowed).any():
        beyond, place = _worst(found, found.beyond_mm)
        message = f"the curve leaves the mesh of its normals: it runs {beyond:.4g} mm beyond it at {_text(place)}"
        return (Finding("curve-leaves-mesh", message, True, place),)
    # facets of a mesh too coarse for a fit lie off the curve by nature, though by less than their sides
    unknown = np.isinf(found.residual_mm) & (found.off_mm <= found.side_mm)
    if off > allowed and not unknown.any():
        message = (
            f"the curve is {off:.4g} mm from the mesh that its normals are taken from at {_text(off_at)}, allowed "
            f"{allowed:.4g} mm{_slip(found, mesh)}"
        )
        return (Finding("curve-off-mesh", message, True, off_at),)
    change, place = _worst(found, np.degrees(found.change_rad))
    if change > CHANGE_DEG:
        message = (
            f"the mesh is too coarse, creased or noisy at {_text(place)} to say how its normals turn there (fits of "
            f"degrees {WIDE_DEGREE - 1} and {WIDE_DEGREE} differ by {change:.3g} deg); give a finer one"
        )
        return (Finding("mesh-normals", message, True, place),)
    return ()


def _leaning(found: Touched, normals: Array) -> tuple[Finding, ...]:
    """Refuse a curve that runs into the mesh."""
    sines = np.minimum(np.abs(dot(unit(normals), found.tangents)), 1.0)
    lean, place = _worst(found, np.degrees(np.arcsin(sines)))
    if lean <= LEANING_DEG:
        return ()
    message = f"the curve runs into the mesh at {lean:.3g} deg at {_text(place)}, allowed {LEANING_DEG:g} deg"
    return (Finding("normals-not-perpendicular", message, True, place),)


def _text(where: Where) -> str:
    return f"({', '.join(f'{float(where[key]):.6g}' for key in 'xyz')})"


def _slip(found: Touched, mesh: Mesh) -> str:
    """Return the cure where the mesh would lie along the curve in another unit."""
    few = found.points[:: max(len(found.points) // FEW, 1)]
    for slip in SLIPS:
        away = nearest(Mesh(mesh.vertices * slip, mesh.faces), few).distances
        if float(away.max()) <= OFF * diagonal(found.points):
            return f"; {slip:.4g} times as large it would lie along the curve: check `units`"
    return ": is it another mesh, or does it lie elsewhere?"


FEW = 16
"""Places that tell whether a mesh lies along a curve at all."""


def _off_findings(found: Touched, tol: Tolerances) -> tuple[Finding, ...]:
    """Say that the band will lie off the mesh where that shows."""
    off, place = _worst(found, found.off_mm)
    if off <= tol.chord_mm:
        return ()
    message = f"the curve lies up to {off:.4g} mm off the mesh, at {_text(place)}: the band runs along the curve"
    return (Finding("curve-beside-mesh", message, False, place),)
