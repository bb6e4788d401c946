"""What is sewn: the lines along which a mesh is slit so that it lies flatter, and those whose lengths are kept.

Lines of points near the mesh become ways along its edges.  A cut (a dart, when the part is sewn) begins on the boundary
and ends inside; its sides are as long as each other in the pattern, edge by edge.  Cuts that meet, that run from
boundary to boundary or that begin inside are refused: they would part the sheet, or open nothing.
"""

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from stages.construct.meshes.faults import place, text
from stages.errors import NoSolutionError
from stages.geometry.arrays import Numbers, Points3, floats, norm
from stages.geometry.mesh.cut import along, edge_lengths
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.slit import followed, slit
from stages.geometry.mesh.topology import Edges, boundary_loops, edges_of, on_border
from stages.model.meshes import MeshFile
from stages.model.report import Finding, Metric, Where
from stages.model.scalars import Point
from stages.model.surface import MeshSurface

OFF = 3.0
"""Longest edges that a line's points may be off the mesh; farther, another mesh or unit was meant."""


@dataclass(frozen=True, slots=True)
class Sewn:
    """A mesh with its cuts and kept lengths, and what was found out on the way."""

    surface: MeshSurface
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()


def sewn(surface: MeshSurface, spec: MeshFile) -> Sewn:
    """Return a disc with the cuts and kept lengths that its specification asks for."""
    opened = _slit(surface, spec.cuts) if spec.cuts else Sewn(surface)
    if spec.keep == "none" or opened.findings:
        return opened
    kept = _kept(opened.surface, spec)
    return Sewn(kept.surface, (*opened.metrics, *kept.metrics), kept.findings)


def off_mesh(mesh: Mesh, edges: Edges, points: Points3, key: str, code: str) -> tuple[float, list[Finding]]:
    """Return the largest distance of a point from the nearest vertex, mm, and a finding if that is too far."""
    near = np.array([float(norm(mesh.vertices - point).min()) for point in points])
    worst = int(np.argmax(near))
    far, allowed = float(near[worst]), OFF * float(edge_lengths(mesh, edges).max())
    if far <= allowed:
        return far, []
    message = f"{key}[{worst}] is {far:.4g} mm from the nearest vertex, allowed {allowed:.4g} mm"
    where: Where = dict(zip("xyz", map(float, points[worst]), strict=True))
    return far, [Finding(code, message, True, where)]


def _points(line: tuple[Point, ...]) -> Points3:
    return np.stack([floats(point) for point in line])


def _slit(surface: MeshSurface, cuts: tuple[tuple[Point, ...], ...]) -> Sewn:
    """Return the mesh slit along lines, or the reasons why it cannot be."""
    mesh, edges = surface.mesh, edges_of(surface.mesh)
    ways: list[Numbers] = []
    findings: list[Finding] = []
    for i, line in enumerate(cuts):
        found = _way(surface, edges, _points(line), f"cuts[{i}]")
        findings += [found] if isinstance(found, Finding) else []
        ways += [] if isinstance(found, Finding) else [found]
    findings = findings or _meetings(mesh, ways)
    if findings:
        return Sewn(surface, findings=tuple(findings))
    made = slit(mesh, edges, tuple(ways))
    loops = boundary_loops(made.mesh, edges_of(made.mesh))
    outer = next(i for i, loop in enumerate(loops) if np.isin(surface.loops[0], loop).any())
    rest = [i for i in range(len(loops)) if i != outer]
    metrics = (
        Metric("cuts", float(len(ways)), "", "proved"),
        Metric("cut_length_mm", sum(float(norm(np.diff(mesh.vertices[way], axis=0)).sum()) for way in ways), "mm"),
    )
    changed = replace(surface, mesh=made.mesh, loops=tuple(loops[i] for i in (outer, *rest)), slits=made.sides)
    return Sewn(changed, metrics)


