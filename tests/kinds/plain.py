"""Ruled surfaces, cones, cylinders and what follows from one curve, over control points that lie close together."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from mpmath import mp, mpf

from tests import oracles
from tests.kinds.example import Pair, Rows, numbers, one, placed, point, points, unit
from tests.oracles import Space, Vec, add, dot, exact
from tests.parts import Table

APEX = [2, -3, 8]
CLUSTERED = [[0, 0, 0], ["0.01", "0.02", 0], ["0.04", "0.1", "0.01"], [3, 2, 1], [5, 1, 2], ["5.01", "0.97", 2]]
"""Control points close together at both ends: the speed along the curve changes 120-fold."""
WEIGHTED = [[3, 0, 0], [3, 3, "0.5"], [0, 4, 1], [-2, 3, 1]]
WEIGHTS = [1, "0.6", 2, "1.5"]


def weighted(rows: Rows, weights: Sequence[object], size: Fraction) -> Table:
    n = len(rows) - 1
    knots = [0] * (n + 1) + [1] * (n + 1)
    return {"bspline": {"degree": n, "knots": knots, "points": points(rows, size), "weights": weights}}


def shrunk(rows: Rows, share: str) -> list[list[str]]:
    """Return points brought a share of the way to the apex."""
    f = Fraction(share)
    return [[str((1 - f) * Fraction(str(x)) + f * a) for x, a in zip(row, APEX, strict=True)] for row in rows]


def ruled(size: Fraction) -> Table:
    return {"kind": "ruled", "c0": weighted(WEIGHTED, WEIGHTS, size),
            "c1": weighted(shrunk(WEIGHTED, "0.6"), WEIGHTS, size)}  # fmt: skip


def ruled_pairs() -> list[list[Pair]]:
    c0 = oracles.rational(WEIGHTED, WEIGHTS)
    return [[(c0, oracles.toward(c0, APEX, "0.6"))]]


def cone(size: Fraction) -> Table:
    return {"kind": "cone", "apex": point(APEX, size), "directrix": {"bezier": points(CLUSTERED, size)},
            "fraction": ["0.15", "0.8"]}  # fmt: skip


def plain_cone_pairs() -> list[list[Pair]]:
    r = oracles.bezier(CLUSTERED)
    return [[(oracles.toward(r, APEX, "0.15"), oracles.toward(r, APEX, "0.8"))]]


DIRECTION = [1, -1, 3]
CUTS = ([0, 0, -1], ["0.1", "-0.2", 1]), ([0, 0, 6], ["-0.3", "0.1", 1])
"""Point and normal of the planes at both ends."""


def cylinder(size: Fraction) -> Table:
    planes = {
        key: {"point": point(at, size), "normal": normal}
        for key, (at, normal) in zip(("start_plane", "end_plane"), CUTS, strict=True)
    }
    return {"kind": "cylinder", "directrix": {"bezier": points(CLUSTERED, size)}, "direction": DIRECTION} | planes


def slid(r: Space, at: Sequence[object], normal: Sequence[object]) -> Space:
    """Return where the rulings from r meet a plane."""
    d, n, P = (numbers(row) for row in (DIRECTION, normal, at))

    def jet(v: mpf) -> oracles.Jet:
        position, slope, bend = r(v)
        reach = dot(add(P, position, -1), n) / dot(d, n)
        return add(position, d, reach), add(slope, d, -dot(slope, n) / dot(d, n)), bend

    return jet


def cylinder_pairs() -> list[list[Pair]]:
    r = oracles.bezier(CLUSTERED)
    return [[(slid(r, *CUTS[0]), slid(r, *CUTS[1]))]]


PAIR_POINTS = [[0, 0, 0], ["0.2", "0.1", "0.1"], [2, "1.3", "0.6"], [4, "1.2", 3], ["4.1", "1.5", "3.2"]]
PAIR_FIRST = ["0.1", "0.4", 2]


def bezier_pair(size: Fraction) -> Table:
    return {"kind": "bezier-pair", "points": points(PAIR_POINTS, size), "first": point(PAIR_FIRST, size),
            "lambda": "1.7", "mu": "2.6", "elevate": 1}  # fmt: skip


def pair_pairs() -> list[list[Pair]]:
    """d_{i+1} = ((1 - L) c_i + L c_{i+1} - (1 - M) d_i) / M over the elevated points."""
    given = [numbers(row) for row in PAIR_POINTS]
    n = len(given)
    c = [given[0], *(tuple(mpf(i) / n * a + (1 - mpf(i) / n) * b for a, b in zip(given[i - 1], given[i], strict=True))
                     for i in range(1, n)), given[-1]]  # fmt: skip
    L, M, d = exact("1.7"), exact("2.6"), [numbers(PAIR_FIRST)]
    for a, b in pairwise(c):
        d.append(tuple(((1 - L) * x + L * y - (1 - M) * z) / M for x, y, z in zip(a, b, d[-1], strict=True)))
    return [[(oracles.bezier_of(c), oracles.bezier_of(d))]]


EDGE = [[0, 0, 0], ["0.1", 0, "0.02"], [2, "1.3", "0.6"], ["2.5", 4, "1.8"], [1, 5, 4]]


def tangent(size: Fraction) -> Table:
    return {"kind": "tangent", "edge": {"bezier": points(EDGE, size)}, "from": one("0.5", size), "to": one(3, size)}


def tangent_pairs() -> list[list[Pair]]:
    r = oracles.bezier(EDGE)

    def along(distance: str) -> Space:
        return placed(lambda v: add(r(v)[0], unit(r(v)[1]), exact(distance)))

    return [[(along("0.5"), along("3"))]]


LEVEL = [[0, 0, 2], ["0.1", "0.3", 2], [3, 5, 2], [8, 4, 2], ["8.1", 0, 2]]


def slope(size: Fraction) -> Table:
    return {"kind": "slope", "curve": {"bezier": points(LEVEL, size)}, "angle": 35, "side": "in",
            "length": one("2.4", size)}  # fmt: skip


def slope_pairs() -> list[list[Pair]]:
    """Left of travel, and down, since z is up."""
    r, angle = oracles.bezier(LEVEL), mp.radians(35)

    def lower(v: mpf) -> Vec:
        position, slope, _ = r(v)
        x, y, _ = unit(slope)
        length = exact("2.4")
        return add(position, (-length * mp.cos(angle) * y, length * mp.cos(angle) * x, -length * mp.sin(angle)))

    return [[(r, placed(lower))]]
