"""Irregular meshes that close on themselves or have holes, and ways to spoil a mesh."""

from collections.abc import Callable

import numpy as np
from scipy.spatial import Delaunay

from stages.geometry.arrays import Array, Indices, Points2, Points3, Triples
from stages.geometry.mesh.mesh import Mesh

Shape = Callable[[Points2], Points3]


def flat(p: Points2) -> Points3:
    return np.column_stack([p, np.zeros(len(p))])


def rolled(p: Points2) -> Points3:
    """Return points of a cylinder of radius 1 without stretching the plane."""
    return np.column_stack([np.sin(1.2 * p[:, 0]) / 1.2, np.cos(1.2 * p[:, 0]) / 1.2, p[:, 1]])


def dome(p: Points2) -> Points3:
    """Return points of the unit sphere, as far from the pole as from the origin of the plane."""
    far, turn = np.hypot(*p.T), np.arctan2(p[:, 1], p[:, 0])
    return np.column_stack([np.sin(far) * np.cos(turn), np.sin(far) * np.sin(turn), np.cos(far)])


def triangles(p: Points2) -> Triples:
    """Return Delaunay's triangles, counter-clockwise, without those of no area."""
    faces = Delaunay(p).simplices.astype(np.int64)
    a, b, c = (p[faces[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    kept = np.abs(area) > 1e-9
    turned: Triples = np.where(area[kept, None] < 0, faces[kept][:, ::-1], faces[kept])
    return turned


def tube(
    around: int, along: int, radii: tuple[float, float], height: float, *, seed: int = 0, oblique: float = 0.0
) -> Mesh:
    """Return a jittered mesh of a cylinder or cone; oblique: by how much of the height one side is longer."""
    source = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(around), np.arange(along + 1.0), indexing="ij")
    inside = (y > 0) & (y < along)
    x = (x + inside * source.uniform(-0.35, 0.35, x.shape)).ravel()
    y = (y + inside * source.uniform(-0.35, 0.35, y.shape)).ravel()
    plane = np.column_stack([np.concatenate([x - around, x, x + around]), np.tile(y, 3)])
    faces = triangles(plane)
    middle = plane[faces, 0].mean(axis=1)
    faces = faces[(middle >= 0.0) & (middle < around)] % len(x)
    turn, share = 2.0 * np.pi * x / around, y / along
    radius = radii[0] + (radii[1] - radii[0]) * share
    z = height * share * (1.0 + oblique * np.cos(turn))
    return Mesh(np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z]), faces)


def holed(count: int, holes: list[tuple[float, float, float]], shape: Shape, seed: int = 0) -> Mesh:
    """Return a jittered mesh over the square from -1 to 1 with round holes (x, y, radius)."""
    source = np.random.default_rng(seed)
    step = 2.0 / (count - 1)
    x, y = np.meshgrid(np.linspace(-1, 1, count), np.linspace(-1, 1, count), indexing="ij")
    p = np.column_stack([x.ravel(), y.ravel()])
    p += (np.abs(p) < 0.999).all(axis=1)[:, None] * source.uniform(-0.35 * step, 0.35 * step, p.shape)
    rims = []
    for cx, cy, radius in holes:
        p = p[np.hypot(*(p - (cx, cy)).T) > radius + 0.4 * step]
        turn = np.arange(q := max(12, int(2 * np.pi * radius / step))) * 2.0 * np.pi / q
        rims.append(np.array([cx, cy]) + radius * np.column_stack([np.cos(turn), np.sin(turn)]))
    p = np.concatenate([p, *rims])
    faces = triangles(p)
    for cx, cy, radius in holes:
        middle = p[faces].mean(axis=1)
        within = np.hypot(*(p[faces] - (cx, cy)).transpose(2, 0, 1)).max(axis=1) <= radius * (1 + 1e-9)
        faces = faces[~within & (np.hypot(*(middle - (cx, cy)).T) > 0)]
    used, numbers = np.unique(faces, return_inverse=True)
    return Mesh(shape(p[used]), numbers.reshape(-1, 3).astype(np.int64))


def moebius(around: int = 24) -> Mesh:
    """Return a strip that is joined after half a turn."""
    turn = 2.0 * np.pi * np.arange(around) / around
    rims = [
        np.column_stack(
            [(3 + w * np.cos(turn / 2)) * np.cos(turn), (3 + w * np.cos(turn / 2)) * np.sin(turn), w * np.sin(turn / 2)]
        )
        for w in (-1.0, 1.0)
    ]
    faces = []
    for i in range(around):
        a, b = i, around + i
        c, d = (i + 1, around + i + 1) if i + 1 < around else (around, 0)
        faces += [(a, c, b), (b, c, d)]
    return Mesh(np.concatenate(rims), np.array(faces))


def soup(mesh: Mesh, *, single: bool = True) -> Mesh:
    """Return the triangles with corners of their own, in float32 as an STL keeps them."""
    points = mesh.vertices[mesh.faces.reshape(-1)]
    if single:
        points = points.astype(np.float32).astype(np.float64)
    return Mesh(points, np.arange(len(points)).reshape(-1, 3))


def shuffled(mesh: Mesh, seed: int = 0) -> Mesh:
    """Return the mesh with vertices, faces, and the corners of each face in another order."""
    source = np.random.default_rng(seed)
    place = source.permutation(len(mesh.vertices))
    vertices = np.zeros_like(mesh.vertices)
    vertices[place] = mesh.vertices
    faces = place[mesh.faces][source.permutation(len(mesh.faces))]
    starts = source.integers(0, 3, len(faces))
    return Mesh(vertices, faces[np.arange(len(faces))[:, None], (starts[:, None] + np.arange(3)) % 3])


def turned_over(mesh: Mesh, faces: Indices) -> Mesh:
    """Return the mesh with some faces run the other way."""
    changed = mesh.faces.copy()
    changed[faces] = changed[faces][:, ::-1]
    return Mesh(mesh.vertices, changed)


def together(*meshes: Mesh) -> Mesh:
    """Return several meshes as one, their vertices apart."""
    shifts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + shift for mesh, shift in zip(meshes, shifts[:-1], strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def moved(mesh: Mesh, matrix: Array, shift: Array) -> Mesh:
    return Mesh(mesh.vertices @ matrix.T + shift, mesh.faces)


def rotation(seed: int) -> Array:
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turned: Array = q * np.sign(np.linalg.det(q))
    return turned
