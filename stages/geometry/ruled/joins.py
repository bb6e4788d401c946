"""How two ruled patches meet along a common ruling: gap, angle of the normals, jump of curvature.

Along a ruling the radius of curvature is linear, so curvature is compared at both ends of the ruling and nowhere else;
never by second derivatives of the parametrisation.  G0: same ruling; G1: one common normal; G2: equal curvature too.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Values, Vector3, dot, norm, unit
from stages.geometry.ruled.ruled import VANISHED, RuledPatch, at, curvature, end_normals, frames

END, START = np.array([1.0]), np.array([0.0])
BESIDE = 2.0**-20
"""How far inside a normal is taken from where it vanishes on the ruling itself: within some 1e-6 rad of its limit."""


@dataclass(frozen=True, slots=True)
class Join:
    """How two patches meet.

    gap_mm: at the worse end of the ruling.  normal_rad: between the normals.
    jumps: |1/rho1 - 1/rho2| in 1/mm at both ends of the ruling; None where a curvature is not defined (an apex, a
    singular end).
    """

    gap_mm: float
    normal_rad: float
    jumps: tuple[float | None, float | None]

    @property
    def jump(self) -> float | None:
        """Return the larger of both jumps, 1/mm."""
        return max((jump for jump in self.jumps if jump is not None), default=None)


def join(a: RuledPatch, b: RuledPatch) -> Join:
    """Return how the last ruling of a meets the first of b."""
    u = np.array([0.0, 1.0])
    gap = float(norm(at(a, u, np.ones(2)) - at(b, u, np.zeros(2))).max())
    na, nb = _normal(a, END, 1.0 - BESIDE), _normal(b, START, BESIDE)
    angle = float(np.arctan2(norm(np.cross(na, nb)), dot(na, nb)))
    return Join(gap, angle, (_jump(a, b, 0.0), _jump(a, b, 1.0)))


def _jump(a: RuledPatch, b: RuledPatch, u: float) -> float | None:
    """Return the jump of curvature at one end of the ruling, 1/mm."""
    with np.errstate(invalid="ignore"):  # an apex of both: infinite less infinite
        jump = abs(float((curvature(a, END, u) - curvature(b, START, u))[0]))
    return jump if np.isfinite(jump) else None


def _normal(patch: RuledPatch, v: Values, beside: float) -> Vector3:
    """Return the unit normal of a ruling, from the longer of its end normals."""
    f = frames(patch, v)
    n0, n1 = (normal[0] for normal in end_normals(f))
    longer = n0 if norm(n0) > norm(n1) else n1
    if norm(longer) <= VANISHED * norm(f.p[0]) * max(norm(f.c0_d1[0]), norm(f.c1_d1[0])):
        n0, n1 = (normal[0] for normal in end_normals(frames(patch, np.array([beside]))))
        longer = n0 + n1
    normal: Vector3 = unit(longer)
    return normal
