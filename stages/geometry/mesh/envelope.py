"""The ruled patch of a fitted family of tangent planes, and its chart: flat points have their places in u and v.

Symbols of `rulings`: the ruling of t is N.x = D, W.(x, -1) = 0, with the direction E = N x W.  On it P is the point
nearest to a guide q(t) that runs through the mesh, and the directrices are P + a(t) E / |E| and P + b(t) E / |E| with
polynomials a and b that enclose the vertices.  All derivatives by power series (`series`), so the patch is developable
to rounding wherever it is asked for.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from stages.errors import NoSolutionError
from stages.geometry.arrays import Array, ArrayValue, Points2, Points3, Values, cross2, diagonal, dot, norm
from stages.geometry.curves.curves import Curve
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import FlatPiece
from stages.geometry.mesh.mesh import Mesh
from stages.geometry.mesh.primitives import facets
from stages.geometry.mesh.rulings import Family
from stages.geometry.numeric.series import derivatives, inner, outer, power, scaled, taylor, unit
from stages.geometry.ruled.envelope import image
from stages.geometry.ruled.ruled import RuledPatch, end_normals, frames, regression

GUIDE_DEGREE, SIDE_DEGREE, BINS = 8, 6, 40
"""Of the guide and of the directrices' distances from it; stretches in which their extremes are looked for."""
BESIDE = 2e-3
"""How far the patch reaches beyond the vertices, as a share of its range: their outline swells between them."""


@dataclass(frozen=True, slots=True, eq=False)
class Edge(ArrayValue):
    """A directrix of the envelope, or (`whole` = 0) the vector along its rulings, over t from `low` to `high`.

    side: Chebyshev coefficients of the distance along the ruling, in units of the family's extent.
    """

    family: Family
    guide: Array
    side: Array
    low: float
    high: float
    whole: float = 1.0

    def jet(self, v: Values, order: int) -> Array:
        """Return position and derivatives up to `order`, shape (order + 1, n, 3), mm."""
        t, width, family = self.low + v * (self.high - self.low), self.high - self.low, self.family
        every = _jet((family.planes, family.turns, self.guide, self.side[:, None]), t, width, order)
        n, d, w, e = every[..., :3], every[..., 3], every[..., 4:7], every[..., 7]
        along = outer(n, w)
        ruling = scaled(every[..., 11], unit(along))
        if not self.whole:
            return np.asarray(family.extent * derivatives(ruling))
        guided = inner(along, every[..., 8:11])
        sums = scaled(d, outer(w, along)) + scaled(e, outer(along, n)) + scaled(guided, along)
        jets = family.extent * derivatives(scaled(power(inner(along, along), -1.0), sums) + ruling)
        jets[0] += family.centre
        return np.asarray(jets)

    def image(self, matrix: Sequence[Sequence[Fraction]], shift: Sequence[Fraction]) -> Curve:
        """Return matrix @ curve + shift."""
        return image(self, matrix, shift)

    def part(self, low: Fraction, high: Fraction) -> Curve:
        """Return the part over [low, high]."""
        width = self.high - self.low
        return self.replace(low=self.low + float(low) * width, high=self.low + float(high) * width)


def _jet(series: Sequence[Array], t: Values, width: float, order: int) -> Array:
    """Return the power series at t of Chebyshev series, each (k, c), side by side, by a parameter of 1 over `width`.

    All derivatives of all series are sums of the same polynomials, which are evaluated once.
    """
    terms = max(map(len, series))
    whole = np.concatenate([np.pad(one, ((0, terms - len(one)), (0, 0))) for one in series], axis=1)
    rows = [whole]
    for _ in range(order):
        slopes = chebyshev.chebder(rows[-1]) * width if terms > 1 else np.zeros_like(whole)
        rows.append(np.pad(slopes, ((0, terms - len(slopes)), (0, 0))))
    return taylor(np.asarray(chebyshev.chebvander(t, terms - 1) @ np.stack(rows)))


@dataclass(frozen=True, slots=True, eq=False)
class Enveloped(ArrayValue):
    """The patch, and u and v of the vertices on it."""

    patch: RuledPatch
    places: Points2


def patch_of(mesh: Mesh, family: Family) -> Enveloped | None:
    """Return the patch that encloses the vertices, seen from the mesh's outside; None where it would fold."""
    x, t = (mesh.vertices - family.centre) / family.extent, family.t
    span = BESIDE * float(np.ptp(t))
    low, high = float(t.min()) - span, float(t.max()) + span
    guide = chebyshev.chebfit(t, x, min(GUIDE_DEGREE, len(family.planes) - 1))
    line = Edge(family, guide, np.zeros(1), low, high)
    along = Edge(family, guide, np.ones(1), low, high, 0.0)
    v = (t - low) / (high - low)
    foot, ruling = line.jet(v, 0)[0], along.jet(v, 0)[0]
    s = dot(mesh.vertices - foot, ruling) / family.extent**2
    sides = [-_enclosing(t, -s), _enclosing(t, s)]
    made = _patch(line, sides[0], sides[1])
    way = float(np.sum(dot(end_normals(frames(made, np.array([0.5])))[0], _facing(mesh, v)[None, :])))
    if way < 0.0:
        sides = sides[::-1]
        made = _patch(line, *sides)
    least, most = (chebyshev.chebval(t, side) for side in sides)
    every = regression(frames(made, np.linspace(0.0, 1.0, CHECKS)))
    if ((every > 0.0) & (every < 1.0)).any():
        return None
    return Enveloped(made, np.column_stack([(s - least) / (most - least), v]))


