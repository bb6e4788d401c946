"""The isometric map of a developable ruled surface onto the plane, by two quadratures.

With e = p / |p| and w the unit vector across the ruling at its middle,  phi' = e'.w  turns the ruling in the plane;
E = (cos phi, sin phi).  Both directrices are carried by
    q_i' = (c_i'.e) E + (c_i'.w) E_perp,    flat(u, v) = (1 - u) q_0(v) + u q_1(v).
Neither a normal nor the curvature of the directrix occurs, so apexes, straight directrices, inflections and cylinders
are no special cases [1]_.

The quadratures run on panels of 16 Gauss nodes (`quadrature`), pieces one after the other: a ruling shared by two
pieces keeps its direction.  Each panel starts with q_1 = q_0 + |p| E, so the lengths of rulings are not summed up; both
edges are kept as steps from there, which lose no digits however small the panel is against the part.  Positions are
good to some 1e-14 of the size.  Not for surfaces whose edge of regression lies inside (verify refuses them); of a
surface with warp the map is the one that keeps each ruling and its angle to the surface's middle.

.. [1] M. P. do Carmo, "Differential Geometry of Curves and Surfaces", 1976, sections 3-5 and 4-2: developable surfaces
   and the intrinsic equations of their rulings.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import Array, ArrayValue, Indices, Points2, Values, dot, norm, unit
from stages.geometry.flat.flatmap import Development
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.quadrature import ANTIDERIVATIVE, AT_NODES, ORDER, WEIGHTS, beginnings
from stages.geometry.ruled.ruled import RuledPatch, across, frames, sideways


@dataclass(frozen=True, slots=True, eq=False)
class RulingMap(ArrayValue):
    """One piece laid flat along its rulings: on each panel Legendre series of phi and of the steps of both edges.

    breaks: panel ends in v, shape (m + 1,).
    phi: coefficients, rad, offsets included, shape (m, 17).
    starts: q_0 and the ruling q_1 - q_0 where each panel begins, mm, shape (m, 2, 2).
    steps: coefficients of the ways of q_0 and of q_1 from there, mm, shape (m, 17, 2, 2).
    """

    patch: RuledPatch
    breaks: Values
    phi: Array
    starts: Array
    steps: Array

    def positions(self, u: Values, v: Values) -> Points2:
        """Return the flat positions of S(u, v), mm: what every later stage sees of the surface."""
        index, x = _locate(self, v)
        begin, ruling = self.starts[index, 0], self.starts[index, 1]
        flat: Points2 = begin + u[:, None] * ruling + _across(u, _series(self.steps, index, x))
        return flat

    def chords(self, u0: Values, v0: Values, u: Values, v: Values) -> Points2:
        """Return the vectors from the flat S(u0, v0) to the flat S(u, v), mm, both on one panel, by its steps.

        Along the directrices from v0 to v at u0, and then along the ruling of v.
        """
        index, _ = _locate(self, (v0 + v) / 2.0)
        before = _series(self.steps, index, _place(self, index, v0))
        after = _series(self.steps, index, _place(self, index, v))
        ruling = self.starts[index, 1] + after[:, 1] - after[:, 0]
        chord: Points2 = _across(u0, after - before) + (u - u0)[:, None] * ruling
        return chord

    def velocities(self, u: Values, v: Values) -> Points2:
        """Return d/dv of the flat positions, mm, from the rates: for directions, never for measuring distortion.

        Where a ruling has no length, and so no direction, they are those of the ruling beside it.
        """
        gone = norm(self.patch.p.jet(v, 0)[0]) <= NO_LENGTH * _scale(self.patch)
        v = np.where(gone, np.clip(v, BESIDE, 1.0 - BESIDE), v)
        e, e_perp = axes(angle(self, v))
        f = frames(self.patch, v)
        ruling, w = unit(f.p), unit(across(f, 0.5)[1])
        s_v, aside = across(f, u)
        return dot(s_v, ruling)[:, None] * e + dot(aside, w)[:, None] * e_perp


def develop(patches: tuple[RuledPatch, ...]) -> Development:
    """Return the flat map of the pieces.  Raises NoSolutionError where the quadrature does not resolve."""
    pieces: list[RulingMap] = []
    phi, q = 0.0, np.zeros(2)
    for number, patch in enumerate(patches):
        piece = _flat_piece(patch, phi, q, f"unrolling piece {number}")
        pieces.append(piece)
        phi, q = float(piece.phi[-1].sum()), piece.starts[-1, 0] + piece.steps[-1, :, 0].sum(axis=0)
    first, last = (norm(patch.p.jet(np.array([v]), 0)[0])[0] for patch, v in ((patches[0], 0.0), (patches[-1], 1.0)))
    return Development(tuple(pieces if first > 0.0 or last == 0.0 else (_turned(piece, -phi) for piece in pieces)))


def _turned(piece: RulingMap, angle: float) -> RulingMap:
    """Return the piece turned about the origin by an angle in rad."""
    phi = piece.phi.copy()
    phi[:, 0] += angle
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    return piece.replace(phi=phi, starts=piece.starts @ turn, steps=piece.steps @ turn)


def _flat_piece(patch: RuledPatch, phi0: float, q0: Array, subject: str) -> RulingMap:
    """Return one piece that starts with the angle phi0 at q0."""
    scale = _scale(patch)
    breaks, rates = _gently_turning(patch, scale, *quadrature.panels(lambda v: _rates(patch, scale, v), subject))
    half = np.diff(breaks)[:, None] / 2.0
    # the turning is scaled to a length (see _rates): back to rad here
    turn = half * quadrature.coefficients(rates[..., 0] / scale) @ ANTIDERIVATIVE.T
    begin = beginnings(turn[..., None], np.array([phi0]))[:, 0]
    phi = turn.copy()
    phi[:, 0] += begin
    velocities = _velocities(rates, *axes(phi @ AT_NODES.T))
    steps = half[..., None, None] * np.einsum("lk,pkec->plec", ANTIDERIVATIVE, quadrature.coefficients(velocities))
    rulings = norm(patch.p.jet(breaks[:-1], 0)[0])[:, None] * axes(begin)[0]
    starts = np.stack([beginnings(steps[:, :, 0], q0), rulings], axis=1)
    return RulingMap(patch, breaks, phi, starts, steps)


def _velocities(rates: Array, e: Array, e_perp: Array) -> Array:
    """Return q_0' and q_1' at the nodes of all panels, shape (m, 16, 2, 2), from the rates and the directions there."""
    along, aside = rates[..., 1:4:2, None], rates[..., 2:5:2, None]
    velocities: Array = along * e[..., None, :] + aside * e_perp[..., None, :]
    return velocities


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


def axes(phi: Array) -> tuple[Array, Array]:
    """Return E and E_perp at angles phi, shape (..., 2)."""
    c, s = np.cos(phi), np.sin(phi)
    return np.stack([c, s], axis=-1), np.stack([-s, c], axis=-1)


def _rates(patch: RuledPatch, scale: float, v: Values) -> Array:
    """Return phi' times the length `scale`, c0'.e, c0'.w, c1'.e, c1'.w, |c0'| and |c1'|, shape (n, 7), all mm.

    The last two are here only to be resolved: lengths are measured on the positions.
    """
    c0_d1, c1_d1 = patch.c0.jet(v, 1)[1], patch.c1.jet(v, 1)[1]
    p, p_d1 = patch.p.jet(v, 1)
    length, e = norm(p), unit(p)
    along = [dot(tangent, e) for tangent in (c0_d1, c1_d1)]
    # w is at right angles to e only to rounding over the sine of the angle at c0': what lies along e goes first
    aside = [tangent - part[:, None] * e for tangent, part in zip((c0_d1, c1_d1), along, strict=True)]
    w = unit(aside[0] + aside[1])
    turn = np.divide(sideways(p_d1, e, w) * scale, length, out=np.zeros_like(length), where=length > 0.0)
    edges = [along[0], dot(aside[0], w), along[1], dot(aside[1], w)]
    return np.stack([turn, *edges, norm(c0_d1), norm(c1_d1)], axis=1)


def _scale(patch: RuledPatch) -> float:
    """Return a length of the patch's size, mm: what an angle is multiplied by to be compared with lengths."""
    ends = np.array([0.0, 0.5, 1.0])
    c0 = patch.c0.jet(ends, 0)[0]
    return float(max(norm(patch.p.jet(ends, 0)[0]).max(), norm(c0[1:] - c0[:-1]).max()))


