"""Makes the meshes of this sample from closed formulas: an irregular triangulation, written as binary STL.

    python3 samples/upper/panels.py

`toe.stl`: a spherical cap of radius 100 mm, 0.42 rad from its pole to its rim: the toe of a boot, or the corner of a
case.  Of all doubly curved panels it is the one whose flattening of least strain is known in closed form (a radial
equation), so that what is computed here can be checked.  `seat.stl`: a saddle z = (x^2 - y^2) / 1000 over a square.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RADIUS, HALF_ANGLE = 100.0, 0.42
"""Of the cap, mm and rad."""
SIDE, FOCUS = 300.0, 1000.0
"""Of the saddle: the side of its square, and z = (x^2 - y^2) / FOCUS, mm."""
RINGS = 22


def disc(rings: int) -> tuple[Array, NDArray[np.int64]]:
    """Return points of the unit disc on rings of 6, 12, 18 ... points, those inside moved a little, and triangles."""
    from scipy.spatial import Delaunay

    source = np.random.default_rng(1)
    points = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        angle = 2.0 * np.pi * (np.arange(6 * ring) + 0.5 * (ring % 2)) / (6 * ring)
        points.append(ring / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
    every = np.concatenate(points)
    inner = np.hypot(*every.T) < 1.0 - 0.5 / rings
    every[inner] += source.uniform(-0.25, 0.25, (int(inner.sum()), 2)) / rings
    return every, oriented(every, Delaunay(every).simplices)


def square(cells: int) -> tuple[Array, NDArray[np.int64]]:
    """Return points of the square [-1, 1]^2, those inside moved a little, and triangles."""
    from scipy.spatial import Delaunay

    source = np.random.default_rng(2)
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-1.0, 1.0, cells + 1)] * 2))
    every = np.column_stack([x, y])
    inner = np.abs(every).max(axis=1) < 1.0
    every[inner] += source.uniform(-0.35, 0.35, (int(inner.sum()), 2)) * 2.0 / cells
    return every, oriented(every, Delaunay(every).simplices)


def oriented(points: Array, faces: NDArray[np.int32]) -> NDArray[np.int64]:
    """Return the triangles counter-clockwise, those without area left out."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    kept = np.abs(area) > np.abs(area).mean() / 1000.0
    return np.where(area[kept, None] < 0.0, faces[kept][:, ::-1], faces[kept]).astype(np.int64)


def cap(points: Array) -> Array:
    """Return places of the unit disc on the spherical cap, equally far from the pole in angle."""
    far = np.hypot(*points.T)
    polar = far * HALF_ANGLE
    out = RADIUS * np.sin(polar) / np.where(far > 0.0, far, 1.0)
    return np.column_stack([out[:, None] * points, RADIUS * np.cos(polar)])


def saddle(points: Array) -> Array:
    """Return places of the square on the saddle."""
    x, y = SIDE / 2.0 * points.T
    return np.column_stack([x, y, (x * x - y * y) / FOCUS])


def stl(points: Array, faces: NDArray[np.int64]) -> bytes:
    """Return a binary STL file."""
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rows = np.zeros(len(faces), dtype=[("numbers", "<f4", (4, 3)), ("attributes", "<u2")])
    rows["numbers"] = np.concatenate([normal[:, None], corners], axis=1)
    head = b"planish sample".ljust(80) + np.uint32(len(faces)).tobytes()
    return head + rows.tobytes()


def files() -> dict[str, bytes]:
    """Return the meshes by their names."""
    round_, around = disc(RINGS)
    even, across = square(34)
    return {"toe.stl": stl(cap(round_), around), "seat.stl": stl(saddle(even), across)}


if __name__ == "__main__":
    for name, content in files().items():
        (Path(__file__).parent / name).write_bytes(content)
