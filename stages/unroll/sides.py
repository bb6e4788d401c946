"""Lengths of the edges and area of both sides, the flat pattern and the surface, which share no number.

Those of the pattern are integrals along its outline of the positions' numerical derivatives (`nodes`), the end rulings
as the curves that they may be; those of the surface are quadratures of speed and area element on panels of their own.
Good to some 1e-14 each.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, Values, Vector2, cross2, dot, norm
from stages.geometry.numeric import quadrature
from stages.geometry.ruled.ruled import RuledPatch, longest_ruling
from stages.unroll.nodes import ACROSS_WEIGHTS, PieceNodes


@dataclass(frozen=True, slots=True)
class Edges:
    """Lengths of the four edges, mm: both directrices, first and last ruling."""

    c0: float
    c1: float
    start: float
    end: float

    def by_name(self) -> dict[str, float]:
        """Return the four lengths by name."""
        return {"c0": self.c0, "c1": self.c1, "start": self.start, "end": self.end}


def flat_edges(nodes: list[PieceNodes]) -> Edges:
    """Return the lengths of the pattern's four edges, mm."""
    c0, c1 = (sum(float((norm(at.flat_v[:, :, side]) * at.weights).sum()) for at in nodes) for side in (0, -1))
    start, end = nodes[0].flat_u[0, 0], nodes[-1].flat_u[-1, -1]
    return Edges(c0, c1, float(norm(start) @ ACROSS_WEIGHTS), float(norm(end) @ ACROSS_WEIGHTS))


def flat_area(nodes: list[PieceNodes]) -> float:
    """Return the signed area within the pattern's outline, mm2: by Green's theorem half the integral of x dy - y dx."""
    first, last = nodes[0].flat[0, 0], nodes[-1].flat[-1, -1]
    middle: Vector2 = (first[0] + first[-1] + last[0] + last[-1]) / 4.0
    start = _swept(first - middle, nodes[0].flat_u[0, 0], ACROSS_WEIGHTS)
    end = _swept(last - middle, nodes[-1].flat_u[-1, -1], ACROSS_WEIGHTS)
    sides = sum(
        _swept(at.flat[:, :, -1] - middle, at.flat_v[:, :, -1], at.weights)
        - _swept(at.flat[:, :, 0] - middle, at.flat_v[:, :, 0], at.weights)
        for at in nodes
    )
    return (start + sides - end) / 2.0


def _swept(points: Array, slopes: Array, weights: Array) -> float:
    """Return the integral of x dy - y dx along one edge, mm2."""
    return float((cross2(points, slopes) * weights).sum())


def surface_figures(patches: tuple[RuledPatch, ...]) -> tuple[Edges, float]:
    """Return edge lengths in mm and area in mm2 of the surface, by quadratures of speed and area element."""
    figures = np.sum([_figures(patch) for patch in patches], axis=0)
    first, last = patches[0].p.jet(np.array([0.0]), 0)[0], patches[-1].p.jet(np.array([1.0]), 0)[0]
    return Edges(float(figures[0]), float(figures[1]), float(norm(first)[0]), float(norm(last)[0])), float(figures[2])


GAUSS, GAUSS_WEIGHTS = legendre.leggauss(quadrature.ORDER)


def _figures(patch: RuledPatch) -> Array:
    """Return the lengths of c0 and c1, mm, and the area, mm2, of one patch.

    On a ruling the area element is |(1 - u) n0 + u n1|; its square is a sum of three products, none negative short of
    a fold.  Divided by a length it is resolved along with the speeds.
    """
    u = (GAUSS + 1.0) / 2.0
    squares = np.stack([(1.0 - u) ** 2, 2.0 * u * (1.0 - u), u**2])
    scale = longest_ruling(patch)

    def sample(v: Values) -> Array:
        p, c0_d1, c1_d1 = patch.p.jet(v, 0)[0], patch.c0.jet(v, 1)[1], patch.c1.jet(v, 1)[1]
        n0, n1 = np.cross(p, c0_d1), np.cross(p, c1_d1)
        products = np.stack([dot(n0, n0), dot(n0, n1), dot(n1, n1)], axis=1)
        element = np.sqrt(np.maximum(products @ squares, 0.0)) @ (GAUSS_WEIGHTS / 2.0)
        return np.stack([norm(c0_d1), norm(c1_d1), element / scale], axis=1)

    figures: Array = quadrature.integral(sample, "lengths and area of the surface") * np.array([1.0, 1.0, scale])
    return figures