def angle(piece: RulingMap, v: Values) -> Values:
    """Return the direction of the flat rulings at v, rad."""
    index, x = _locate(piece, v)
    return _series(piece.phi[..., None], index, x)[:, 0]


NO_LENGTH = 1e-15
"""A ruling below this share of the patch's scale has the direction of rounding."""
BESIDE = 2.0**-20
"""How far inside the ruling beside it is: turned by some 1e-6 rad, long enough for a direction to 1e-9."""


def _locate(piece: RulingMap, v: Values) -> tuple[Indices, Values]:
    """Return the panel of each v and the place in it, -1 to 1."""
    index = np.clip(np.searchsorted(piece.breaks, v, side="right") - 1, 0, piece.breaks.size - 2)
    return index, _place(piece, index, v)


def _place(piece: RulingMap, index: Indices, v: Values) -> Values:
    """Return the places of v in given panels, -1 to 1."""
    low, high = piece.breaks[index], piece.breaks[index + 1]
    place: Values = ((v - low) - (high - v)) / (high - low)
    return place


def _series(coefficients: Array, index: Indices, x: Values) -> Array:
    """Return Legendre sums, shape (n, ...), of the series (m, 17, ...) of panels `index` (n,) at x (n,).

    Equal places in a row, as of points along one ruling, are summed once.
    """
    fresh = np.ones(x.size, dtype=bool)
    fresh[1:] = (x[1:] != x[:-1]) | (index[1:] != index[:-1])
    sums = np.einsum("nk,nk...->n...", legendre.legvander(x[fresh], ORDER), coefficients[index[fresh]])
    total: Array = sums[np.cumsum(fresh) - 1]
    return total


def _across(u: Values, both: Array) -> Points2:
    """Return what lies at u between values of both edges, (n, 2, 2)."""
    between: Points2 = (1.0 - u)[:, None] * both[:, 0] + u[:, None] * both[:, 1]
    return between
