"""What is wrong with a mesh that is to be a sheet: what was repaired, and what cannot be, with its place."""

from collections.abc import Iterator

import numpy as np

from stages.geometry.arrays import Indices
from stages.geometry.mesh.crossing import Crossings, crossings
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.repair import Repair, cracks
from stages.geometry.mesh.topology import Edges, pieces, pinched
from stages.model.report import Finding, Metric, Where

MANIFOLD = 2
"""Faces that may meet at an edge of a sheet."""


def repair_metrics(repair: Repair) -> list[Metric]:
    """Return how much was repaired."""
    counts = {
        "vertices_merged": repair.merged,
        "vertices_welded": repair.welded,
        "faces_dropped": repair.duplicates + repair.collapsed,
        "slivers_resolved": repair.flat,
        "vertices_unused": repair.unused,
    }
    return [Metric(name, float(count), "", "proved") for name, count in counts.items()]


def repair_findings(repair: Repair) -> Iterator[Finding]:
    """Yield what was repaired, and what was found and cannot be."""
    if repair.welded:
        message = f"{repair.welded} vertices on open edges were joined to others at most {repair.welded_mm:.3g} mm away"
        yield Finding("mesh-welded", message)
    if repair.duplicates:
        yield Finding("mesh-duplicates-dropped", f"{repair.duplicates} faces over the corners of others were dropped")
    if repair.collapsed + repair.flat:
        message = f"{repair.collapsed + repair.flat} faces of no area were dropped or joined to their neighbours"
        yield Finding("mesh-zero-area-dropped", message)
    if not len(repair.mesh.faces):
        yield Finding("mesh-empty", "no face of the mesh has an area", fatal=True)
    elif len(repair.slivers):
        where = place(repair.mesh, repair.mesh.faces[repair.slivers[0]])
        message = (
            f"{len(repair.slivers)} faces have no area and neighbours that cannot take them up, one at {text(where)}"
        )
        yield Finding("mesh-zero-area", f"{message}; mesh the surface again", True, where)


def place(mesh: Mesh, vertices: Indices) -> Where:
    """Return the middle of some vertices, mm."""
    x, y, z = (float(value) for value in mesh.vertices[vertices].mean(axis=0))
    return {"x": x, "y": y, "z": z}


def text(where: Where) -> str:
    """Return a place in words."""
    return f"({', '.join(format(where[axis], '.6g') for axis in 'xyz')}) mm"


def surface_findings(mesh: Mesh, edges: Edges, tolerance: float) -> Iterator[Finding]:
    """Yield where the mesh is no surface, or not in one piece."""
    branching = np.flatnonzero(edges.count > MANIFOLD)
    if len(branching):
        where = place(mesh, edges.ends[branching[0]])
        message = f"{len(branching)} edges have more than two faces, one at {text(where)}: no sheet branches"
        yield Finding("mesh-nonmanifold", f"{message}; give each sheet a file of its own", True, where)
        return
    touching = pinched(mesh, edges)
    if len(touching):
        where = place(mesh, touching[:1])
        message = f"the surface touches itself in {len(touching)} single vertices, one at {text(where)}"
        yield Finding("mesh-pinched", f"{message}; separate the corners there", True, where)
    count, _ = pieces(mesh, edges)
    if count > 1:
        yield Finding("mesh-pieces", f"the mesh is in {count} pieces", True, {"pieces": count})
    beside, _ = cracks(mesh, edges, tolerance)
    if len(beside):
        where = place(mesh, beside[:1])
        message = f"{len(np.unique(beside))} vertices lie on edges that do not end there, one at {text(where)}: cracks"
        yield Finding("mesh-cracks", f"{message}; export the surface as one body, or mesh it again", True, where)


def self_crossing(mesh: Mesh, tolerance: float) -> tuple[Metric, tuple[Finding, ...]]:
    """Return how many pairs of faces meet where they should not, and the folds and crossings that they are.

    Neighbours that lie on each other are folds.
    """
    found = crossings(mesh, tolerance)
    shared = (mesh.faces[found.faces][:, :, None] == mesh.faces[found.others][:, None, :]).sum(axis=(1, 2))
    sorts = (
        ("mesh-folded", "is folded back on itself", np.flatnonzero(shared >= MANIFOLD)),
        ("self-crossing", "passes through itself or lies on itself", np.flatnonzero(shared < MANIFOLD)),
    )
    findings = tuple(_crossing(mesh, found, which, code, what) for code, what, which in sorts if len(which))
    return Metric("crossing_faces", float(len(found.faces)), "", "sampled"), findings


def _crossing(mesh: Mesh, found: Crossings, which: Indices, code: str, what: str) -> Finding:
    first = int(which[0])
    one, other = (place(mesh, mesh.faces[side[first]]) for side in (found.faces, found.others))
    least = "" if found.complete else "at least "
    depth = float(found.depth_mm[first])
    message = (
        f"the surface {what} at {least}{len(which)} pairs of faces, {depth:.3g} mm deep where the face at {text(one)} "
        f"meets that at {text(other)}"
    )
    twice = {f"{axis}2": value for axis, value in other.items()}
    return Finding(code, message, True, {**one, **twice, "depth_mm": depth})
