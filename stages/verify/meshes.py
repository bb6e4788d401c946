"""Is a mesh that of a developable surface, as far as its vertices can tell?

    verdict(surface, tol) -> Verdict

No threshold on angle defects: on irregular meshes of exact developables they are large and grow under refinement,
on a finely divided hemisphere they are small.  Instead the mesh is flattened on lengths of the surface fitted to
its vertices (`geometry.mesh.flat`), and two things are asked.  The strain left, averaged over cells of many
triangles, with the standard error of that average.  And the Gaussian curvature averaged over regions
(`geometry.mesh.curvature`), as the equivalent warp, with its uncertainty: how far it moves when the noise found is
added once more, and when the fit is one degree lower.

Both give the class, at their least and at their largest.  If the job accepts the worst that may be, the part
passes; if it refuses the best that may be, it is rejected; in between the mesh forbids a verdict, and the finding
says what it permits. A mesh is never `exact`.  What is smaller than a region, a dent say, shows in the strain
alone.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.mesh.fit import MOST_TRIANGLES
from stages.geometry.mesh.meshmap import MeshMap
from stages.model.report import Finding, Metric, Where
from stages.model.surface import MeshSurface, no_pairs
from stages.model.tolerances import (
    CLASSES,
    STRAIN_LIMIT,
    WARP_LIMIT_DEG,
    Class,
    Tolerances,
    class_by_strain,
    class_by_warp,
)
from stages.verify.meshbending import mesh_bending
from stages.verify.meshbounds import (
    Bound,
    Curvatures,
    Studied,
    closer,
    curvatures,
    defect_sum,
    strain,
    strain_rms,
    warp,
)
from stages.verify.meshcuts import suggested
from stages.verify.meshstudy import study

DEG = 180.0 / np.pi
BEST: Class = "fabrication"
"""The best class of a mesh: its vertices say nothing of what lies between them."""

STRETCHED: Class = "leather"
"""What is stretched into its shape is judged by strain alone: cuts take the strain away and leave the warp."""

Reached = Class | Literal["rejected", "inconclusive"]


class Verdict(NamedTuple):
    """What a mesh is: the numbers, what is wrong, the class, the flat map that this rests on.

    regions: where the curvature was averaged, with what it adds up to there.
    """

    metrics: tuple[Metric, ...]
    findings: tuple[Finding, ...]
    reached: Reached
    flat: MeshMap
    regions: tuple[dict[str, object], ...] = ()


def too_fine(surface: MeshSurface) -> Finding:
    """Return that a mesh has more triangles than are laid flat."""
    message = (
        f"{len(surface.mesh.faces)} triangles, and no plane, cylinder, cone or bent sheet: at most {MOST_TRIANGLES} "
        "are laid flat; export it coarser, 10 000 triangles are good for 1e-7 of its size"
    )
    return Finding("mesh-too-fine", message, fatal=True)


def verdict(surface: MeshSurface, tol: Tolerances) -> Verdict:
    """Return whether a mesh is developable enough for the job.

    Raises NoSolutionError if it could not be flattened to rest.
    """
    try:
        studied = study(surface)
    except NoSolutionError as error:
        if not (len(surface.kept) or surface.slits):
            raise
        return _impossible(surface, error)
    strained = strain(studied)
    read = _read(studied, strained, tol)
    judged = _judged(surface, studied, warp(read), strained, tol)
    bends, bent = mesh_bending(surface, studied)
    metrics, findings = (*judged.metrics, *bends), (*judged.findings, *bent)
    return judged._replace(metrics=metrics, findings=findings, regions=tuple(_regions(surface, read)))


def _read(studied: Studied, strained: Bound, tol: Tolerances) -> Curvatures:
    """Return the curvatures, by closer fits where the first leave a doubt that decides and these leave less."""
    first = curvatures(studied)
    bent = warp(first)
    ends = {tol.accepts(_class(end, strained.value) or "") for end in (bent.least, bent.largest)}
    if len(ends) == 1 or not len(first.centres):
        return first
    second = curvatures(closer(studied))
    return second if second.doubt.max() < first.doubt.max() else first


def _regions(surface: MeshSurface, read: Curvatures) -> Iterator[dict[str, object]]:
    """Yield where the curvature was averaged, and its integral there, from which the warp follows."""
    areas = np.pi * read.radii**2
    warps = read.rulings * np.sqrt(np.abs(read.mean)) * DEG
    for centre, radius, total, doubt, bent in zip(
        read.centres, read.radii, areas * read.mean, areas * read.doubt, warps, strict=True
    ):
        x, y, z = (float(value) for value in surface.mesh.vertices[centre])
        yield {
            "vertex": int(centre), "x": x, "y": y, "z": z, "radius_mm": float(radius),
            "defect_rad": _known(float(total)), "defect_doubt_rad": _known(float(doubt)),
            "warp_deg": _known(float(bent)),
        }  # fmt: skip


def _judged(surface: MeshSurface, studied: Studied, bent: Bound, strained: Bound, tol: Tolerances) -> Verdict:
    best, likely, worst = (_class(*both) for both in zip(bent.values, strained.values, strict=True))
    metrics = _metrics(surface, studied, bent, strained, tol)
    if worst is not None and tol.accepts(worst):
        return Verdict(metrics, (), likely or worst, studied.flat)
    cuts = suggested(surface, studied) if tol.accept == STRETCHED else ()
    if best is None or not tol.accepts(best):
        return Verdict(metrics, (_rejection(surface, bent, strained, tol), *cuts), "rejected", studied.flat)
    return Verdict(metrics, (_doubt(surface, studied, bent, strained, tol), *cuts), "inconclusive", studied.flat)


def _impossible(surface: MeshSurface, error: NoSolutionError) -> Verdict:
    """Return why a mesh has no flat map with the lengths that were asked for, and its map without them."""
    loose = study(replace(surface, kept=no_pairs(), slits=()))
    message = (
        f"no flat pattern keeps the lengths that are asked for ({error}); without them the strain is "
        f"{float(np.abs(loose.flat.strains).max()):.3g} at most: keep shorter lines, or cut along lines that you keep"
    )
    return Verdict((), (Finding("keep-impossible", message, True),), "rejected", loose.flat)


def _class(warp_rad: float, strained: float) -> Class | None:
    """Return the best class that keeps both limits, None if none does."""
    bent = class_by_warp(warp_rad * DEG) or STRETCHED
    reached = bent, class_by_strain(strained)
    if None in reached:
        return None
    return max(BEST, *(name for name in reached if name), key=CLASSES.index)


def _metrics(
    surface: MeshSurface, studied: Studied, bent: Bound, strained: Bound, tol: Tolerances
) -> tuple[Metric, ...]:
    flat = studied.flat
    limit = None if tol.accept == STRETCHED else WARP_LIMIT_DEG[tol.accept], STRAIN_LIMIT[tol.accept]
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
    by_warp = not tol.accepts(class_by_warp(bent.least * DEG) or STRETCHED)
    size = (
        f"equivalent warp {bent.value * DEG:.4g} deg, at least {bent.least * DEG:.4g} deg, "
        f"allowed {WARP_LIMIT_DEG[tol.accept]:g} deg"
        if by_warp
        else f"strain {strained.value:.4g}, at least {strained.least:.4g}, allowed {STRAIN_LIMIT[tol.accept]:g}"
    )
    message = (
        f"not developable enough: {size} (accept = {tol.accept!r}); it reaches {reached or 'no class'!r}"
        + _remedy(strained, tol)
    )
    return Finding("not-developable", message, True, _where(surface, bent if by_warp else strained))


def _remedy(strained: Bound, tol: Tolerances) -> str:
    """Return what would do where sheet metal is asked for: a material that stretches, and with or without cuts."""
    if tol.accept == STRETCHED:
        return ""
    limit = STRAIN_LIMIT[STRETCHED]
    if strained.value <= limit:
        return f"; accept = {STRETCHED!r} takes it, strained by {strained.value:.3g} of {limit:g}"
    return f"; even accept = {STRETCHED!r} takes a strain of {limit:g} only: it needs `cuts`, which that finds"


def _doubt(surface: MeshSurface, studied: Studied, bent: Bound, strained: Bound, tol: Tolerances) -> Finding:
    """Return why no verdict is possible, and the best class that the mesh permits one for."""
    permits = _class(bent.largest, strained.largest)
    fit, noise = studied.fit, studied.flat.noise_mm
    known = np.isfinite(noise)
    cause = "noisy" if known and np.median(fit.coarser - NOISE * fit.residual) < 0.0 else "coarse"
    off = f"vertices lie {noise:.3g} mm off a smooth surface" if known else "too few vertices to fit a surface to"
    message = (
        f"the mesh is too {cause} for a verdict at accept = {tol.accept!r}: {off}; "
        f"equivalent warp {_range(bent.least * DEG, bent.largest * DEG, ' deg')}, "
        f"strain {_range(strained.least, strained.largest)}; "
        + (f"it permits accept = {permits!r}" if permits else "it permits none")
    )
    return Finding("inconclusive", message, True, _where(surface, bent))


def _range(least: float, largest: float, unit: str = "") -> str:
    """Return a range in words; one that nothing bounds is said by its least value alone."""
    if not np.isfinite(largest):
        return f"at least {least:.3g}{unit}"
    return f"between {least:.3g} and {largest:.3g}{unit}"


NOISE = 1.5
"""What fits of degree 3 and 4 leave is the same where it is noise; of a smooth surface the second leaves far less."""
