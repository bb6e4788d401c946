"""How far a flat map is from an isometry: every number of the unroll's report, from the flat positions.

    measure(surface, development, tol) -> Distortion

On the nodes of the map (`nodes`) the differentiated positions F_u, F_v are compared with the surface's S_u, S_v.  With
E = |S_u|^2, F = S_u.S_v, G = |S_v|^2 `metric_error` is the largest relative error of the three.  The principal strains
are the singular values, less 1, of the linear map that takes the surface's tangent plane to the pattern; a pattern that
is mirrored has a negative one.  Lengths and area are compared as `sides` finds them, corner angles by the derivatives
at the corners.

All of it is `sampled`: it holds at the nodes.  Measured bound on an exact map: 1e-12, wherever the panels lie.

No strain is taken where S_u and S_v enclose almost no angle or the ruling has almost no length, beside an apex: of a
panel with rulings up to L mm long and |S_v| up to s mm per unit of v that is an area below `CLEAR` L s times its width
in v.  Root mean square and energy take it to be strained as the rest is on average; the extremes leave it out.  Where
that is all of the part no strain is defined: the metric of E, F and G alone tells then.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stages.geometry.arrays import Array, cross2, dot, norm, similarities
from stages.geometry.flat.flatmap import Development
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.report import Metric, Where
from stages.model.surface import RuledSurface
from stages.model.tolerances import STRAIN_LIMIT, Tolerances
from stages.unroll.nodes import ACROSS, ACROSS_WEIGHTS, PieceNodes, at_nodes
from stages.unroll.sides import Edges, flat_area, flat_edges, surface_figures


@dataclass(frozen=True, slots=True)
class Distortion:
    """The metrics of the unroll, and the figures of both sides that are compared: edges in mm, areas in mm2.

    energy_mm2: the integral of the squares of both principal strains over the surface; None where there are none.
    """

    metrics: tuple[Metric, ...]
    surface: Edges
    flat: Edges
    surface_area: float
    flat_area: float
    energy_mm2: float | None


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest value, the piece and the v and u on it where it is."""

    value: float
    piece: int
    v: float
    u: float


def measure(surface: RuledSurface, development: Development, tol: Tolerances) -> Distortion:
    """Return the distortion of the flat pattern against the surface that was to be unrolled."""
    nodes = [at_nodes(piece) for piece in development.pieces]
    sides = [_Tangents.at(patch, at.v) for patch, at in zip(surface.patches, nodes, strict=True)]
    lengths, surface_area = surface_figures(surface.patches)
    flat, area = flat_edges(nodes), flat_area(nodes)
    strains = [_principal(side, at) for side, at in zip(sides, nodes, strict=True)]
    mean = _mean_square(strains)
    metrics = (
        _length_error(lengths, flat),
        Metric("area_error", abs(area - surface_area) / surface_area),
        _angle_error(surface, nodes),
        _at(surface, "metric_error", metric_error(sides, nodes)),
        *(_no_strains(tol) if mean is None else _strains(surface, strains, nodes, tol)),
        Metric("strain_rms", None if mean is None else float(np.sqrt(mean / 2.0))),
        Metric("flat_gap_mm", piece_gap(nodes), "mm", "sampled", tol.join_mm),
    )
    energy = None if mean is None else mean * surface_area
    return Distortion(metrics, lengths, flat, surface_area, area, energy)


def _at(surface: RuledSurface, name: str, extreme: Extreme, limit: float | None = None) -> Metric:
    """Return an extreme as a metric with its place on the part."""
    where: Where = {"v": surface.v_of(extreme.piece, extreme.v), "u": extreme.u}
    return Metric(name, extreme.value, "", "sampled", limit, where)


# Edges and gaps


def _length_error(before: Edges, after: Edges) -> Metric:
    """Return the largest relative difference of an edge length; edges that are points are passed over."""
    lengths, flat = before.by_name(), after.by_name()
    longest = max(lengths.values())
    errors = {name: abs(flat[name] - a) / a for name, a in lengths.items() if a > NO_EDGE * longest}
    worst = max(errors, key=lambda name: errors[name])
    return Metric("length_error", errors[worst], where={"edge": worst})


NO_EDGE = 1e-12
"""An edge shorter than this share of the longest is a point (an apex)."""