CHECKS = 257
"""Rulings on which the edge of regression is looked for."""


def _facing(mesh: Mesh, v: Values) -> Array:
    """Return the sum of the vector areas of the facets about the ruling in the middle, mm2."""
    areas = facets(mesh)[1]
    near = np.abs(v[mesh.faces].mean(axis=1) - MIDDLE) <= NEAR_MIDDLE
    return np.asarray(areas[near].sum(axis=0) if near.any() else areas.sum(axis=0))


MIDDLE, NEAR_MIDDLE = 0.5, 0.05
"""Share of v about the middle whose facets say which way the mesh faces: a few rows of them."""


def _patch(line: Edge, first: Array, last: Array) -> RuledPatch:
    """Return the patch between two distances along the rulings."""
    width = chebyshev.chebsub(last, first)
    return RuledPatch(line.replace(side=first), line.replace(side=last), line.replace(side=width, whole=0.0))


def _enclosing(t: Values, s: Values) -> Array:
    """Return a polynomial of t that is nowhere below the values, and little above the largest."""
    bins = np.minimum((t - t.min()) / np.ptp(t) * BINS, BINS - 1).astype(np.int64)
    most = np.full(BINS, -np.inf)
    np.maximum.at(most, bins, s)
    at = np.array([t[(bins == k) & (s == most[k])][0] for k in range(BINS) if np.isfinite(most[k])])
    series = chebyshev.chebfit(at, most[np.isfinite(most)], min(SIDE_DEGREE, at.size // 4))
    series[0] += float(np.max(s - chebyshev.chebval(t, series))) + BESIDE * float(np.ptp(s))
    return np.asarray(series)


# The chart


@dataclass(frozen=True, eq=False)
class Developed:
    """A patch laid flat, with the flat points of vertices to start from.

    known: u, v of vertices, shape (n, 2), and their flat positions.
    """

    patch: RuledPatch
    known: Points2

    @cached_property
    def piece(self) -> FlatPiece:
        """Return the flat patch.  Raises NoSolutionError where it does not resolve."""
        return develop((self.patch,)).pieces[0]

    @cached_property
    def flat(self) -> Points2:
        """Return the flat positions of the known places, mm."""
        return self.piece.positions(self.known[:, 0], self.known[:, 1])

    def places(self, points: Points2) -> Points2:
        """Return u and v of flat points, by Newton's method from the nearest known one.

        Raises NoSolutionError where it does not come to the point.
        """
        from scipy.spatial import KDTree

        at = self.known[KDTree(self.flat).query(points)[1]]
        with np.errstate(over="ignore", invalid="ignore"):  # what runs away is no number, and missed
            for _ in range(NEWTON):
                off = points - self.piece.positions(at[:, 0], at[:, 1])
                at = at + self._pulled(at, off)
            missed = float(norm(points - self.piece.positions(at[:, 0], at[:, 1])).max(initial=0.0))
        wanted = MET * diagonal(self.flat)
        if not missed <= wanted:  # also where it is no number
            raise NoSolutionError("place of a flat point on its patch", reached=missed, wanted=wanted, unit="mm")
        return np.asarray(at)

    def rates(self, points: Points2, slopes: Points2) -> Points2:
        """Return the rates of u and v at flat points that move."""
        return self._pulled(self.places(points), slopes)

    def _pulled(self, at: Points2, vectors: Points2) -> Points2:
        """Return flat vectors at places as vectors of u and v."""
        u, v = at.T
        by_u = self.piece.positions(np.ones_like(u), v) - self.piece.positions(np.zeros_like(u), v)
        by_v = self.piece.velocities(u, v)
        whole = cross2(by_u, by_v)
        pulled: Points2 = np.column_stack([cross2(vectors, by_v), cross2(by_u, vectors)]) / whole[:, None]
        return pulled


NEWTON = 4
"""Steps from a vertex beside the point: each squares the error, of a few hundredths at first."""
MET = 1e-10
"""Share of the pattern within which a point must be met: ten times the rounding of the development."""


def common(patch: RuledPatch) -> tuple[str, Points3, float]:
    """Return what the rulings have in common, how well: "cylinder" and their direction, or "cone" and their apex.

    The largest deviation is that of a direction (rad) or of a ruling from the apex (mm); a name of its own otherwise.
    """
    v = np.linspace(0.0, 1.0, CHECKS)
    c0, p = patch.c0.jet(v, 0)[0], patch.p.jet(v, 0)[0]
    e = p / norm(p)[:, None]
    mean = e.mean(axis=0)
    mean /= float(norm(mean))
    spread = float(norm(e - mean).max())
    across = np.eye(3) - e[:, :, None] * e[:, None, :]
    if spread <= SAME:
        return "general cylinder", mean[None, :], spread
    apex = np.linalg.lstsq(across.reshape(-1, 3), np.einsum("nij,nj->ni", across, c0).ravel(), rcond=None)[0]
    off = float(norm(np.einsum("nij,nj->ni", across, apex - c0)).max())
    if off <= SAME * float(norm(apex - c0).max()):
        return "general cone", apex[None, :], off
    return "developable", np.zeros((0, 3)), off


SAME = 1e-7
"""Directions, and distances as a share of the apex's, that are one."""
