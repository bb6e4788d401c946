"""What a surface of a CAD file is as a ruled surface: parallel rulings, rulings from an apex, or two rails.

A B-spline net is ruled along one of its parameters, t say, if every row of its homogeneous control points is that of
a straight line run evenly: P_j = P_first + g_j (P_last - P_first), g_j the Greville abscissae of t, for these are the
control points of the linear function [1]_.  That holds for degree 1, for a raised degree, and after knots were
inserted.  The first and the last row are then the rails; equal t need not divide the rulings evenly where weights
differ.

.. [1] G. Farin, "Curves and Surfaces for CAGD", 5th ed., sec. 8.6, 2002.
"""

from dataclasses import dataclass

import numpy as np

from stages.construct.faces.spline import pieces
from stages.geometry.arrays import EPS, Array, Points3, Values, norm, unit
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.cadface import CadCone, CadNet, CadPlane, CadSurface, CadSweep


@dataclass(frozen=True, slots=True)
class Rails:
    """Patches between two rails."""

    patches: tuple[RuledPatch, ...]


RuledForm = CadPlane | CadSweep | CadCone | Rails
"""A surface that is ruled, by what it is trimmed and joined as."""


def ruled_form(surface: CadSurface | None) -> RuledForm | None:
    """Return the surface as a ruled one; None where it has no rulings."""
    if surface is None or not isinstance(surface, CadNet):
        return surface
    if flat(surface.points.reshape(-1, 3)):
        return CadPlane()
    return rails_of(surface) or rails_of(exchanged(surface))


def flat(points: Points3) -> bool:
    """Return whether points lie in one plane to rounding."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[2] <= ROUNDING * (spread[0] + norm(points).max()))


ROUNDING = 1e-12
"""Share of the size by which control points that a CAD program computed may be off: some thousand roundings."""


def exchanged(net: CadNet) -> CadNet:
    """Return the net with its parameters exchanged."""
    points, weights = net.points.transpose(1, 0, 2), net.weights.T
    return CadNet(net.degree_v, net.degree_u, net.knots_v, net.knots_u, points, weights)


def rails_of(net: CadNet) -> Rails | None:
    """Return the rails of a net that is ruled along its second parameter, else None."""
    rows = np.concatenate([net.points * net.weights[..., None], net.weights[..., None]], axis=2)
    share = greville(net.degree_v, net.knots_v)
    evenly = rows[:, :1] + share[:, None] * (rows[:, -1:] - rows[:, :1])
    off = np.abs(rows - evenly).max(axis=(0, 1))
    if (off > ROUNDING * np.abs(rows).max(axis=(0, 1)).clip(min=np.abs(rows[..., :3]).max() * WEIGHTED)).any():
        return None
    ends = (0, -1)
    c0, c1 = (pieces(net.degree_u, net.knots_u, net.points[:, j], list(net.weights[:, j])) for j in ends)
    return Rails(tuple(between(a, b) for a, b in zip(c0, c1, strict=True)))


WEIGHTED = np.array([1.0, 1.0, 1.0, 0.0])
"""Coordinates are held against the largest of them, weights against the largest weight."""


def greville(degree: int, knots: Array) -> Array:
    """Return the Greville abscissae, from 0 for the first to 1 for the last."""
    means = np.array([knots[i + 1 : i + degree + 1].mean() for i in range(knots.size - degree - 1)])
    return np.asarray((means - means[0]) / (means[-1] - means[0]))


def parallel(rails: Rails) -> Rails | CadSweep:
    """Return rails with parallel rulings as a sweep of the first one."""
    v = np.linspace(0.0, 1.0, 9)
    directions = np.concatenate([unit(patch.p.jet(v, 0)[0]) for patch in rails.patches])
    reach = np.concatenate([_reach(patch, v) for patch in rails.patches])
    if (norm(directions - directions[0]) > reach).any():
        return rails
    return CadSweep(tuple(patch.c0 for patch in rails.patches), directions[0])


def _reach(patch: RuledPatch, v: Values) -> Array:
    """Return by how much rounding may turn the rulings at v, rad."""
    c0, p = patch.c0.jet(v, 0)[0], patch.p.jet(v, 0)[0]
    far = norm(c0) + norm(p)
    return np.divide(TURNED * far, norm(p), out=np.full_like(far, np.inf), where=norm(p) > 0.0)


TURNED = 64 * EPS
"""Roundings of the ends of a ruling, as a share of their distance from the origin."""