def piece_gap(nodes: list[PieceNodes]) -> float:
    """Return the largest distance between the flat end of a piece and the flat start of the next, mm."""
    gaps = [float(norm(a.flat[-1, -1] - b.flat[0, 0]).max()) for a, b in pairwise(nodes)]
    return max(gaps, default=0.0)


# Metric and strain


@dataclass(frozen=True, slots=True, eq=False)
class _Tangents:
    """The surface at the nodes of one piece: S_u, (m, n, 1, 3), the same all along a ruling, and S_v, (m, n, k, 3)."""

    s_u: Array
    s_v: Array

    @staticmethod
    def at(patch: RuledPatch, v: Array) -> "_Tangents":
        """Return the tangents of the patch at v (m, n) and all places across."""
        c0_d1, c1_d1 = (curve.jet(v.ravel(), 1)[1].reshape(*v.shape, 1, 3) for curve in (patch.c0, patch.c1))
        u = ACROSS[:, None]
        return _Tangents(patch.p.jet(v.ravel(), 0)[0].reshape(*v.shape, 1, 3), (1.0 - u) * c0_d1 + u * c1_d1)


def metric_error(sides: list[_Tangents], nodes: list[PieceNodes]) -> Extreme:
    """Return the largest relative error of E, F, G at the nodes, or misfit of a panel if that is larger.

    E against |S_u|^2, F against |S_u||S_v|, G against the largest |S_v|^2 of the ruling (at an apex G itself is 0).
    None of these is taken below `FLOOR` squared of its largest value on the panel, so that a ruling of no length and an
    edge at rest have an error too.
    """
    found = []
    for piece, (side, at) in enumerate(zip(sides, nodes, strict=True)):
        s_u, s_v = side.s_u, side.s_v
        e, g = dot(s_u, s_u), dot(s_v, s_v)
        E, G = _floored(e), _floored(g.max(axis=2, keepdims=True))
        errors = np.stack(
            [
                np.abs(dot(at.flat_u, at.flat_u) - e) / E,
                np.abs(dot(at.flat_u, at.flat_v) - np.einsum("...ki,...ji->...k", s_v, s_u)) / np.sqrt(E * G),
                np.abs(dot(at.flat_v, at.flat_v) - g) / G,
            ]
        )
        panel = int(np.argmax(at.misfit))
        found += [
            _extreme(errors.max(axis=0), at, piece),
            Extreme(float(at.misfit[panel]), piece, float(at.v[panel, -1]), 0.0),
        ]
    return max(found, key=lambda extreme: extreme.value)


def _floored(squares: Array) -> Array:
    """Return squared lengths (m, n, 1) of at least `FLOOR` squared of the largest of each panel."""
    floored: Array = np.maximum(squares, FLOOR**2 * squares.max(axis=1, keepdims=True))
    return floored


FLOOR = 1e-3
"""A ruling or speed below this share of the panel's largest is held against that share: its own length is rounding of
the panel's over a few digits."""


def _extreme(values: Array, at: PieceNodes, piece: int) -> Extreme:
    """Return the largest of values (m, n, k) with its place; NaN counts for nothing, minus infinity if all are NaN."""
    known = np.where(np.isnan(values), -np.inf, values)
    panel, node, side = np.unravel_index(int(np.argmax(known)), values.shape)
    return Extreme(float(known[panel, node, side]), piece, float(at.v[panel, node]), float(ACROSS[side]))


def _mean_square(found: "list[_Principal]") -> float | None:
    """Return the mean over the area of the sum of the squares of both principal strains; None where there are none."""
    area = sum(float(strain.area.sum()) for strain in found)
    squares = sum(float(np.nansum((strain.most**2 + strain.least**2) * strain.area)) for strain in found)
    return squares / area if area > 0.0 else None


def _no_strains(tol: Tolerances) -> tuple[Metric, ...]:
    """Return the extremes of strain of a map at no node of which they are defined."""
    return Metric("max_strain", None, "", "sampled", STRAIN_LIMIT[tol.accept]), *(Metric(name, None) for name in OTHERS)


OTHERS = "max_extension", "max_compression", "max_area_strain"
"""Extremes of strain that no class has a limit for."""