def _way(surface: MeshSurface, edges: Edges, line: Points3, key: str) -> Numbers | Finding:
    """Return the vertices along a cut, from the boundary to where it ends, or why there is no such cut."""
    mesh = surface.mesh
    _, off = off_mesh(mesh, edges, line, key, "mesh-cut")
    if off:
        return off[0]
    try:
        way = along(mesh, edges, line, ())
    except NoSolutionError as error:
        return Finding("mesh-cut", f"{key}: the mesh cannot be slit along its edges there ({error})", True)
    border = on_border(mesh, edges)
    way = way if border[way[0]] else way[::-1]
    where = place(mesh, way[:1])
    if not border[way[0]]:
        message = f"{key} begins inside, at {text(where)}: a cut opens the part only from its boundary inwards"
        return Finding("mesh-cut", message, True, where)
    if border[way[-1]]:
        message = f"{key} runs from boundary to boundary, from {text(where)}: it would part the sheet or open a hole"
        return Finding("mesh-cut", f"{message}; let it end inside, or give two meshes", True, where)
    if np.isin(
        way[0], np.concatenate([np.zeros(0, dtype=np.int64), *(side for pair in surface.seams for side in pair)])
    ):
        return Finding("mesh-cut", f"{key} begins on the seam at {text(where)}: begin elsewhere", True, where)
    return way


def _meetings(mesh: Mesh, ways: list[Numbers]) -> list[Finding]:
    """Return a finding for each two cuts that have a vertex in common."""
    found = []
    for (i, one), (j, other) in combinations(enumerate(ways), 2):
        common = np.intersect1d(one, other)
        if len(common):
            where = place(mesh, common[:1])
            message = f"cuts[{i}] and cuts[{j}] meet at {text(where)}: end one of them before the other"
            found.append(Finding("mesh-cuts-meet", message, True, where))
    return found


def _kept(surface: MeshSurface, spec: MeshFile) -> Sewn:
    """Return the mesh with the edges whose lengths are kept."""
    mesh, edges = surface.mesh, edges_of(surface.mesh)
    if spec.keep == "outline":
        return _with_kept(surface, [np.append(surface.loops[0], surface.loops[0][:1])])
    ways, findings = [], []
    for i, line in enumerate(spec.kept_lines):
        points = _points(line)
        _, off = off_mesh(mesh, edges, points, f"keep[{i}]", "mesh-keep")
        findings += off
        if not off:
            ways.append(followed(mesh, edges, points))
        if not off and len(ways[-1]) < len("ab"):
            message = f"keep[{i}] is shorter than an edge of the mesh: give a longer line, or a finer mesh"
            findings.append(Finding("mesh-keep", message, True))
    return Sewn(surface, findings=tuple(findings)) if findings else _with_kept(surface, ways)


def _with_kept(surface: MeshSurface, ways: list[Numbers]) -> Sewn:
    """Return the mesh with the edges along ways kept, but for those of cuts, which are as long as their other sides."""
    sides = [side for pair in surface.slits for side in pair]
    pairs = _pairs(ways)
    pairs = pairs[~np.isin(_keys(pairs), _keys(_pairs(sides)))]
    vertices = len(np.unique(pairs))
    if len(pairs) > 2 * vertices - RIGID:
        message = f"{len(pairs)} lengths between {vertices} vertices: more than a plane figure has; keep fewer of them"
        return Sewn(surface, findings=(Finding("mesh-keep", message, True),))
    length = float(norm(surface.mesh.vertices[pairs[:, 1]] - surface.mesh.vertices[pairs[:, 0]]).sum())
    return Sewn(replace(surface, kept=pairs), (Metric("kept_mm", length, "mm"),))


RIGID = 3
"""Motions of a figure in the plane: 2 n - 3 lengths fix n points."""


def _pairs(ways: list[Numbers]) -> Numbers:
    """Return the edges along ways, each once, the lower number first, shape (k, 2)."""
    none = np.zeros((0, 2), dtype=np.int64)
    every = np.concatenate([none, *(np.stack([way[:-1], way[1:]], axis=1) for way in ways)])
    return np.asarray(np.unique(np.sort(every, axis=1), axis=0))


def _keys(pairs: Numbers) -> Numbers:
    """Return a number for each edge."""
    low, high = pairs.T
    return np.asarray(low * KEY + high)


KEY = 2**31
"""More than any mesh has vertices."""
