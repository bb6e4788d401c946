"""Every length, ruling, angle, area and position of both sides against 40 digits, from 1 mm to 10 m.

Directrices of even and of uneven speed.  The oracles use other formulas (`tests.oracles`), and know the plain directrix
alone: a patch over another parameter must have the figures of the plain one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from mpmath import mp, mpf

from stages.geometry.arrays import Array
from stages.geometry.curves.curves import Circular
from stages.geometry.flat.development import develop
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.unroll.nodes import at_nodes
from stages.unroll.sides import flat_area, flat_edges, surface_figures
from tests import oracles
from tests.near import assert_near, assert_relative
from tests.oracles import Space
from tests.parts import (
    AUMANN_CUBIC,
    ELLIPTIC_CYLINDER,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    TAN_30,
    Table,
    patches,
)
from tests.rewritten import AT_REST, UNEVEN, Polynomial, reparametrised, value
from tests.strategies import scaled

Pair = tuple[Space, Space]
PLAIN: Polynomial = (Fraction(0), Fraction(1))
FULL = 2 * mp.pi
ELLIPSE = oracles.turning((0, 0, 0), (5, 0, 0), (0, 2, 0), (0, 0, 0), FULL)
CIRCLE = oracles.turning((0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 0), FULL)
CUT = oracles.turning((0, 0, 5), (2, 0, 2 * Fraction(TAN_30)), (0, 2, 0), (0, 0, 0), FULL)
OBLIQUE_TOP = oracles.turning(("1.125", "0.375", 3), ("0.5", 0, 0), (0, "0.5", 0), (0, 0, 0), FULL)
STEP = mpf(3) / mp.sqrt(mpf(5) / 4)

CLUSTERED = [[0, 0, 0], ["0.01", "0.02", 0], ["0.04", "0.1", "0.01"], [3, 2, 1], [5, 1, 2], ["5.01", "0.97", 2]]
"""Control points close together at both ends: the speed along the curve changes 120-fold."""
WEIGHTED = [[3, 0, 0], [3, 3, "0.5"], [0, 4, 1], [-2, 3, 1]]
WEIGHTS = [1, "0.6", 2, "1.5"]
RATIONAL: Table = {"degree": 3, "knots": [0] * 4 + [1] * 4, "points": WEIGHTED, "weights": WEIGHTS}
APEX = [1, -1, 6]


def lifted(v: mpf) -> oracles.Jet:
    """The elliptic cylinder's upper edge: 3 mm along (0, 1/2, 1)."""
    position, slope, bend = ELLIPSE(v)
    return oracles.add(position, (mpf(0), STEP / 2, STEP)), slope, bend


def pair(table: Table) -> Pair:
    c0, c1 = table["c0"], table["c1"]
    assert isinstance(c0, dict)
    assert isinstance(c1, dict)
    return oracles.bezier(c0["bezier"]), oracles.bezier(c1["bezier"])


def over(directrix: Table, curve: Space) -> tuple[Table, Pair]:
    """Return the cone over a directrix, from a quarter to nine tenths of the way to the apex."""
    table = {"kind": "cone", "apex": APEX, "directrix": directrix, "fraction": ["0.25", "0.9"]}
    return table, (oracles.toward(curve, APEX, "0.25"), oracles.toward(curve, APEX, "0.9"))


def helix_tangents() -> RuledPatch:
    """Return tangents from 1 to 4 mm of two turns of (3 cos a, 3 sin a, 4 a): T = (-3 sin a, 3 cos a, 4) / 5."""
    x, y, z = np.eye(3)

    def rail(reach: float) -> Circular:
        s = 3.0 * reach / 5.0
        return Circular(4.0 * reach / 5.0 * z, 3.0 * x + s * y, 3.0 * y - s * x, 4.0 * z, 0.0, 4.0 * np.pi)

    return between(rail(1.0), rail(4.0))


def helix_rail(reach: int) -> Space:
    s = Fraction(3 * reach, 5)
    return oracles.turning((0, 0, Fraction(4 * reach, 5)), (3, s, 0), (-s, 3, 0), (0, 0, 4), 2 * FULL)


@dataclass(frozen=True)
class Case:
    """A patch, its edges at 40 digits, the polynomial that takes its parameter to theirs, its size in mm."""

    patch: Callable[[], RuledPatch]
    edges: Pair
    size: int
    inner: Polynomial = PLAIN


def case(table: Table, edges: Pair, size: int, inner: Polynomial = PLAIN) -> Case:
    def patch() -> RuledPatch:
        (plain,) = patches(table)
        return plain if inner is PLAIN else reparametrised(plain, inner)

    return Case(patch, edges, size, inner)


