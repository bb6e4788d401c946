"""Distortion of an unrolled surface, measured on the flat positions that every later stage receives.

The flat positions at the Gauss nodes of each panel are differentiated numerically (by the interpolating polynomial)
and compared with the surface, which is measured by quadratures of its own.  Nothing here uses the rates phi' and q'
that the map was integrated from: with those, the metric would be right by identity whatever the integration did.  A
panel that is out of place shows as a gap between panels, which counts as metric error over its width.

Bound: derivatives of positions at 16 nodes are good to some 1e-13 of the size over the width of a panel.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from stages.geometry import quadrature
from stages.geometry.arrays import Array, Points2, Values, Vector2, cross2, dot, norm, unit
from stages.geometry.flatmap import Development, FlatPiece
from stages.geometry.quadrature import DIFFERENTIATION, ORDER, WEIGHTS
from stages.geometry.ruled import RuledPatch, end_normals, frames

ACROSS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Places on a ruling where the metric is compared; both edges first and last."""


@dataclass(frozen=True, slots=True)
class Edges:
    """Lengths of the four edges, mm: both directrices, first and last ruling."""

    c0: float
    c1: float
    start: float
    end: float

    def values(self) -> tuple[float, float, float, float]:
        """Return the four lengths in that order."""
        return self.c0, self.c1, self.start, self.end


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest value, and the v (counted over the pieces) and u where it is."""

    value: float
    v: float
    u: float


@dataclass(frozen=True, slots=True)
class PieceNodes:
    """One piece at its Gauss nodes: flat positions (m, 16, 5, 2) at five u, their d/dv, and the panel widths (m,)."""

    v: Array
    flat: Array
    flat_v: Array
    widths: Values


def at_nodes(piece: FlatPiece) -> PieceNodes:
    """Return the flat positions at the nodes and their numerical derivatives."""
    v = quadrature.nodes(piece.breaks[:-1], piece.breaks[1:])
    widths = np.diff(piece.breaks)
    flat = np.stack([piece.positions(np.full(v.size, u), v.ravel()).reshape(*v.shape, 2) for u in ACROSS], axis=2)
    flat_v = np.einsum("ij,pjuc->piuc", DIFFERENTIATION, flat) * (2.0 / widths)[:, None, None, None]
    return PieceNodes(v, flat, flat_v, widths)


def flat_edges(nodes: list[PieceNodes], corners: Points2) -> Edges:
    """Return the edge lengths of the flat pattern from its positions, mm."""
    c0, c1 = (sum(_length(piece, side) for piece in nodes) for side in (0, -1))
    start, end = float(norm(corners[1] - corners[0])), float(norm(corners[2] - corners[3]))
    return Edges(float(c0), float(c1), start, end)


def _length(piece: PieceNodes, side: int) -> float:
    speed = norm(piece.flat_v[:, :, side])
    return float(np.einsum("p,j,pj->", piece.widths / 2.0, WEIGHTS, speed))


def flat_area(nodes: list[PieceNodes], corners: Points2) -> float:
    """Return the signed area of the flat pattern from its positions, mm2 (Green's theorem around the outline)."""
    middle = corners.mean(axis=0)
    curves = sum(_swept(piece, -1, middle) - _swept(piece, 0, middle) for piece in nodes)
    a, b, c, d = corners - middle
    rulings = cross2(a, b) + cross2(c, d)
    return float(0.5 * (curves + rulings))


def _swept(piece: PieceNodes, side: int, middle: Vector2) -> float:
    """Return the integral of x dy - y dx along one edge."""
    swept = cross2(piece.flat[:, :, side] - middle, piece.flat_v[:, :, side])
    return float(np.einsum("p,j,pj->", piece.widths / 2.0, WEIGHTS, swept))


def surface_edges(patches: tuple[RuledPatch, ...]) -> Edges:
    """Return the edge lengths of the surface by quadrature of the speed, mm."""
    lengths = np.sum([_speeds(patch) for patch in patches], axis=0)
    first, last = patches[0].p.jet(np.array([0.0]), 0)[0], patches[-1].p.jet(np.array([1.0]), 0)[0]
    return Edges(float(lengths[0]), float(lengths[1]), float(norm(first)[0]), float(norm(last)[0]))


def _speeds(patch: RuledPatch) -> Array:
    def sample(v: Values) -> Array:
        return np.stack([norm(patch.c0.jet(v, 1)[1]), norm(patch.c1.jet(v, 1)[1])], axis=1)

    return quadrature.integral(sample, "length of a directrix")


def surface_area(patches: tuple[RuledPatch, ...]) -> float:
    """Return the area of the surface by quadrature of |(1 - u) n0 + u n1|, mm2."""
    x, weight = legendre.leggauss(ORDER)
    u = (x + 1.0) / 2.0

    def sample(patch: RuledPatch, v: Values) -> Array:
        n0, n1 = end_normals(frames(patch, v))
        every = (1.0 - u)[None, :, None] * n0[:, None] + u[None, :, None] * n1[:, None]
        return (norm(every) @ weight / 2.0)[:, None]

    def area(patch: RuledPatch) -> float:
        return float(quadrature.integral(lambda v: sample(patch, v), "area of the surface")[0])

    return sum((area(patch) for patch in patches), 0.0)


def metric_error(development: Development, nodes: list[PieceNodes]) -> Extreme:
    """Return the largest relative error of E, F, G at the nodes, or of a gap between panels over their width.

    E against |S_u|^2, F against |S_u||S_v|, G against the largest |S_v|^2 of the ruling (at an apex G itself is 0).
    """
    found = []
    for index, (piece, at) in enumerate(zip(development.pieces, nodes, strict=True)):
        f = frames(piece.patch, at.v.ravel())
        u = np.array(ACROSS)
        s_v = (f.c0_d1[:, None] + u[None, :, None] * f.p_d1[:, None]).reshape(*at.v.shape, u.size, 3)
        s_u = np.broadcast_to(f.p.reshape(*at.v.shape, 1, 3), s_v.shape)
        flat_u = np.broadcast_to((at.flat[:, :, -1] - at.flat[:, :, 0])[:, :, None], at.flat_v.shape)
        E, G = dot(s_u, s_u), dot(s_v, s_v).max(axis=2, keepdims=True)
        errors = np.stack(
            [
                np.abs(dot(flat_u, flat_u) - E) / E,
                np.abs(dot(flat_u, at.flat_v) - dot(s_u, s_v)) / np.sqrt(E * G),
                np.abs(dot(at.flat_v, at.flat_v) - dot(s_v, s_v)) / G,
            ]
        ).max(axis=0)
        found += [_extreme(errors, at.v, index), _panel_gap(piece, at, index)]
    return max(found, key=lambda extreme: extreme.value)


def _extreme(errors: Array, v: Array, index: int) -> Extreme:
    """Return the largest of errors (m, 16, 5) with its place."""
    panel, node, side = np.unravel_index(int(np.nanargmax(errors)), errors.shape)
    return Extreme(float(errors[panel, node, side]), index + float(v[panel, node]), ACROSS[side])


def _panel_gap(piece: FlatPiece, at: PieceNodes, index: int) -> Extreme:
    """Return the largest distance between the end of a panel and the beginning of the next, relative to their lengths.

    Taken from the positions just on both sides of the break; the longer edge of the shorter panel counts.
    """
    inner = piece.breaks[1:-1]
    if not inner.size:
        return Extreme(0.0, float(index), 0.0)
    worst = Extreme(0.0, float(index), 0.0)
    reach = at.widths * norm(at.flat_v).max(axis=(1, 2))
    shorter = np.maximum(np.minimum(reach[:-1], reach[1:]), np.finfo(float).tiny)
    below = np.nextafter(inner, 0.0)
    for u in (0.0, 1.0):
        side = np.full(inner.size, u)
        relative = norm(piece.positions(side, inner) - piece.positions(side, below)) / shorter
        k = int(np.argmax(relative))
        if relative[k] > worst.value:
            worst = Extreme(float(relative[k]), index + float(inner[k]), u)
    return worst


def largest_strain(development: Development, nodes: list[PieceNodes]) -> Extreme:
    """Return the largest principal strain of the flat pattern against the surface, with its place.

    In the orthonormal frame of ruling and across: not defined, and passed over, where the two enclose almost no angle.
    """
    found = []
    for index, (piece, at) in enumerate(zip(development.pieces, nodes, strict=True)):
        f = frames(piece.patch, at.v.ravel())
        shape = at.v.shape
        length = norm(f.p).reshape(*shape, 1)
        e = unit(f.p).reshape(*shape, 1, 3)
        u = np.array(ACROSS)
        s_v = (f.c0_d1[:, None] + u[None, :, None] * f.p_d1[:, None]).reshape(*shape, u.size, 3)
        along = dot(s_v, np.broadcast_to(e, s_v.shape))
        aside = norm(s_v - along[..., None] * e)
        clear = aside > CLEAR * norm(s_v).max()
        flat_e = ((at.flat[:, :, -1] - at.flat[:, :, 0]) / length)[:, :, None]
        flat_w = (at.flat_v - along[..., None] * flat_e) / np.where(clear, aside, 1.0)[..., None]
        stretch = np.linalg.svd(np.stack([np.broadcast_to(flat_e, flat_w.shape), flat_w], axis=-1), compute_uv=False)
        strain = np.where(clear, np.abs(stretch - 1.0).max(axis=-1), 0.0)
        found.append(_extreme(strain, at.v, index))
    return max(found, key=lambda extreme: extreme.value)


CLEAR = 1e-3
"""Where S_v across the ruling is shorter than this share of the longest |S_v|, the rounding of positions would show as
strain: near an apex or where the ruling runs along the directrix."""


def corner_angles(development: Development, nodes: list[PieceNodes]) -> float:
    """Return the largest difference of a corner angle between pattern and surface, rad.

    A corner where the edge or the ruling has no direction (an apex, a ruling of no length) has no angle and is passed
    over.
    """
    differences = []
    least = NO_DIRECTION * max(float(norm(piece.flat[:, :, -1] - piece.flat[:, :, 0]).max()) for piece in nodes)
    for place, panel, x in ((0, 0, -1.0), (-1, -1, 1.0)):
        piece, at = development.pieces[place], nodes[place]
        f = frames(piece.patch, np.array([0.0 if place == 0 else 1.0]))
        for side, tangent in ((0, f.c0_d1[0]), (-1, f.c1_d1[0])):
            series = legendre.legder(quadrature.coefficients(at.flat[panel : panel + 1 or None, :, side])[0], axis=0)
            flat_v: Vector2 = np.asarray(legendre.legval(x, series))
            ends = piece.positions(np.array([0.0, 1.0]), np.full(2, 0.0 if place == 0 else 1.0))
            flat_u = ends[1] - ends[0]
            if norm(tangent) > NO_DIRECTION * norm(f.c0_d1[0] + f.c1_d1[0]) and norm(f.p[0]) > least:
                on_surface = np.arctan2(norm(np.cross(f.p[0], tangent)), dot(f.p[0], tangent))
                in_flat = np.arctan2(abs(cross2(flat_u, flat_v)), dot(flat_u, flat_v))
                differences.append(abs(float(on_surface - in_flat)))
    return max(differences, default=0.0)


NO_DIRECTION = 1e-9
"""An edge whose speed at a corner is below this share of the other edge's has no direction there."""
