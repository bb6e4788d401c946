"""Spherical caps, whose flattening of least strain is known in closed form.

With t = tan(theta / 2), theta the angle from the pole, r the radius in the plane and R that of the sphere, the minimum
of the integral of (r' - 1)^2 + (r / rho - 1)^2 over the cap (rho = R sin theta, ' along the meridian) obeys

    (t d/dt)^2 r - r = -4 R t^3 / (1 + t^2)^2,

of which the solutions that are 0 at the pole are r = C t + R log(1 + t^2) / t.  With T and Theta at the rim, a free
rim (r' = 1 there) makes C = R log(1 + T^2) / T^2, one of kept length (r = R sin Theta there)
C = R (sin Theta / T - log(1 + T^2) / T^2).
"""

from fractions import Fraction

import numpy as np

from stages.geometry.arrays import Values
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.topology import boundary_loops, edges_of
from stages.model.material import Material, Part
from stages.model.meshes import MeshFile
from stages.model.part import PartSpec
from stages.model.scalars import Length, Point
from stages.model.surface import MeshSurface
from tests.meshes import jittered

RADIUS = 100.0


def cap(half_angle: float, cells: int = 30, seed: int = 0, radius: float = RADIUS) -> Mesh:
    """Return an irregular mesh of a cap about +z: the square mapped to the disc by squeezing its diagonals, and up."""
    x, y, faces = jittered(seed, cells, cells)
    a, b = 2.0 * x - 1.0, 2.0 * y - 1.0
    p, q = a * np.sqrt(1.0 - b * b / 2.0), b * np.sqrt(1.0 - a * a / 2.0)
    far = np.minimum(np.hypot(p, q), 1.0)
    polar = far * half_angle
    share = np.sin(polar) / np.where(far > 0.0, far, 1.0)
    return Mesh(radius * np.column_stack([p * share, q * share, np.cos(polar)]), faces)


def on_cap(polar: float, turn: float, radius: float = RADIUS) -> Point:
    """Return a point of the sphere as a job file has it."""
    place = radius * np.array([np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)])
    x, y, z = (Length(Fraction(float(value))) for value in place)
    return x, y, z


def constant(half_angle: float, *, kept: bool) -> float:
    """Return C / R."""
    rim = np.tan(half_angle / 2.0)
    free = float(np.log1p(rim**2) / rim**2)
    return float(np.sin(half_angle) / rim) - free if kept else free


def flat_radius(polar: Values, half_angle: float, *, kept: bool = False, radius: float = RADIUS) -> Values:
    """Return r at angles from the pole, mm."""
    t = np.tan(polar / 2.0)
    safe = np.where(t > 0.0, t, 1.0)
    return np.asarray(radius * (constant(half_angle, kept=kept) * t + np.where(t > 0.0, np.log1p(t**2) / safe, 0.0)))


def pole_strain(half_angle: float, *, kept: bool = False) -> float:
    """Return the strain at the pole, the same in all directions."""
    return (constant(half_angle, kept=kept) - 1.0) / 2.0


def rim_strain(half_angle: float) -> float:
    """Return the strain along a free rim."""
    rim = np.array([half_angle])
    return float(flat_radius(rim, half_angle)[0] / (RADIUS * np.sin(half_angle)) - 1.0)


def part(mesh: Mesh, **keys: object) -> Part:
    """Return a part that is that mesh, not to be recognised."""
    surface = MeshFile(file="m.stl", recognise=False, **keys)  # type: ignore[arg-type]
    return Part(PartSpec(name="m", surface=surface), Material(), body=mesh)


def disc(mesh: Mesh) -> MeshSurface:
    """Return a mesh without holes as construct hands it on."""
    loops = boundary_loops(mesh, edges_of(mesh))
    return MeshSurface(part(mesh), mesh, loops, float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))))
