"""How large a formed part is along the axes of its description, in mm; sampled along its edges.

A ruled surface is linear along its rulings, so that it is largest between points of its edges: rails are sampled at
`SAMPLES` places in each patch, the outline of a trimmed face at those of its pictures.  A mesh is its vertices.
"""

from collections.abc import Iterator

import numpy as np

from stages.geometry.arrays import Points3
from stages.geometry.ruled.ruled import at
from stages.model.surface import BranchedSurface, MeshSurface, RuledSurface, Surface

Document = dict[str, object]
SAMPLES = 33
ENDS = (0.0, 1.0)


def formed_entry(surface: Surface) -> Document | None:
    """Return the size of a formed part; nothing of a plate, and where nothing was constructed."""
    found = list(_edges(surface))
    if not found:
        return None
    points = np.concatenate(found)
    size = np.ptp(points, axis=0).tolist()
    return {"size_mm": size, "evidence": "sampled"} if np.isfinite(points).all() else None


def _edges(surface: Surface) -> Iterator[Points3]:
    """Yield points among which are those that are furthest apart."""
    if isinstance(surface, MeshSurface):
        yield surface.mesh.vertices
    elif isinstance(surface, BranchedSurface):
        for face in surface.faces:
            yield from _edges(face)
    elif isinstance(surface, RuledSurface) and surface.trim is not None:
        from pipeline.report.pictures.branched import outline

        yield outline(surface)
    elif isinstance(surface, RuledSurface):
        v = np.linspace(0.0, 1.0, SAMPLES)
        for patch in surface.patches:
            for u in ENDS:
                yield at(patch, np.full(SAMPLES, u), v)
