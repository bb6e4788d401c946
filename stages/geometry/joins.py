"""How two ruled patches meet along a common ruling: gap, angle of the normals, jump of curvature.

Along a ruling the radius of curvature is linear, so curvature is compared at both ends of the ruling and nowhere else;
never by second derivatives of the parametrisation.  G0: same ruling; G1: one common normal; G2: equal curvature too.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Vector3, dot, norm, unit
from stages.geometry.ruled import RuledPatch, at, curvature, end_normals, frames

END, START = np.array([1.0]), np.array([0.0])


@dataclass(frozen=True, slots=True)
class Join:
    """gap_mm at the worse end of the ruling, normal_rad between the normals, jump: |1/rho1 - 1/rho2| in 1/mm.

    The jump is None where a normal or a curvature is not defined on the ruling (an apex, a singular end).
    """

    gap_mm: float
    normal_rad: float
    jump: float | None


def join(a: RuledPatch, b: RuledPatch) -> Join:
    """Return how the last ruling of a meets the first of b."""
    u = np.array([0.0, 1.0])
    gap = float(norm(at(a, u, np.ones(2)) - at(b, u, np.zeros(2))).max())
    na, nb = _normal(a, END), _normal(b, START)
    angle = float(np.arctan2(norm(np.cross(na, nb)), dot(na, nb)))
    jumps = [abs(float((curvature(a, END, side) - curvature(b, START, side))[0])) for side in (0.0, 1.0)]
    finite = [jump for jump in jumps if np.isfinite(jump)]
    return Join(gap, angle, max(finite) if finite else None)


def _normal(patch: RuledPatch, v: np.ndarray) -> Vector3:
    """Return the unit normal of a ruling, from the longer of its end normals."""
    n0, n1 = end_normals(frames(patch, v))
    longer: Vector3 = unit(n0 if norm(n0)[0] > norm(n1)[0] else n1)[0]
    return longer
