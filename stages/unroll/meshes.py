"""The pattern of a mesh that was not recognised: its flat map, with smooth edges through the corners of its boundary.

    flatten_mesh(certificate, tol) -> Outcome[FlatPattern | None]

The map is the one that `verify` judged, or that of the neutral surface of a thick sheet (`meshneutral`).  What is said
of it is measured on positions: lengths of the boundary against cubic splines through the same vertices in space, areas
and angles against those of the triangles on the fitted surface, strains triangle by triangle.  The boundary's own
curves are put back (`geometry.curves.refit`), so that arcs are cut and not facets; how far they leave the polygon, and
what they are worth between its points, is told.  Sides of a cut run straight from end to end: they are congruent, so
that their zigzag cancels.

Nothing here is proved, and nothing is better than the mesh: its noise is in every number, in strains most of all.  They
are measured here and not judged; `verify` judged them, over cells of many triangles, with their uncertainty.
"""

from collections.abc import Sequence

import numpy as np

from stages.geometry.arrays import Points2
from stages.geometry.curves import contours
from stages.geometry.curves.plane import CircularArc, PlaneCurve
from stages.geometry.curves.planespline import spline
from stages.geometry.curves.refit import refitted
from stages.geometry.flat.lying import lying
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.nearest import at
from stages.model.features import CircleHole
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Metric, Outcome, StageReport
from stages.model.surface import Certificate, MeshSurface, Placed
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.features import Features, Flat, on_outline
from stages.unroll.finished import box, finished, flat_figures
from stages.unroll.limits import overlap, overlap_findings
from stages.unroll.meshdistortion import Loops, areas, distortion, sides, strain_field
from stages.unroll.meshneutral import mesh_neutral
from stages.unroll.meshsewing import sewing, without_zigzag

POSITIONS = 1e-9
"""What flat positions are worth without any noise, as a share of the size."""

DIVIDE = "along a line, with a seam or in the mesh itself"
DIVIDE_CUT = (
    f"{DIVIDE}; the sides of a cut in a saddle overlap when flat: it needs a gusset or a separate piece in its place"
)

WITHIN_NOISE = 4.0
"""Standard deviations of the vertices within which points of a boundary count as straight or circular."""


def flatten_mesh(certificate: Certificate, tol: Tolerances) -> Outcome[FlatPattern | None]:
    """Return the pattern of a mesh in its own frame, or None with the reason.

    Raises NoSolutionError where the arcs do not keep the chord.
    """
    surface, flat = certificate.surface, certificate.flat
    if not isinstance(surface, MeshSurface) or flat is None:
        raise ValueError("a mesh is unrolled with the map that it was judged on")
    sheet = mesh_neutral(surface, flat)
    surface, flat = sheet.surface, sheet.flat
    rotation, move = lying(flat.positions[surface.loops[0]])
    flat = flat.replace(positions=flat.positions @ rotation.T + move)
    loops = _loops(surface, flat)
    name = surface.part.name
    outer = outline.contour(loops.fitted[0].edges, tol.chord_mm, name)
    holes = tuple(outline.contour(loop.edges, tol.chord_mm, f"hole-{i}") for i, loop in enumerate(loops.fitted[1:], 1))
    covered = overlap(outer)
    made = on_outline(surface, outer, holes, lambda one: _image(surface, flat, one))
    metrics = (
        *distortion(surface, flat, loops),
        *sewing(surface, flat, loops),
        covered,
        *_boundary(loops),
        *sheet.metrics,
        *made.metrics,
    )
    findings = (
        *overlap_findings(covered, DIVIDE_CUT if surface.slits else DIVIDE),
        *sheet.findings,
        *made.findings,
    )
    corners = box(made.outer)
    detail = {"class": certificate.reached} | _figures(surface, flat, made, (outer, *holes)) | sheet.detail
    report = StageReport("unroll", name, metrics, findings, detail)
    if not report.passed:
        return Outcome(None, report)
    return Outcome(finished(surface.part, made, corners, tol), report)


def _loops(surface: MeshSurface, flat: MeshMap) -> Loops:
    """Return the boundary loops without what lies inside the sides of seams, and smooth edges through them."""
    vertices = surface.straight_loops
    places = without_zigzag(surface, flat)
    accuracy = max(WITHIN_NOISE * flat.noise_mm, POSITIONS * surface.size_mm)
    return Loops(vertices, tuple(refitted(places[loop], accuracy=accuracy) for loop in vertices))


def _boundary(loops: Loops) -> tuple[Metric, ...]:
    """Return how the smooth edges lie to the polygons of the boundary."""
    return (
        Metric("boundary_sagitta_mm", max(loop.sagitta_mm for loop in loops.fitted), "mm"),
        Metric("boundary_uncertainty_mm", max(loop.uncertainty_mm for loop in loops.fitted), "mm"),
    )


def _image(surface: MeshSurface, flat: MeshMap, one: Placed) -> Flat:
    """Return a feature through the map: a place as a point, with x for a direction, a curve as splines."""
    pieces = [at(surface.mesh, piece, flat.positions) for piece in one.on_mesh]
    x = np.array([1.0, 0.0])
    if len(pieces[0]) > 1:
        return Flat(one, tuple(spline(piece) for piece in pieces))
    middle = pieces[0][0]
    if isinstance(one.spec, CircleHole):
        circle: PlaneCurve = CircularArc(middle, float(one.spec.diameter) / 2.0, 0.0, -2.0 * np.pi)
        return Flat(one, (circle,), middle, x)
    if len(pieces) > 1:
        return Flat(one, (spline(_closed(pieces[1]), periodic=True),), middle, x)
    return Flat(one, (), middle, x)


def _closed(points: Points2) -> Points2:
    """Return points of which the last is the first, to the last bit."""
    closed = points.copy()
    closed[-1] = closed[0]
    return closed


def _figures(surface: MeshSurface, flat: MeshMap, made: Features, bare: Sequence[Contour]) -> dict[str, object]:
    """Return the figures of both sides: area of the triangles on the surface, and inside the contours of the pattern.

    bare: outline and holes of the mesh, without what is cut into them, as the triangles are without it.
    """
    area, length = sum(contours.area(one.edges) for one in bare), contours.length(bare[0].edges)
    return {
        "surface": {"area": float(areas(sides(surface, flat)).sum()), "edges": None},
        "flat": flat_figures(made, box(made.outer), area=area, length=length),
        "flattened_on": flat.kind,
        "strain_field": strain_field(surface, flat),
    }
