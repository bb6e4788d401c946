"""The strain field of a flat map on a grid: principal strains and their directions, for heat maps and reports.

Measured like every other figure of the distortion on the flat positions: their numerical derivatives at the nodes of
the panels (`nodes`), carried to the grid by the same interpolating polynomials, against the surface's tangents.  With e
along the ruling and w across it in the tangent plane, J = [F_e, F_w] takes the surface's plane to the pattern's; the
strains are its singular values, less 1, the direction is that in the pattern in which the sheet is stretched most.

A grid shows a field, not its extremes: those are measured by `distortion` at all nodes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev, legendre

from stages.geometry.arrays import Array, ArrayValue, Matrix, Points2, Values, dot, norm, similarities
from stages.geometry.flat.flatmap import Development, FlatPiece
from stages.model.surface import RuledSurface
from stages.unroll.nodes import ACROSS, ALONG, PieceNodes, at_nodes


@dataclass(frozen=True, slots=True, eq=False)
class StrainField(ArrayValue):
    """Strains at u (n,) and the part's v (m,), every array of shape (m, n); NaN where the surface has no tangent plane.

    x, y: the places in the flat frame, mm.  most, least: principal strains.
    direction: of the larger one, rad from +x in the flat frame, in (-pi/2, pi/2]; 0 where both are the same.
    """

    u: Array
    v: Array
    x: Matrix
    y: Matrix
    most: Matrix
    least: Matrix
    direction: Matrix


def strain_field(surface: RuledSurface, development: Development, n_u: int, n_v: int) -> StrainField:
    """Return the field at n_u places along each of n_v rulings, evenly spread over u and over each patch's v."""
    count = max(-(-n_v // len(development.pieces)), 2)
    u, local = np.linspace(0.0, 1.0, n_u), np.linspace(0.0, 1.0, count)
    every = [_piece_field(piece, u, local) for piece in development.pieces]
    places, strains = (np.concatenate(part) for part in zip(*every, strict=True))
    v = [surface.v_of(i, place) for i in range(len(development.pieces)) for place in local]
    return StrainField(u, np.array(v), *np.moveaxis(places, 2, 0), *np.moveaxis(strains, 2, 0))


def as_detail(field: StrainField) -> dict[str, object]:
    """Return the field as it stands in the report: lists, degrees, null for what is not defined."""
    arrays = {"x": field.x, "y": field.y, "most": field.most, "least": field.least,
              "direction_deg": np.degrees(field.direction)}  # fmt: skip
    grids = {name: [[_number(value) for value in row] for row in array] for name, array in arrays.items()}
    return {"u": field.u.tolist(), "v": field.v.tolist()} | grids


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _piece_field(piece: FlatPiece, u: Array, v: Array) -> tuple[Array, Array]:
    """Return positions, (m, n, 2), and strains with direction, (m, n, 3), of one piece on a grid."""
    us, vs = np.tile(u, v.size), np.repeat(v, u.size)
    flat_u, flat_v = slopes(piece, at_nodes(piece), us, vs)
    strains = principal(piece, flat_u, flat_v, us, vs)
    shape = (v.size, u.size, -1)
    return piece.positions(us, vs).reshape(shape), strains.reshape(shape)


def slopes(piece: FlatPiece, at: PieceNodes, u: Values, v: Values) -> tuple[Points2, Points2]:
    """Return d/du and d/dv of the flat positions at any places, shape (n, 2), from those at the nodes."""
    panel = np.clip(np.searchsorted(piece.breaks, v, side="right") - 1, 0, piece.breaks.size - 2)
    low, high = piece.breaks[panel], piece.breaks[panel + 1]
    along = legendre.legvander((2.0 * v - low - high) / (high - low), ALONG.size - 1)
    across = chebyshev.chebvander(2.0 * u - 1.0, ACROSS.size - 1)
    weights_v = along @ np.linalg.inv(legendre.legvander(ALONG, ALONG.size - 1))
    weights_u = across @ np.linalg.inv(chebyshev.chebvander(2.0 * ACROSS - 1.0, ACROSS.size - 1))
    by_u, by_v = (
        np.einsum("ni,nj,nijc->nc", weights_v, weights_u, slope[panel], optimize=True)
        for slope in (at.flat_u, at.flat_v)
    )
    return by_u, by_v


def principal(piece: FlatPiece, flat_u: Points2, flat_v: Points2, u: Values, v: Values) -> Array:
    """Return larger and smaller principal strain, and the direction of the larger in the pattern, shape (n, 3)."""
    s_u, c0_v, c1_v = piece.patch.p.jet(v, 0)[0], piece.patch.c0.jet(v, 1)[1], piece.patch.c1.jet(v, 1)[1]
    s_v = (1.0 - u)[:, None] * c0_v + u[:, None] * c1_v
    length = norm(s_u)
    clear = length > CLEAR * length.max()
    e = s_u / np.where(clear, length, 1.0)[:, None]
    along = dot(s_v, e)
    aside = norm(s_v - along[:, None] * e)
    clear &= aside > CLEAR * norm(s_v).max()
    f_e = flat_u / np.where(clear, length, 1.0)[:, None]
    f_w = (flat_v - along[:, None] * f_e) / np.where(clear, aside, 1.0)[:, None]
    similar, mirrored = similarities(f_e, f_w)
    # of J J^T, whose eigenvectors are the principal directions in the pattern
    skew, difference = 2.0 * dot(f_e[:, :1], f_e[:, 1:]) + 2.0 * dot(f_w[:, :1], f_w[:, 1:]), _squares(f_e, f_w)
    direction = np.where(mirrored > ALIKE, np.arctan2(skew, difference) / 2.0, 0.0)
    strains = np.stack([similar + mirrored - 1.0, similar - mirrored - 1.0, direction], axis=1)
    return np.where(clear[:, None], strains, np.nan)


def _squares(f_e: Points2, f_w: Points2) -> Values:
    """Return (J J^T)_11 - (J J^T)_22."""
    every = np.stack([f_e, f_w])
    return np.asarray((every[..., 0] ** 2 - every[..., 1] ** 2).sum(axis=0))


CLEAR = 1e-3
"""A ruling, or a width across it, below this share of the longest magnifies the rounding of derivatives as much."""
ALIKE = 1e-12
"""Principal strains that differ by less differ by the rounding of the derivatives: no direction is stretched most."""
