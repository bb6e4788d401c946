"""The isometric map of a developable ruled surface onto the plane, by two quadratures.

With e = p / |p| and w the unit vector across the ruling at its middle,  phi' = e'.w  turns the ruling in the plane and
q' = (c0'.e) E + (c0'.w) E_perp  carries the directrix, E = (cos phi, sin phi):  flat(u, v) = q(v) + u |p(v)| E(v).
Neither a normal nor the curvature of the directrix occurs, so apexes, straight directrices, inflections and cylinders
are no special cases [1]_.

Both quadratures run on panels of 16 Gauss nodes (`quadrature`), pieces one after the other: a ruling shared by two
pieces keeps its direction.  Positions are good to some 1e-14 of the size.  Not for surfaces whose edge of regression
lies inside (verify refuses them); of a surface with warp the map is the one that keeps each ruling and its angle to c0.

.. [1] M. P. do Carmo, "Differential Geometry of Curves and Surfaces", 1976, sections 3-5 and 4-2: developable surfaces
   and the intrinsic equations of their rulings.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry import quadrature
from stages.geometry.arrays import Array, ArrayValue, Indices, Points2, Values, dot, norm, unit
from stages.geometry.flatmap import Development
from stages.geometry.quadrature import ANTIDERIVATIVE, AT_NODES, ORDER, WEIGHTS
from stages.geometry.ruled import RuledPatch, across, frames, turn_rate


@dataclass(frozen=True, slots=True, eq=False)
class RulingMap(ArrayValue):
    """One piece laid flat along its rulings: Legendre series of phi and q on each panel, offsets included.

    breaks: panel ends in v, shape (m + 1,).
    phi: coefficients, rad, shape (m, 17).  q: coefficients, mm, shape (m, 17, 2).
    """

    patch: RuledPatch
    breaks: Values
    phi: Array
    q: Array

    def positions(self, u: Values, v: Values) -> Points2:
        """Return the flat positions of S(u, v), mm: what every later stage sees of the surface."""
        index, x = _locate(self, v)
        e, _ = _axes(_series(self.phi[index][..., None], x)[:, 0])
        rulings = norm(self.patch.p.jet(v, 0)[0])
        return _series(self.q[index], x) + (u * rulings)[:, None] * e

    def velocities(self, u: Values, v: Values) -> Points2:
        """Return d/dv of the flat positions, mm, from the rates: for directions, never for measuring distortion.

        Where a ruling has no length, and so no direction, they are those of the ruling beside it.
        """
        gone = norm(self.patch.p.jet(v, 0)[0]) <= NO_LENGTH * _scale(self.patch)
        v = np.where(gone, np.clip(v, BESIDE, 1.0 - BESIDE), v)
        e, e_perp = _axes(angle(self, v))
        f = frames(self.patch, v)
        w = unit(across(f, 0.5)[1])
        s_v = f.c0_d1 + u[:, None] * f.p_d1
        return dot(s_v, unit(f.p))[:, None] * e + dot(s_v, w)[:, None] * e_perp


def develop(patches: tuple[RuledPatch, ...]) -> Development:
    """Return the flat map of the pieces.  Raises NoSolutionError where the quadrature does not resolve."""
    pieces: list[RulingMap] = []
    phi, q = 0.0, np.zeros(2)
    for number, patch in enumerate(patches):
        piece = _flat_piece(patch, phi, q, f"unrolling piece {number}")
        pieces.append(piece)
        phi, q = float(piece.phi[-1].sum()), piece.q[-1].sum(axis=0)
    first, last = (norm(patch.p.jet(np.array([v]), 0)[0])[0] for patch, v in ((patches[0], 0.0), (patches[-1], 1.0)))
    return Development(tuple(pieces if first > 0.0 or last == 0.0 else (_turned(piece, -phi) for piece in pieces)))


def _turned(piece: RulingMap, angle: float) -> RulingMap:
    """Return the piece turned about the origin by an angle in rad."""
    phi = piece.phi.copy()
    phi[:, 0] += angle
    c, s = np.cos(angle), np.sin(angle)
    return RulingMap(piece.patch, piece.breaks, phi, piece.q @ np.array([[c, s], [-s, c]]))


def _flat_piece(patch: RuledPatch, phi0: float, q0: Array, subject: str) -> RulingMap:
    """Return one piece that starts with the angle phi0 at q0."""
    scale = _scale(patch)
    breaks, rates = _gently_turning(patch, scale, *quadrature.panels(lambda v: _rates(patch, scale, v), subject))
    half = np.diff(breaks)[:, None] / 2.0
    # the turning is scaled to a length (see _rates): back to rad here
    turn = half * quadrature.coefficients(rates[..., 0] / scale) @ ANTIDERIVATIVE.T
    phi = _chained(turn[..., None], np.array([phi0]))[..., 0]
    e, e_perp = _axes(phi @ AT_NODES.T)
    velocity = rates[..., 1:2] * e + rates[..., 2:3] * e_perp
    steps = half[..., None] * np.einsum("lk,pkc->plc", ANTIDERIVATIVE, quadrature.coefficients(velocity))
    return RulingMap(patch, breaks, phi, _chained(steps, q0))


def _gently_turning(patch: RuledPatch, scale: float, breaks: Array, rates: Array) -> tuple[Array, Array]:
    """Return the panels, those divided on which the ruling turns far: E and E_perp must be resolved too."""
    turned = np.diff(breaks) / 2.0 * (np.abs(rates[..., 0]) @ WEIGHTS) / scale
    counts = np.maximum(np.ceil(turned / MOST_TURN), 1.0).astype(int)
    if counts.max() == 1:
        return breaks, rates
    parts = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(breaks[:-1], breaks[1:], counts, strict=True)]
    breaks = np.append(np.concatenate(parts), 1.0)
    v = quadrature.nodes(breaks[:-1], breaks[1:])
    return breaks, _rates(patch, scale, v.ravel()).reshape(*v.shape, -1)


MOST_TURN = 1.0
"""Over a turn of 1 rad the Legendre coefficients of cos and sin fall below rounding by the 11th of 16; rates that are
themselves resolved leave their product so.  Over 2 pi they are at 1e-8."""


def _chained(local: Array, start: Array) -> Array:
    """Return the series of all panels, each begun where the one before ends; (m, 17, c) and (c,)."""
    ends = local.sum(axis=1)
    offsets = np.concatenate([np.zeros((1, ends.shape[1])), np.cumsum(ends, axis=0)[:-1]]) + start
    chained = local.copy()
    chained[:, 0] += offsets
    return chained


def _axes(phi: Array) -> tuple[Array, Array]:
    """Return E and E_perp at angles phi, shape (..., 2)."""
    c, s = np.cos(phi), np.sin(phi)
    return np.stack([c, s], axis=-1), np.stack([-s, c], axis=-1)


def _rates(patch: RuledPatch, scale: float, v: Values) -> Array:
    """Return phi' times the length `scale`, c0'.e, c0'.w, |p|, |c0'| and |c1'|, shape (n, 6), all mm.

    The last three are here only to be resolved: positions depend on |p|, and lengths measured on them on the speeds.
    """
    f = frames(patch, v)
    length = norm(f.p)
    e = unit(f.p)
    w = unit(across(f, 0.5)[1])
    speeds = norm(f.c0_d1), norm(f.c1_d1)
    return np.stack([turn_rate(f) * scale, dot(f.c0_d1, e), dot(f.c0_d1, w), length, *speeds], axis=1)


def _scale(patch: RuledPatch) -> float:
    """Return a length of the patch's size, mm: what an angle is multiplied by to be compared with lengths."""
    ends = np.array([0.0, 0.5, 1.0])
    f = frames(patch, ends)
    return float(max(norm(f.p).max(), norm(f.c0[1:] - f.c0[:-1]).max()))


def angle(piece: RulingMap, v: Values) -> Values:
    """Return the direction of the flat rulings at v, rad."""
    index, x = _locate(piece, v)
    return _series(piece.phi[index][..., None], x)[:, 0]


NO_LENGTH = 1e-15
"""A ruling below this share of the patch's scale has the direction of rounding."""
BESIDE = 2.0**-20
"""How far inside the ruling beside it is: turned by some 1e-6 rad, long enough for a direction to 1e-9."""


def _locate(piece: RulingMap, v: Values) -> tuple[Indices, Values]:
    """Return the panel of each v and the place in it, -1 to 1."""
    index = np.clip(np.searchsorted(piece.breaks, v, side="right") - 1, 0, piece.breaks.size - 2)
    low, high = piece.breaks[index], piece.breaks[index + 1]
    return index, (2.0 * v - low - high) / (high - low)


def _series(coefficients: Array, x: Values) -> Array:
    """Return Legendre sums, shape (n, c), of coefficients (n, 17, c) at x (n,)."""
    total: Array = np.einsum("nk,nkc->nc", legendre.legvander(x, ORDER), coefficients)
    return total
