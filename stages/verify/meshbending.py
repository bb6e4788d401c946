"""The sharpest bend of a part that is a mesh, held against what the material allows: as `bending` does for ruled parts.

By the curvatures of the surface fitted to the vertices (`geometry.mesh.bending`), where the sheet lies about the
mesh as the job's face says (`stages.model.sheetface`).  Sampled at the vertices: noise and creases sharpen it.
"""

from stages.geometry.mesh.bending import bends_of
from stages.geometry.mesh.bends import MeshBends
from stages.model.report import Finding, Metric, Where
from stages.model.sheetface import Layers, mesh_layers
from stages.model.surface import MeshSurface
from stages.verify.bending import Sharpest, judged_bend, nowhere
from stages.verify.meshbounds import Studied

Bending = tuple[tuple[Metric, Metric], list[Finding]]


def mesh_bending(surface: MeshSurface, studied: Studied) -> Bending:
    """Return the smallest inside radius in mm, the largest strain of the outer fibre, and what the material says."""
    bends = bends_of(studied.mesh, studied.edges, studied.fit)
    material = surface.part.material
    sheet = mesh_layers(surface.part.spec.face, bends, material.thickness_mm or 0.0)
    if isinstance(sheet, Finding):
        return nowhere("sampled"), [sheet]
    found = _sharpest(bends, sheet)
    return judged_bend(found, material) if found is not None else (nowhere("sampled"), [])


def _sharpest(bends: MeshBends, sheet: Layers) -> Sharpest | None:
    every = []
    for sign, sharp in bends.ways:
        radius = 1.0 / sharp.curvature
        where: Where = {"vertex": sharp.vertex, **dict(zip("xyz", sharp.place, strict=True))}
        every.append(Sharpest.at(radius, radius - sign * sheet.middle_mm, radius - sign * sheet.inside_mm(sign), where))
    return min(every, key=lambda bend: bend.inside_mm, default=None)
