"""Irregular triangle meshes of surfaces whose flat positions are known exactly, or which have none.

The parameter rectangle of `columns` x `rows` unit cells gets a point at every crossing; those inside are moved by
up to 0.42 of a cell, and Delaunay's triangles are taken.  Rulings run across the rows, so that nothing of the mesh
is aligned with them but its ends.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial import Delaunay

from stages.geometry.arrays import Array, Points2, Triples, Values
from stages.geometry.curves.curves import Circular
from stages.geometry.flat.development import develop
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.ruled.ruled import RuledPatch, between, warp
from tests.parts import QUINTIC_TANGENT, Table, patches
from tests.warped import saddle, shaken

COLUMNS, ROWS = 158, 32
"""Cells: 10 112 triangles."""
JITTER = 0.42


@dataclass(frozen=True, slots=True)
class Known:
    """A mesh and the exact flat positions of its vertices."""

    mesh: Mesh
    flat: Points2

    @property
    def size(self) -> float:
        """The diagonal of the bounding box."""
        return float(np.linalg.norm(np.ptp(self.mesh.vertices, axis=0)))


def jittered(seed: int, columns: int = COLUMNS, rows: int = ROWS) -> tuple[Array, Array, Triples]:
    """Return v in [0, 1] along the columns, u in [0, 1] along the rows, and the triangles."""
    source = np.random.default_rng(seed)
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij"))
    inside = (x > 0) & (x < columns) & (y > 0) & (y < rows)
    moves = source.uniform(-JITTER, JITTER, (2, len(x)))
    x, y = x + inside * moves[0], y + inside * moves[1]
    faces = Delaunay(np.column_stack([x, y])).simplices.astype(np.int64)
    a, b, c = (np.column_stack([x, y])[faces[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    faces = faces[np.abs(area) > 1e-9]
    return x / columns, y / rows, np.where(area[np.abs(area) > 1e-9, None] < 0, faces[:, ::-1], faces)


def right_cone(seed: int, columns: int = COLUMNS, rows: int = ROWS, scale: float = 100.0) -> Known:
    """A sector of 3 rad in the flat, slant heights from 1 to 2, of a cone of which a full turn is 4.4 rad."""
    v, u, faces = jittered(seed, columns, rows)
    sine, phi, slant = 0.7, 3.0 * v, 2.0 - u
    turn = phi / sine
    x = sine * slant * np.cos(turn), sine * slant * np.sin(turn), np.sqrt(1.0 - sine**2) * slant
    flat = np.column_stack([slant * np.cos(phi), slant * np.sin(phi)])
    return Known(Mesh(scale * np.column_stack(x), faces), scale * flat)


def cylinder(seed: int, columns: int = COLUMNS, rows: int = ROWS, scale: float = 100.0) -> Known:
    """2.5 rad of a cylinder of radius 1 and half as long."""
    v, u, faces = jittered(seed, columns, rows)
    x = np.cos(2.5 * v), np.sin(2.5 * v), 0.5 * u
    return Known(Mesh(scale * np.column_stack(x), faces), scale * np.column_stack([-2.5 * v, 0.5 * u]))


def sheet(patch: RuledPatch, seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Mesh:
    """Return the mesh of any ruled patch."""
    v, u, faces = jittered(seed, columns, rows)
    c0, p = patch.c0.jet(v, 0)[0], patch.p.jet(v, 0)[0]
    return Mesh(c0 + u[:, None] * p, faces)


def ruled(patch: RuledPatch, seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Known:
    """Return the mesh of a developable patch with its exact development."""
    v, u, _ = jittered(seed, columns, rows)
    (piece,) = develop((patch,)).pieces
    return Known(sheet(patch, seed, columns, rows), piece.positions(u, v))


OBLIQUE_CONE: Table = {
    "kind": "cone", "apex": [2, 1, 6], "fraction": [0, 0.5],
    "directrix": {"bezier": [[0, 0, 0], [1, 1.5, 0.3], [2, -1.5, 0], [3, 2, -0.2], [4, 0.5, 0.3], [5, 0, 0]]},
}  # fmt: skip
"""Over a quintic with two inflections, towards an apex well off its middle."""
ROUND_CONE: Table = {
    "kind": "cone", "apex": [0.5, -2, 3], "fraction": [0, 0.6],
    "directrix": {"bezier": [[3, 0, 0], [3, 2.5, 0], [0, 3.5, 0.5], [-3, 2, 0], [-3, -1, 0.5], [0, -2.5, 0]]},
}  # fmt: skip
"""Over a quintic that runs once around, the apex outside."""
STRAP: Table = {
    "kind": "strap", "half_width": 0.3, "centre": {"bezier": [[0, 0, 0], [1, 0, 0], [2, 1, 0], [3, 3, 1]]},
}  # fmt: skip
"""The rectifying developable of a twisted cubic: a straight strip in the flat."""


def oblique_cone(seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Known:
    return ruled(patches(OBLIQUE_CONE)[0], seed, columns, rows)


def round_cone(seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Known:
    return ruled(patches(ROUND_CONE)[0], seed, columns, rows)


def tangent_surface(seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Known:
    return ruled(patches(QUINTIC_TANGENT)[0], seed, columns, rows)


def strap(seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Known:
    return ruled(patches(STRAP)[0], seed, columns, rows)


KNOWN = {
    "cylinder": cylinder, "right cone": right_cone, "oblique cone": oblique_cone, "round cone": round_cone,
    "tangent surface": tangent_surface, "strap": strap,
}  # fmt: skip
"""Developables with exact flat positions."""


TABLES = {"oblique cone": OBLIQUE_CONE, "round cone": ROUND_CONE, "tangent surface": QUINTIC_TANGENT, "strap": STRAP}
"""Those of them that the job file can state."""


def patch_of(name: str) -> RuledPatch:
    """Return one of these developables as a ruled patch of size 1 or so."""
    if name in TABLES:
        return patches(TABLES[name])[0]
    x, y, z = np.eye(3)
    (low, high), turn, rise = {"cylinder": ((1.0, 1.0), 2.5, 0.5), "right cone": ((1.4, 0.7), 3.0 / 0.7, 0.7)}[name]
    lower = Circular(np.zeros(3), low * x, low * y, 0.0 * z, 0.0, turn)
    return between(lower, Circular(rise * z, high * x, high * y, 0.0 * z, 0.0, turn))


def throughout(v: Values) -> Values:
    """Warp all over."""
    return np.ones_like(v)


def in_a_quarter(v: Values) -> Values:
    """Warp in the second quarter alone, fading out with two derivatives; the rest is developable."""
    return np.asarray(np.clip(1.0 - ((v - 0.375) / 0.125) ** 2, 0.0, None) ** 3)


def twisted(name: str, warp_deg: float, seed: int, share: Callable[[Values], Values] = throughout) -> Mesh:
    """A developable twisted along its rulings, so that the normal turns by `warp_deg` times `share` along each.

    p' = a c0' + b p on the developable; with t (1 + a) c0' x p / |p| added, t the tangent of the warp, N1 = c1' x p is
    turned out of N0 = c0' x p by just that angle.
    """
    patch, (v, u, faces) = patch_of(name), jittered(seed)

    def slope(at: float, p: Array) -> Array:
        place = np.array([at])
        (_, (tangent,)), ((p0,), (p1,)) = patch.c0.jet(place, 1), patch.p.jet(place, 1)
        (a, b), *_ = np.linalg.lstsq(np.column_stack([tangent, p0]), p1, rcond=None)
        turn = np.tan(np.radians(warp_deg * share(place)[0]))
        return np.asarray(a * tangent + b * p + turn * (1.0 + a) * np.cross(tangent, p) / np.linalg.norm(p))

    start = patch.p.jet(np.zeros(1), 0)[0, 0]
    found = solve_ivp(slope, (0.0, 1.0), start, method="DOP853", rtol=1e-13, atol=1e-14, max_step=1.0 / 64.0,
                      t_eval=np.unique(v))  # fmt: skip
    p = found.y.T[np.searchsorted(found.t, v)]
    return Mesh(patch.c0.jet(v, 0)[0] + u[:, None] * p, faces)


def square_saddle(warp_deg: float, seed: int, cells: int = 71) -> Mesh:
    """The hyperbolic paraboloid over a square whose normal turns so far along every middle ruling."""
    return sheet(saddle(warp_deg)[0], seed, cells, cells)


def warped(table: Table, warp_deg: float, seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Mesh:
    """A developable whose second directrix is moved until the largest warp is that: the warp is nearly linear in it."""
    v, amount = np.linspace(0.0, 1.0, 201), 1e-4
    for _ in range(8):
        (patch,) = shaken(patches(table), amount, seed)
        amount *= warp_deg / float(np.degrees(warp(patch, v).max()))
    return sheet(patch, seed, columns, rows)


def hemisphere(seed: int, columns: int = 71) -> Mesh:
    """Half a sphere: the square mapped to the disc by squeezing its diagonals, and up."""
    x, y, faces = jittered(seed, columns, columns)
    a, b = 2.0 * x - 1.0, 2.0 * y - 1.0
    p, q = a * np.sqrt(1.0 - b * b / 2.0), b * np.sqrt(1.0 - a * a / 2.0)
    far = np.minimum(np.hypot(p, q), 1.0)
    polar = far * np.pi / 2.0
    share = np.sin(polar) / np.where(far > 0.0, far, 1.0)
    return Mesh(np.column_stack([p * share, q * share, np.cos(polar)]), faces)


def noisy(mesh: Mesh, amount: float, seed: int = 5) -> Mesh:
    """The mesh with normal noise of that share of its size in all coordinates."""
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    return Mesh(mesh.vertices + np.random.default_rng(seed).normal(0.0, amount * size, mesh.vertices.shape), mesh.faces)


def single_precision(mesh: Mesh) -> Mesh:
    """The mesh as a binary STL file keeps it."""
    return Mesh(mesh.vertices.astype(np.float32).astype(np.float64), mesh.faces)


def with_hole(mesh: Mesh, centre: int, radius: float) -> Mesh:
    """The mesh without the triangles near a vertex, and without the vertices that none uses any more."""
    away = np.linalg.norm(mesh.vertices[mesh.faces].mean(axis=1) - mesh.vertices[centre], axis=1)
    used, faces = np.unique(mesh.faces[away > radius], return_inverse=True)
    return Mesh(mesh.vertices[used], faces.reshape(-1, 3).astype(np.int64))


def misplaced(flat: Points2, exact: Points2) -> float:
    """The largest distance of a vertex from its exact place, after the best rigid motion."""
    a, b = flat - flat.mean(axis=0), exact - exact.mean(axis=0)
    u, _, v = np.linalg.svd(a.T @ b)
    turn: Array = u @ v
    return float(np.linalg.norm(a @ turn - b, axis=1).max())
