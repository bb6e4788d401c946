"""Is a mesh that of a developable surface, as far as its vertices can tell?

    verdict(surface, tol) -> Verdict

No threshold on angle defects: on irregular meshes of exact developables they are large and grow under refinement,
on a finely divided hemisphere they are small.  Instead the mesh is flattened on lengths of the surface fitted to
its vertices (`geometry.meshflat`), and two things are asked.  The strain left, averaged over cells of many
triangles, with the standard error of that average.  And the Gaussian curvature averaged over regions
(`geometry.meshcurvature`), as the equivalent warp, with its uncertainty: how far it moves when the noise found is
added once more, and when the fit is one degree lower.

Both give the class, at their least and at their largest.  If the job accepts the worst that may be, the part
passes; if it refuses the best that may be, it is rejected; in between the mesh forbids a verdict, and the finding
says what it permits. A mesh is never `exact`.  What is smaller than a region, a dent say, shows in the strain
alone.
"""

from typing import Literal, NamedTuple

import numpy as np

from stages.geometry.meshfit import fitted, stars
from stages.geometry.meshflat import MeshMap, at_rest, edge_lengths, noise
from stages.geometry.meshtopology import edges_of
from stages.model.report import Finding, Metric, Where
from stages.model.surface import MeshSurface
from stages.model.tolerances import (
    CLASSES,
    STRAIN_LIMIT,
    WARP_LIMIT_DEG,
    Class,
    Tolerances,
    class_by_strain,
    class_by_warp,
)
from stages.verify.meshbounds import Bound, Studied, defect_sum, strain, strain_rms, warp

DEG = 180.0 / np.pi
AT_REST = 1e-10
"""The last step of the flattening, relative to the size of the part."""
BEST: Class = "fabrication"
"""The best class of a mesh: its vertices say nothing of what lies between them."""

Reached = Class | Literal["rejected", "inconclusive"]


class Verdict(NamedTuple):
    """What a mesh is: the numbers, what is wrong, the class, and the flat map that this rests on."""

    metrics: tuple[Metric, ...]
    findings: tuple[Finding, ...]
    reached: Reached
    flat: MeshMap


def verdict(surface: MeshSurface, tol: Tolerances) -> Verdict:
    """Return whether a mesh is developable enough for the job.

    Raises NoSolutionError if it could not be flattened to rest.
    """
    studied = _studied(surface)
    bent, strained = warp(studied), strain(studied)
    best, likely, worst = (_class(getattr(bent, at), getattr(strained, at)) for at in ("least", "value", "largest"))
    metrics = _metrics(surface, studied, bent, strained, tol)
    if worst is not None and tol.accepts(worst):
        return Verdict(metrics, (), likely or worst, studied.flat)
    if best is None or not tol.accepts(best):
        return Verdict(metrics, (_rejection(surface, bent, strained, tol),), "rejected", studied.flat)
    return Verdict(metrics, (_doubt(surface, studied, bent, strained, tol),), "inconclusive", studied.flat)


def _studied(surface: MeshSurface) -> Studied:
    """Return the mesh fitted and flattened."""
    mesh, edges = surface.mesh, edges_of(surface.mesh)
    around = stars(mesh, edges)
    fit = fitted(mesh, around)
    lengths, kind = edge_lengths(mesh, edges, fit)
    still = AT_REST * surface.size_mm
    return Studied(
        mesh, edges, around, fit, at_rest(mesh, edges, lengths, kind=kind, noise_mm=noise(fit), accuracy=still)
    )


def _class(warp_rad: float, strained: float) -> Class | None:
    """Return the best class that keeps both limits, None if none does."""
    reached = class_by_warp(warp_rad * DEG), class_by_strain(strained)
    if None in reached:
        return None
    return max(BEST, *(name for name in reached if name), key=CLASSES.index)


def _metrics(
    surface: MeshSurface, studied: Studied, bent: Bound, strained: Bound, tol: Tolerances
) -> tuple[Metric, ...]:
    flat = studied.flat
    limit = WARP_LIMIT_DEG[tol.accept], STRAIN_LIMIT[tol.accept]
    return (
        Metric("equivalent_warp_deg", _known(bent.value * DEG), "deg", "sampled", limit[0], _where(surface, bent)),
        Metric("equivalent_warp_least_deg", bent.least * DEG, "deg"),
        Metric("equivalent_warp_largest_deg", _known(bent.largest * DEG), "deg"),
        Metric("defect_sum_rad", defect_sum(studied), "rad"),
        Metric("mesh_noise", _known(flat.noise_mm), "mm"),
        Metric("strain_rms", strain_rms(studied)),
        Metric("max_strain", strained.value, "", "sampled", limit[1], _where(surface, strained)),
        Metric("max_strain_largest", strained.largest),
        Metric("flattening_error", flat.reached_mm / surface.size_mm),
    )


def _known(value: float) -> float | None:
    """Return a number for the report; None for one that is not known."""
    return value if np.isfinite(value) else None


def _where(surface: MeshSurface, bound: Bound) -> Where | None:
    """Return the place of the largest value."""
    if bound.vertex is None:
        return None
    x, y, z = (float(value) for value in surface.mesh.vertices[bound.vertex])
    return {"vertex": bound.vertex, "x": x, "y": y, "z": z}


def _rejection(surface: MeshSurface, bent: Bound, strained: Bound, tol: Tolerances) -> Finding:
    """Return why a mesh is refused whatever its noise: warp, strain, or a class that no mesh has."""
    reached = _class(bent.least, strained.least)
    if tol.accept == "exact":
        message = "a mesh is never 'exact': accept = 'fabrication' takes one that is developable as far as it can tell"
        return Finding("not-developable", message, True)
    by_warp = not tol.accepts(class_by_warp(bent.least * DEG) or "")
    size = (
        f"equivalent warp {bent.value * DEG:.4g} deg, at least {bent.least * DEG:.4g} deg, "
        f"allowed {WARP_LIMIT_DEG[tol.accept]:g} deg"
        if by_warp
        else f"strain {strained.value:.4g}, at least {strained.least:.4g}, allowed {STRAIN_LIMIT[tol.accept]:g}"
    )
    message = f"not developable enough: {size} (accept = {tol.accept!r}); it reaches {reached or 'no class'!r}"
    return Finding("not-developable", message, True, _where(surface, bent if by_warp else strained))


def _doubt(surface: MeshSurface, studied: Studied, bent: Bound, strained: Bound, tol: Tolerances) -> Finding:
    """Return why no verdict is possible, and the best class that the mesh permits one for."""
    permits = _class(bent.largest, strained.largest)
    cause = "noisy" if np.median(studied.fit.coarser / studied.fit.residual) < NOISE else "coarse"
    message = (
        f"the mesh is too {cause} for a verdict at accept = {tol.accept!r}: vertices lie "
        f"{studied.flat.noise_mm:.3g} mm off a smooth surface; equivalent warp between {bent.least * DEG:.3g} and "
        f"{bent.largest * DEG:.3g} deg, strain between {strained.least:.3g} and {strained.largest:.3g}; "
        + (f"it permits accept = {permits!r}" if permits else "it permits none")
    )
    return Finding("inconclusive", message, True, _where(surface, bent))


NOISE = 1.5
"""What fits of degree 3 and 4 leave is the same where it is noise; of a smooth surface the second leaves far less."""