CASES = {
    "quintic tangent surface": case(QUINTIC_TANGENT, pair(QUINTIC_TANGENT), 1000),
    "quintic tangent surface, at rest at both ends": case(QUINTIC_TANGENT, pair(QUINTIC_TANGENT), 1000, AT_REST),
    "Aumann's cubic": case(AUMANN_CUBIC, pair(AUMANN_CUBIC), 4),
    "Aumann's cubic, uneven speed": case(AUMANN_CUBIC, pair(AUMANN_CUBIC), 4, UNEVEN),
    "oblique cone": case(OBLIQUE_CONE, (CIRCLE, OBLIQUE_TOP), 5),
    "cone over an ellipse": case(*over({"ellipse": {"center": [0, 0, 0], "major": [5, 0, 0], "minor": [0, 2, 0]}},
                                       ELLIPSE), 10),
    "cone over a rational curve": case(*over({"bspline": RATIONAL}, oracles.rational(WEIGHTED, WEIGHTS)), 6),
    "cone over clustered points": case(*over({"bezier": CLUSTERED}, oracles.bezier(CLUSTERED)), 6),
    "cone over clustered points, uneven": case(*over({"bezier": CLUSTERED}, oracles.bezier(CLUSTERED)), 6, UNEVEN),
    "elliptic cylinder": case(ELLIPTIC_CYLINDER, (ELLIPSE, lifted), 10),
    "mitred cylinder": case(MITRED_CYLINDER, (CIRCLE, CUT), 6),
    "tangents of a helix": Case(helix_tangents, (helix_rail(1), helix_rail(4)), 10),
}  # fmt: skip

U, V = (axis.ravel() for axis in np.meshgrid([0.0, 0.45, 1.0], [0.1, 0.37, 0.8, 1.0]))


def test_the_oracles_agree_with_closed_forms() -> None:
    top = oracles.turning((0, 0, 4), ("1.5", 0, 0), (0, "1.5", 0), (0, 0, 0), FULL)
    base = oracles.turning((0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 0), FULL)
    slant = mp.sqrt(mpf(4) ** 2 + mpf("1.5") ** 2)
    assert abs(oracles.area(base, top) - mp.pi * mpf("4.5") * slant) < mpf(10) ** -30
    assert abs(oracles.sector(base, (0, 0, 8)) - 2 * mp.pi * 3 / (2 * slant)) < mpf(10) ** -30
    x, y = oracles.flat_map(base, top)(0, 1)
    angle = 2 * mp.pi * mpf("1.5") / slant
    reach = 2 * slant
    assert abs(x - (reach - reach * mp.cos(angle))) + abs(y - reach * mp.sin(angle)) < mpf(10) ** -22


@cache
def at_40_digits(name: str) -> tuple[dict[str, float], Array]:
    """Return the lengths, the area and the flat positions at U, V of a case, rounded from 40 digits."""
    c0, c1 = CASES[name].edges
    exact = oracles.flat_map(c0, c1)
    figures = {"c0": oracles.length(c0), "c1": oracles.length(c1), "area": oracles.area(c0, c1)}
    for end, v in (("start", mpf(0)), ("end", mpf(1))):
        figures[end] = oracles.norm(oracles.add(c1(v)[0], c0(v)[0], -1))
    places = [exact(mpf(u), value(CASES[name].inner, mpf(v))) for u, v in zip(U, V, strict=True)]
    return {key: float(figure) for key, figure in figures.items()}, np.array(places, dtype=float)


@pytest.mark.parametrize("extent", [1, 10_000])
@pytest.mark.parametrize("name", CASES)
def test_figures_of_both_sides_are_those_of_40_digits(name: str, extent: int) -> None:
    figures, places = at_40_digits(name)
    factor = Fraction(extent, CASES[name].size)
    patch = scaled(CASES[name].patch(), factor)
    (piece,) = develop((patch,)).pieces
    nodes = [at_nodes(piece)]
    surface, area = surface_figures((patch,))
    for edges, covered in ((surface, area), (flat_edges(nodes), flat_area(nodes))):
        found = [length / float(factor) for length in edges.by_name().values()]
        expected = [figures[key] for key in edges.by_name()]
        assert_relative(found, expected, bound=BOUND, why="two quadratures of 1e-14, and a directrix in doubles")
        assert_relative([covered / float(factor) ** 2], [figures["area"]], bound=BOUND, why="the same")
    flat = piece.positions(U, V) / float(factor)
    assert_near(flat, places, bound=3e-14 * float(np.abs(places).max()), why="some 1e-14 of the size")
    rulings = flat.reshape(-1, 3, 2)[:, 2] - flat.reshape(-1, 3, 2)[:, 0]
    exact = places.reshape(-1, 3, 2)[:, 2] - places.reshape(-1, 3, 2)[:, 0]
    turned = np.arctan2(rulings[:, 1], rulings[:, 0]) - np.arctan2(exact[:, 1], exact[:, 0])
    assert_near(np.sin(turned), 0.0 * turned, bound=1e-12, why="as asked, of angles of up to 4 rad")


BOUND = 1e-13
"""A tenth of what is asked: lengths and areas of directrices in doubles, by some 1e3 positive terms."""
