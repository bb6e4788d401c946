"""A flat map at the nodes of its panels: positions, their numerical derivatives, and what does not fit together.

Nothing of the map is used but positions and the vectors between them: not the rates that it was integrated from, with
which the metric would be right by identity whatever the integration did.  The nodes are others than those the map was
made from: 20 Gauss points along each panel and its two ends, where a map made at 16 has no polynomial left that
vanishes on all of them, and 17 Chebyshev points across, both edges among them.

Derivatives come from vectors within a panel (`FlatPiece.chords`), which keep the digits that absolute positions of a
large part have lost.  So that they are nothing but differences of the positions that the writer receives, both are
compared at every node, the end of a panel by where the next one begins: what they differ by beyond the rounding of a
position is `misfit`, relative to the panel's own length.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry.arrays import EPS, Array, Values, norm
from stages.geometry.flat.flatmap import FlatPiece
from stages.geometry.numeric import differentiation

GAUSS, GAUSS_WEIGHTS = legendre.leggauss(20)
ALONG, ALONG_WEIGHTS = np.concatenate([[-1.0], GAUSS, [1.0]]), np.concatenate([[0.0], GAUSS_WEIGHTS, [0.0]])
"""Nodes along a panel: 16 panel nodes make polynomials of degree 16, which more nodes differentiate exactly."""
ACROSS, ACROSS_WEIGHTS = ((x + shift) / 2.0 for x, shift in zip(differentiation.lobatto(17), (1.0, 0.0), strict=True))
"""Places u on a ruling, edges first and last: exact for flat rulings that are curves up to degree 16."""
ACROSS_SLOPES = differentiation.matrix(ACROSS)
ROUNDED = 8 * EPS
"""What a position may be off by rounding, as a share of the largest: two series, two products and four sums."""


@dataclass(frozen=True, slots=True, eq=False)
class PieceNodes:
    """One piece at n nodes along each of m panels, their ends first and last, and k places across.

    v: (m, n).  weights: those of an integral over v, (m, n).  flat: positions, mm, (m, n, k, 2).
    flat_u, flat_v: their derivatives, (m, n, k, 2).
    misfit: for each panel the largest disagreement among positions, vectors and the next panel, relative, (m,).
    """

    v: Array
    weights: Array
    flat: Array
    flat_u: Array
    flat_v: Array
    misfit: Values


def at_nodes(piece: FlatPiece) -> PieceNodes:
    """Return the flat positions at the nodes and their numerical derivatives."""
    low, high = piece.breaks[:-1, None], piece.breaks[1:, None]
    half = (high - low) / 2.0
    v = (low + high) / 2.0 + half * ALONG
    v[:, :1], v[:, -1:] = low, high
    # where v lies in its panel: not at the Gauss points themselves, by the rounding of v over the panel's width
    x = ((v - low) - (high - v)) / (high - low)
    flat = _each(piece, v)
    gains = _vectors(piece, ACROSS, low, v)
    rulings = _vectors(piece, np.zeros_like(ACROSS), v, v)
    flat_v = (differentiation.matrix(x) @ gains.reshape(*v.shape, -1)).reshape(gains.shape) / half[..., None, None]
    flat_u = ACROSS_SLOPES @ rulings
    return PieceNodes(v, half * ALONG_WEIGHTS, flat, flat_u, flat_v, _misfit(flat, gains, rulings))


def _each(piece: FlatPiece, v: Array) -> Array:
    """Return the positions at all places across for all v (...), shape (..., k, 2)."""
    shape = (*v.shape, ACROSS.size)
    us, vs = np.broadcast_to(ACROSS, shape), np.broadcast_to(v[..., None], shape)
    flat: Array = piece.positions(us.ravel(), vs.ravel()).reshape(*shape, 2)
    return flat


def _vectors(piece: FlatPiece, u0: Values, v0: Array, v: Array) -> Array:
    """Return the vectors from (u0, v0) to (u, v), for pairs of u0 and u (k,) and all v (...), shape (..., k, 2)."""
    shape = (*v.shape, ACROSS.size)
    ends = (u0, v0[..., None], ACROSS, v[..., None])
    vectors: Array = piece.chords(*(np.broadcast_to(end, shape).ravel() for end in ends)).reshape(*shape, 2)
    return vectors


def _misfit(flat: Array, gains: Array, rulings: Array) -> Values:
    """Return for each panel by how much positions, vectors and the next panel disagree, relative."""
    allowed = ROUNDED * float(norm(flat).max())
    along = norm(flat - flat[:, :1] - gains).max(axis=(1, 2))
    across = norm(flat - flat[:, :, :1] - rulings).max(axis=2)
    reach = norm(gains).max(axis=(1, 2))
    shorter = np.minimum(reach, np.append(reach[1:], np.inf))
    misfit: Values = np.maximum(
        _beyond(along, allowed, shorter), _beyond(across, allowed, norm(rulings).max(axis=2)).max(axis=1)
    )
    return misfit


def _beyond(away: Array, allowed: float, length: Array) -> Array:
    """Return what `away` exceeds `allowed` by, relative to lengths (of no less than what is allowed)."""
    excess: Array = np.maximum(away - allowed, 0.0) / np.maximum(length, max(allowed, np.finfo(float).tiny))
    return excess
