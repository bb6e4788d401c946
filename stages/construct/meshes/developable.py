"""A mesh as a developable of any sort: fitted as the envelope of its tangent planes, with its outline as a trim.

    developable(part, mesh, loops, tol) -> Found | None

The envelope (`geometry.mesh.rulings`) is developable by construction; whether it is the surface of the mesh its
vertices tell.  It is taken if none is farther away than a tenth of the chord and than `NEAR` of the size, or than
rounding and noise explain; so what is only nearly developable is left to those who flatten it.  Straight and
circular edges of the outline are found in the plane, where the vertices lie by the exact development of the patch, and
carried back to u and v; splines run through the vertices there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import Numbers, diagonal
from stages.geometry.curves.plane import PlaneCurve
from stages.geometry.curves.planespline import Spline, spline
from stages.geometry.curves.refit import refitted
from stages.geometry.mesh.chart import interpolated
from stages.geometry.mesh.envelope import Developed, common, patch_of
from stages.geometry.mesh.fit import MOST_TRIANGLES, fitted, stars
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.recognise import SHARE, Deviation, deviation_of, rounding
from stages.geometry.mesh.rulings import enveloped
from stages.geometry.mesh.topology import edges_of
from stages.model.material import Part
from stages.model.surface import RuledSurface, Trim, whole_spans
from stages.model.tolerances import Tolerances

NEAR = 1e-7
"""Deviation that leaves flat positions within a millionth of the size."""
ENOUGH = 1e-10
"""Deviation, as a share of the size, that no higher degree need improve."""
FEWEST = 200
"""Vertices from which curvatures are fitted."""
FLAT_ROUNDING = 1e-11
"""Of flat positions by quadrature, as a share of the size."""


@dataclass(frozen=True, slots=True)
class Found:
    """The surface, how far the vertices are from it, and what kind it is."""

    surface: RuledSurface
    deviation: Deviation
    detail: dict[str, object]


def developable(part: Part, mesh: Mesh, loops: Sequence[Numbers], tol: Tolerances) -> Found | None:
    """Return the developable of a mesh that is one oriented disc, maybe with holes; None where it is not known."""
    if len(mesh.vertices) < FEWEST or len(mesh.faces) > MOST_TRIANGLES:
        return None
    size = diagonal(mesh.vertices)
    enough = max(rounding(mesh.vertices), ENOUGH * size)
    family = enveloped(mesh, fitted(mesh, stars(mesh, edges_of(mesh))), enough_mm=enough)
    if family is None:
        return None
    deviation = deviation_of(mesh, family.off)
    near = deviation.most_mm <= min(SHARE * tol.chord_mm, NEAR * size)
    made = patch_of(mesh, family) if near or deviation.explained(tol.chord_mm) else None
    if made is None:
        return None
    chart = Developed(made.patch, made.places)
    accuracy = max(2.0 * deviation.most_mm, deviation.rounding_mm, FLAT_ROUNDING * size)
    try:
        outer, *inner = (_loop(chart, loop, accuracy) for loop in loops)
    except NoSolutionError:
        return None
    if not _inside(outer):
        return None
    surface = RuledSurface(part, (made.patch,), size, whole_spans(1), trim=Trim(outer, tuple(inner)))
    kind, place, _ = common(made.patch)
    named: dict[str, object] = {"kind": kind, "degree": len(family.turns) - 1, "rounding_mm": deviation.rounding_mm}
    named |= {"apex" if kind == "general cone" else "axis": place[0].tolist()} if len(place) else {}
    return Found(surface, deviation, {"recognised": named})


def _loop(chart: Developed, loop: Numbers, accuracy: float) -> tuple[PlaneCurve, ...]:
    """Return a boundary loop in u and v."""
    found = refitted(chart.flat[loop], accuracy=accuracy)
    ends = [*found.at[1:], found.at[0] + len(loop)]
    edges: list[PlaneCurve] = []
    for edge, first, last in zip(found.edges, found.at, ends, strict=True):
        run = loop[np.arange(first, last + 1) % len(loop)]
        closed = len(found.edges) == 1
        if isinstance(edge, Spline):
            edges.append(spline(chart.known[run], periodic=closed))
        else:
            edges.append(interpolated(chart, edge, NODES))
    return tuple(edges)


NODES = 40
"""Of the series that stand for the image of a line or arc in u and v: smooth, and less than a turn long."""


def _inside(outer: Sequence[PlaneCurve]) -> bool:
    """Return whether an outline stays on the patch: beyond the first and the last ruling there is none."""
    t = np.linspace(0.0, 1.0, SAMPLES)
    v = np.concatenate([edge.at(t)[:, 1] for edge in outer])
    return bool(v.min() >= 0.0 and v.max() <= 1.0)


SAMPLES = 65
"""Of each edge: it may leave the patch by `BESIDE` between the vertices, which 64 stretches do not miss."""
