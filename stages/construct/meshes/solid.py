"""One face of a sheet that a file holds with its thickness, as CAD programs export it: two skins and a rim.

    thin_solid(part, mesh, tol) -> Skin | None

The mesh is divided at its edges of `RIM_RAD` and more; the two largest pieces are the skins, the rest is the rim, which
must be small against them.  It is a sheet if one skin is recognised (plane, cylinder, cone, flanges and bends) and all
vertices of the other are at one distance from it, to the rounding of the file: the thickness.  The skin that is kept is
the plus face of the sheet, for its normal points away from the solid; `face = "inner"` keeps the smaller skin, else the
larger one is kept.  None where it is no such solid; not for sheets with sharp folds, whose skins come in pieces.
"""

from dataclasses import dataclass, replace
from math import radians

import msgspec
import numpy as np

from stages.construct.meshes.bends import laid_out
from stages.geometry.arrays import Array, Points3, cross3, dot, norm
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import distances, facets
from stages.geometry.mesh.profile import allowed_mm
from stages.geometry.mesh.recognise import recognised
from stages.geometry.mesh.topology import CORNERS, Edges, edges_of, linked, part_of
from stages.model.material import Part
from stages.model.report import Finding, Metric
from stages.model.tolerances import Tolerances

RIM_RAD = radians(45.0)
"""Between the facets of a bend, 31 deg at most, and the square edge of a sheet."""
RIM_SHARE = 0.5
"""Of both skins together: a square plate is no sheet if it is thicker than a quarter of its side."""
SKINS = 2
"""Of a sheet: inside and outside, each with an error of its own."""


@dataclass(frozen=True, slots=True)
class Skin:
    """One face of the sheet, the part that it makes, and what is told of it."""

    part: Part
    mesh: Mesh
    thickness_mm: float
    findings: tuple[Finding, ...]

    @property
    def metrics(self) -> tuple[Metric, ...]:
        """Return the thickness as a metric: sampled, for it is the mean over the vertices of one skin."""
        return (Metric("solid_thickness_mm", self.thickness_mm, "mm"),)


def thin_solid(part: Part, mesh: Mesh, tol: Tolerances) -> Skin | None:
    """Return one face of a sheet with its thickness; None where an oriented mesh is open, or no sheet."""
    edges = edges_of(mesh)
    if edges.border.size:
        return None
    if _volume(mesh) < 0.0:
        mesh = Mesh(mesh.vertices, mesh.faces[:, ::-1])
        edges = edges_of(mesh)
    skins = _skins(mesh, edges)
    if skins is None:
        return None
    kept, other = skins[::-1] if part.spec.face == "inner" else skins
    off = _distances(kept, other.vertices, tol)
    if off is None or float(np.ptp(off)) > SKINS * allowed_mm(mesh):
        return None
    thickness = abs(float(off.mean()))
    return Skin(_as_plus_face(part, thickness), kept, thickness, _findings(part, thickness, tol))


def _volume(mesh: Mesh) -> float:
    """Return the volume inside a closed mesh, mm3; negative where its outside is inside."""
    centre = mesh.vertices.mean(axis=0)
    centres, areas = facets(mesh)
    return float(dot(centres - centre, areas).sum()) / 6.0


def _skins(mesh: Mesh, edges: Edges) -> tuple[Mesh, Mesh] | None:
    """Return the two largest pieces between sharp edges, the larger first; None where the rest is no rim."""
    areas = facets(mesh)[1]
    one, other = (half // CORNERS for half in edges.pairs())
    turn = np.arctan2(norm(cross3(areas[one], areas[other])), dot(areas[one], areas[other]))
    smooth = turn < RIM_RAD
    count, label = linked(len(mesh.faces), one[smooth], other[smooth])
    size = np.bincount(label, weights=norm(areas), minlength=count)
    largest = np.argsort(-size, kind="stable")[:SKINS]
    if largest.size < SKINS or size.sum() - size[largest].sum() > RIM_SHARE * size[largest].sum():
        return None
    first, second = (part_of(mesh, np.flatnonzero(label == which)) for which in largest)
    return first, second


def _distances(skin: Mesh, points: Points3, tol: Tolerances) -> Array | None:
    """Return the signed distances of points from the surface that a skin is; None where it is none known."""
    found = recognised(skin, chord_mm=tol.chord_mm)
    if found is not None:
        return distances(found.primitive, points)
    laid = laid_out(skin, tol)
    return None if laid is None else laid.chain.distances((points - laid.origin) @ laid.frame[:2].T)


def _as_plus_face(part: Part, thickness_mm: float) -> Part:
    """Return the part with the face that is kept, and the thickness of the solid where its material has none."""
    known = part.material.thickness_mm is not None
    material = part.material if known else replace(part.material, thickness_mm=thickness_mm)
    return replace(part, spec=msgspec.structs.replace(part.spec, face="plus"), material=material)


def _findings(part: Part, thickness_mm: float, tol: Tolerances) -> tuple[Finding, ...]:
    """Tell what was taken for what; refuse a sheet that is not as thick as its material."""
    given = part.material.thickness_mm
    if given is not None and abs(given - thickness_mm) > tol.chord_mm:
        message = (
            f"the mesh is a sheet of {thickness_mm:.6g} mm, and its material is {given:g} mm thick: set `thickness` to "
            f"{thickness_mm:.6g} mm, or export the part with the thickness of the material"
        )
        return (Finding("solid-thickness", message, True, {"thickness_mm": thickness_mm}),)
    side = "smaller" if part.spec.face == "inner" else "larger"
    source = "as its material" if given is not None else "which is taken for that of its material"
    message = (
        f"the mesh is a sheet with its thickness, {thickness_mm:.6g} mm, {source}: its {side} face is kept and "
        'unrolled as the plus face, whatever `face` says; face = "inner" keeps the smaller one'
    )
    return (Finding("mesh-solid", message, False, {"thickness_mm": thickness_mm}),)
