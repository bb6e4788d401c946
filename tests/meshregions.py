"""Irregular meshes of plane regions with holes, lifted onto surfaces isometric to the plane: areas are known."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from stages.geometry.arrays import Array, Numbers, Points2, Points3
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of

Lift = Callable[[Points2], Points3]
JITTER = 0.35
SLIVER = 1e-9


def ring(x: float, y: float, radius: float, count: int) -> Points2:
    """Return points round a circle, counter-clockwise."""
    t = 2.0 * np.pi * np.arange(count) / count
    return np.array([x, y]) + radius * np.column_stack([np.cos(t), np.sin(t)])


def polygon(corners: Sequence[Sequence[float]], step: float) -> Points2:
    """Return points round a polygon, no farther apart than a step."""
    sides = [np.array(corners, dtype=float), np.roll(np.array(corners, dtype=float), -1, axis=0)]
    made = []
    for a, b in zip(*sides, strict=True):
        count = max(int(np.ceil(float(np.hypot(*(b - a))) / step)), 1)
        made.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.vstack(made)


def region(outer: Points2, holes: Sequence[Points2], step: float, lift: Lift, seed: int = 0) -> Mesh:
    """Return the mesh of a region, seen counter-clockwise in the plane, with jittered points inside."""
    area = shapely.Polygon(outer, list(holes))
    low, high = outer.min(axis=0), outer.max(axis=0)
    x, y = (axis.ravel() for axis in np.meshgrid(*(np.arange(a, b, step) for a, b in zip(low, high, strict=True))))
    grid = np.column_stack([x, y])
    grid = grid + np.random.default_rng(seed).uniform(-JITTER * step, JITTER * step, grid.shape)
    points = np.vstack([outer, *holes, grid[shapely.contains_xy(area.buffer(-step / 2.0), grid)]])
    faces = Delaunay(points).simplices.astype(np.int64)
    faces = faces[shapely.contains_xy(area, points[faces].mean(axis=1))]
    a, b, c = (points[faces[:, k]] for k in range(3))
    twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    faces, twice = faces[np.abs(twice) > SLIVER * step**2], twice[np.abs(twice) > SLIVER * step**2]
    return Mesh(lift(points), np.where(twice[:, None] < 0.0, faces[:, ::-1], faces))


def on_plane(p: Points2) -> Points3:
    """Lay a region into the plane z = 0."""
    return np.column_stack([p, np.zeros(len(p))])


@dataclass(frozen=True)
class OnCylinder:
    """Roll a region onto a cylinder about z, y along the rulings."""

    radius: float

    def __call__(self, p: Points2) -> Points3:
        """Return the points in space."""
        turn = p[:, 0] / self.radius
        return np.column_stack([self.radius * np.cos(turn), self.radius * np.sin(turn), p[:, 1]])


@dataclass(frozen=True)
class OnCone:
    """Roll a region about the origin onto a cone about z with its apex there."""

    half_angle: float

    def __call__(self, p: Points2) -> Points3:
        """Return the points in space."""
        sine, cosine = np.sin(self.half_angle), np.cos(self.half_angle)
        slant, turn = np.hypot(*p.T), np.arctan2(p[:, 1], p[:, 0]) / sine
        return np.column_stack([slant * sine * np.cos(turn), slant * sine * np.sin(turn), slant * cosine])


def moved(mesh: Mesh, seed: int = 1) -> Mesh:
    """Return the mesh turned anyhow and moved away from the origin."""
    turn: Array = Rotation.random(random_state=seed).as_matrix()
    return Mesh(mesh.vertices @ turn.T + np.array([1000.0, -500.0, 20.0]), mesh.faces)


def flipped(mesh: Mesh) -> Mesh:
    """Return the mesh with its outside inside."""
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


def in_float32(mesh: Mesh) -> Mesh:
    """Return the mesh as a binary STL file keeps it."""
    return Mesh(mesh.vertices.astype(np.float32).astype(np.float64), mesh.faces)


def loops_of(mesh: Mesh) -> tuple[Numbers, ...]:
    """Return the boundary loops, the widest first."""
    loops = boundary_loops(mesh, edges_of(mesh))
    return tuple(sorted(loops, key=lambda loop: -float(np.ptp(mesh.vertices[loop], axis=0).max())))