def _strains(
    surface: RuledSurface, found: "list[_Principal]", nodes: list[PieceNodes], tol: Tolerances
) -> tuple[Metric, ...]:
    """Return the extremes of strain with their places."""

    def largest(values: list[Array]) -> Extreme:
        extremes = [_extreme(value, at, i) for i, (value, at) in enumerate(zip(values, nodes, strict=True))]
        return max(extremes, key=lambda extreme: extreme.value)

    extension = largest([strain.most for strain in found])
    compression = largest([-strain.least for strain in found])
    either = max(extension, compression, key=lambda extreme: extreme.value)
    return (
        _at(surface, "max_strain", either, STRAIN_LIMIT[tol.accept]),
        _at(surface, "max_extension", extension),
        _at(surface, "max_compression", compression),
        _at(surface, "max_area_strain", largest([np.abs(_area_strain(strain)) for strain in found])),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Principal:
    """Principal strains at the nodes of a piece, and the area of the surface that each stands for, mm2, (m, n, k).

    NaN and no area where they are not defined.
    """

    most: Array
    least: Array
    area: Array


def _area_strain(strain: _Principal) -> Array:
    """Return by how much of itself an element of area grows: (1 + most) (1 + least) - 1 without cancellation."""
    growth: Array = strain.most + strain.least + strain.most * strain.least
    return growth


def _principal(side: _Tangents, at: PieceNodes) -> _Principal:
    """Return the principal strains: singular values, less 1, in the orthonormal frame of ruling and across.

    NaN, and without area, where the two enclose almost no angle: there the frame is not defined.
    """
    length = np.sqrt(_floored(dot(side.s_u, side.s_u)))
    e = side.s_u / length[..., None]
    along = np.einsum("...ki,...ji->...k", side.s_v, e)
    aside = norm(side.s_v - along[..., None] * e)
    clear = (aside > CLEAR * norm(side.s_v).max(axis=(1, 2), keepdims=True)) & (norm(side.s_u) >= length)
    flat_e = at.flat_u / length[..., None]
    flat_w = (at.flat_v - along[..., None] * flat_e) / np.where(clear, aside, 1.0)[..., None]
    turn, skew = similarities(flat_e, flat_w)
    area = at.weights[..., None] * ACROSS_WEIGHTS * length * aside
    most, least = (np.where(clear, strain, np.nan) for strain in (turn + skew - 1.0, turn - skew - 1.0))
    return _Principal(most, least, np.where(clear, area, 0.0))


CLEAR = 1e-3
"""Where S_v across the ruling is shorter than this share of the panel's longest |S_v|, the rounding of the derivatives
would show a thousandfold: near an apex, or where the ruling runs along the directrix.  So would it over a ruling that
is shorter than `FLOOR` of the panel's longest."""


# Corners


def _angle_error(surface: RuledSurface, nodes: list[PieceNodes]) -> Metric:
    """Return the largest difference of a corner angle between pattern and surface, deg; None if there is no angle.

    A corner where the edge or the ruling has no direction (an apex, a ruling of no length) is passed over.
    """
    found = []
    for place, v in ((0, 0.0), (-1, 1.0)):
        patch, at = surface.patches[place], nodes[place]
        p = patch.p.jet(np.array([v]), 0)[0, 0]
        fast, long = float(norm(at.flat_v[place]).max()), float(norm(at.flat_u[place]).max())
        for side, curve in ((0, patch.c0), (-1, patch.c1)):
            tangent = curve.jet(np.array([v]), 1)[1, 0]
            if norm(tangent) > NO_DIRECTION * fast and norm(p) > NO_DIRECTION * long:
                before = float(np.arctan2(norm(np.cross(p, tangent)), dot(p, tangent)))
                flat_u, flat_v = at.flat_u[place, place, side], at.flat_v[place, place, side]
                after = float(np.arctan2(cross2(flat_u, flat_v), dot(flat_u, flat_v)))
                found.append(Extreme(abs(after - before), place % len(nodes), v, float(ACROSS[side])))
    if not found:
        return Metric("angle_error_deg", None, "deg")
    worst = max(found, key=lambda extreme: extreme.value)
    where: Where = {"v": surface.v_of(worst.piece, worst.v), "u": worst.u}
    return Metric("angle_error_deg", float(np.degrees(worst.value)), "deg", where=where)


NO_DIRECTION = 1e-6
"""An edge slower than this share of the speeds beside it, or a ruling shorter than this share of the longest, has no
direction to more than seven digits."""
