"""The neutral surface of a part that is a mesh: what keeps its lengths when the sheet is bent, and so what is unrolled.

    mesh_neutral(surface, flat) -> NeutralMesh

By the rule of ruled parts (`stages.unroll.thickness`): it lies K t from the inside face, one K for the whole part, that
of its smallest inside radius.  The mesh is moved there along its fitted normals (`geometry.mesh.bending`), fitted
again and laid flat anew; where it need not be moved, the map that `verify` judged is kept.

A mesh that bends both ways has its neutral surface on both sides of the middle unless K is 1/2.  It is not divided at
its inflections, as ruled parts are: the middle is unrolled, and what that neglects is said.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from stages.geometry.mesh.bending import bends_of, parallel
from stages.geometry.mesh.bends import MeshBends, SharpVertex
from stages.geometry.mesh.fit import fitted, stars
from stages.geometry.mesh.flat import AT_REST, at_rest, edge_lengths
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.meshmap import MeshMap
from stages.geometry.mesh.topology import edges_of
from stages.model.kfactor import MIDDLE, k_at
from stages.model.report import Evidence, Finding, Metric
from stages.model.sheetface import LITTLE, Layers, mesh_layers
from stages.model.surface import MeshSurface


@dataclass(frozen=True, slots=True)
class NeutralMesh:
    """The neutral surface, its map into the plane, and what was found on the way."""

    surface: MeshSurface
    flat: MeshMap
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    detail: dict[str, object] = field(default_factory=dict)


def mesh_neutral(surface: MeshSurface, flat: MeshMap) -> NeutralMesh:
    """Return the neutral surface of a mesh laid flat; the mesh itself where no thickness is known, or it is the middle.

    A fatal finding says that the face does not exist on this mesh, or that the sheet is too thick for its bends.
    Raises NoSolutionError where the moved mesh does not come to rest.
    """
    material, face = surface.part.material, surface.part.spec.face
    thickness, law = material.thickness_mm, material.k_factor
    if thickness is None or (face == "middle" and law.rule == MIDDLE):
        return NeutralMesh(surface, flat)
    edges = edges_of(surface.mesh)
    fit = fitted(surface.mesh, stars(surface.mesh, edges))
    bends = bends_of(surface.mesh, edges, fit)
    sheet = mesh_layers(face, bends, thickness)
    if isinstance(sheet, Finding):
        return NeutralMesh(surface, flat, findings=(sheet,))
    least = min((1.0 / sharp.curvature - sign * sheet.inside_mm(sign) for sign, sharp in bends.ways), default=np.inf)
    k = float(k_at(law.rule, np.array([max(least, 0.0) / thickness]))[0])
    distance, neglected = _distance(bends, sheet, k)
    refused = (*_tied(surface, distance), *_past_centre(bends, distance, thickness, k))
    found = NeutralMesh(
        surface,
        flat,
        _metrics(surface, distance, k),
        (*refused, *neglected),
        {"thickness": _detail(surface, sheet, k, least)},
    )
    return found if refused or distance == 0.0 else _moved(found, parallel(surface.mesh, edges, fit, distance))


def _distance(bends: MeshBends, sheet: Layers, k: float) -> tuple[float, tuple[Finding, ...]]:
    """Return how far along its normals the mesh is moved, mm, and what that neglects."""
    if not bends.ways:
        return 0.0, ()
    towards, away = bends.turned
    if k == MIDDLE or min(towards, away) <= LITTLE * (towards + away):
        return sheet.neutral_mm(1.0 if towards >= away else -1.0, k), ()
    sharpest = max((sharp for _, sharp in bends.ways), key=lambda sharp: sharp.curvature)
    share = (MIDDLE - k) * sheet.thickness_mm * sharpest.curvature
    message = (
        f"the mesh bends both ways, so its neutral surface (K = {k:.4g}) changes sides of the middle, which is "
        f"unrolled: lengths across the sharpest bend come out {share:.3%} too long"
    )
    return sheet.middle_mm, (Finding("k-neglected", message, where=_where(sharpest)),)


def _where(sharp: SharpVertex) -> dict[str, float | int | str]:
    return {"vertex": sharp.vertex, **dict(zip("xyz", sharp.place, strict=True))}


def _tied(surface: MeshSurface, distance: float) -> tuple[Finding, ...]:
    """Refuse to move a mesh whose edges keep their lengths: those of the given surface are kept, of no other."""
    if distance == 0.0 or not (len(surface.kept) or surface.slits):
        return ()
    message = (
        "edges that keep their lengths are those of the mesh as given, and the neutral surface lies "
        f"{abs(distance):.4g} mm off it: give a mesh of the middle, and K = 0.5"
    )
    return (Finding("mesh-face", message, fatal=True),)


def _past_centre(bends: MeshBends, distance: float, thickness: float, k: float) -> tuple[Finding, ...]:
    """Refuse a neutral surface beyond the centre of a bend: the sheet is too thick for it."""
    for sign, sharp in bends.ways:
        if sign * distance * sharp.curvature >= 1.0:
            message = (
                f"the mesh bends to a radius of {1.0 / sharp.curvature:.4g} mm, and the neutral surface lies "
                f"{sign * distance:.4g} mm towards its centre (thickness {thickness:g} mm, K = {k:.4g})"
            )
            return (Finding("offset-past-edge", message, True, _where(sharp)),)
    return ()


def _moved(found: NeutralMesh, mesh: Mesh) -> NeutralMesh:
    """Return the moved mesh, laid flat."""
    edges = edges_of(mesh)
    fit = fitted(mesh, stars(mesh, edges))
    lengths, kind = edge_lengths(mesh, edges, fit)
    still, noise = AT_REST * found.surface.size_mm, found.flat.noise_mm
    flat = at_rest(mesh, edges, lengths, kind=kind, noise_mm=noise, accuracy=still)
    return replace(found, surface=replace(found.surface, mesh=mesh), flat=flat)


def _metrics(surface: MeshSurface, distance: float, k: float) -> tuple[Metric, ...]:
    evidence: Evidence = "proved" if isinstance(surface.part.material.k_factor.rule, float) else "sampled"
    return (Metric("k_factor", k, "", evidence), Metric("neutral_offset_mm", distance, "mm", evidence))


def _detail(surface: MeshSurface, sheet: Layers, k: float, least: float) -> dict[str, object]:
    return {
        "face": surface.part.spec.face,
        "thickness_mm": sheet.thickness_mm,
        "convention": surface.part.material.k_factor.convention,
        "k_factor": k,
        "smallest_inside_radius_mm": float(least) if np.isfinite(least) else None,
    }
