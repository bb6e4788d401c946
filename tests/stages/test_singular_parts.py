"""Parts at singular places of the formulas: lengths and areas to 1e-10 of closed forms and 40 digits, or the ruling
that stands in the way named by its v."""

from fractions import Fraction
from itertools import pairwise
from math import asinh, hypot, pi, sqrt

import pytest
from mpmath import mp, mpf

from stages.model.tolerances import Tolerances
from tests.near import assert_near
from tests.oracles import Space, area, bezier, combined, cross, fixed, length, norm
from tests.parts import EXAMPLE_1, RIGHT_FRUSTUM, Passage, Table, passage

METAL = Tolerances(accept="metal")
Figures = dict[str, float]
Rows = list[list[object]]


def ruled(c0: Table, c1: Table) -> Table:
    return {"kind": "ruled", "c0": c0, "c1": c1}


def cylinder(profile: Table, direction: Rows | list[object], size: object) -> Table:
    return {"kind": "cylinder", "directrix": profile, "direction": direction, "length": size}


def cone(directrix: Table, apex: list[object], **keys: object) -> Table:
    return {"kind": "cone", "directrix": directrix, "apex": apex} | keys


def tangents(points: Rows, near: str, far: str) -> Table:
    """The surface between r + near r' and r + far r' of a Bezier curve r, exact."""
    rows = [[Fraction(str(x)) for x in point] for point in points]
    n = len(rows) - 1
    slopes = [[n * (b - a) for a, b in zip(p, q, strict=True)] for p, q in pairwise(rows)]
    raised = [slopes[0]] + [
        [Fraction(i, n) * a + (1 - Fraction(i, n)) * b for a, b in zip(slopes[i - 1], slopes[i], strict=True)]
        for i in range(1, n)
    ] + [slopes[-1]]  # fmt: skip

    def curve(share: Fraction) -> Table:
        made = [[a + share * b for a, b in zip(p, d, strict=True)] for p, d in zip(rows, raised, strict=True)]
        return {"bezier": [[str(x) for x in point] for point in made]}

    return ruled(curve(Fraction(near)), curve(Fraction(far)))


SPACE_CUBIC: Rows = [[0, 0, 0], [10, 0, 0], [20, 10, 0], [20, 20, 15]]
ARCH: Rows = [[0, 0, 0], [1, 2, 0], [2, -2, 0], [3, 0, 0]]
AT_REST: Rows = [[0, 0, 0], [0, 0, 0], [1, 1, 0], [2, 0, 0]]
LEANING: Rows = [[0, 0, 0], [1, 1, 0], [2, 0, "0.5"]]
INTO_APEX: Rows = [[0, 0, 0], [0, 1, 0], [1, 1, 2]]


def tangent_figures(points: Rows) -> Figures:
    """c0 = r, p = r'/2: area |r' x r''| / 8, c1' = r' + r''/2."""
    r = bezier(points)
    first, last = r(mpf(0)), r(mpf(1))

    def density(v: mpf) -> mpf:
        _, slope, bend = r(v)
        return norm(cross(slope, bend)) / 8

    def speed(v: mpf) -> mpf:
        _, slope, bend = r(v)
        return norm(tuple(a + b / 2 for a, b in zip(slope, bend, strict=True)))

    return {"area": float(mp.quad(density, mp.linspace(0, 1, 9))), "c0": float(length(r)),
            "c1": float(mp.quad(speed, mp.linspace(0, 1, 9))), "start": float(norm(first[1]) / 2),
            "end": float(norm(last[1]) / 2)}  # fmt: skip


def exchanged(figures: Figures) -> Figures:
    return figures | {"c0": figures["c1"], "c1": figures["c0"]}


def of_directrices(c0: Space, c1: Space) -> Figures:
    ends = [float(norm(tuple(b - a for a, b in zip(c0(v)[0], c1(v)[0], strict=True)))) for v in (mpf(0), mpf(1))]
    return {"area": float(area(c0, c1)), "c0": float(length(c0)), "c1": float(length(c1)),
            "start": ends[0], "end": ends[1]}  # fmt: skip


def along(points: Rows, direction: list[object], size: object) -> Figures:
    profile = bezier(points)
    long = norm(fixed(direction)(mpf(0))[0])
    return of_directrices(profile, combined(profile, fixed(direction), mpf(str(size)) / long))


def to_apex(points: Rows, apex: list[object]) -> Figures:
    directrix = bezier(points)
    figures = of_directrices(directrix, combined(fixed(apex), directrix, 0))
    return figures | {"c1": 0.0}


PARABOLA = 2 * sqrt(2) * 5 + 2 * asinh(1.0) * 5
"""Length of y = x (10 - x) / 10 over [0, 10]: slopes from 1 to -1."""
TANGENT = tangents(SPACE_CUBIC, "0", "1/2")
SQUARE: Rows = [[10, 0, 0], [0, 10, 0], [-10, 0, 0], [0, -10, 0]]
CASES: dict[str, tuple[Table, Figures]] = {
    "apex at the end of all rulings": (RIGHT_FRUSTUM | {"radius1": 0}, {
        "area": 15 * pi, "c0": 6 * pi, "c1": 0.0, "start": 5.0, "end": 5.0}),
    "apex at their beginning": (RIGHT_FRUSTUM | {"radius0": 0, "radius1": 3}, {
        "area": 15 * pi, "c0": 0.0, "c1": 6 * pi, "start": 5.0, "end": 5.0}),
    "apex in the plane of the directrix, inside": (cone({"circle": {"center": [0, 0, 0], "radius": 10}}, [1, 0, 0]), {
        "area": 100 * pi, "c0": 20 * pi, "c1": 0.0, "start": 9.0, "end": 9.0}),
    "apex on the tangent at an end": (cone({"bezier": INTO_APEX}, [0, 4, 0]), to_apex(INTO_APEX, [0, 4, 0])),
    "apex over a polyline": (cone({"polyline": SQUARE}, [0, 0, 9]), {
        "area": 1.5 * sqrt(90**2 + 90**2 + 100**2), "c0": 30 * sqrt(2), "c1": 0.0,
        "start": hypot(10, 9), "end": hypot(10, 9)}),
    "first ruling of no length": (ruled({"line": [[0, 0, 0], [3, 0, 0]]}, {"line": [[0, 0, 0], [3, 4, 0]]}), {
        "area": 6.0, "c0": 3.0, "c1": 5.0, "start": 0.0, "end": 4.0}),
    "last ruling of no length": (ruled({"line": [[0, 0, 0], [3, 0, 0]]}, {"line": [[0, 4, 0], [3, 0, 0]]}), {
        "area": 6.0, "c0": 3.0, "c1": 5.0, "start": 4.0, "end": 0.0}),
    "edge of regression along c0": (TANGENT, tangent_figures(SPACE_CUBIC)),
    "edge of regression along c1": (
        {"kind": "ruled", "c0": TANGENT["c1"], "c1": TANGENT["c0"]}, exchanged(tangent_figures(SPACE_CUBIC))),
    "rulings along the directrices at both ends (Theorem 2.1)": (EXAMPLE_1, {
        "area": 299.0982744480111135262917, "c0": 78.21368602419299362810307, "c1": 78.27151246658052083249767,
        "start": 4.0, "end": 4.0}),
    "ruling along the directrix at the start": (
        cylinder({"bezier": LEANING}, [1, 1, 0], 5), along(LEANING, [1, 1, 0], 5)),
    "inflection": (cylinder({"bezier": ARCH}, [0, 0, 1], 5), along(ARCH, [0, 0, 1], 5)),
    "inflection of a cone": (cone({"bezier": ARCH}, [1, 1, 6]), to_apex(ARCH, [1, 1, 6])),
    "directrix that starts at rest": (cylinder({"bezier": AT_REST}, [0, 0, 1], 5), along(AT_REST, [0, 0, 1], 5)),
    "directrices that stop inside and go on": (
        cylinder({"bezier": [[-1, 0, 0], [1, 0, 0], [-1, 0, 0], [1, 0, 0]]}, [0, 0, 1], 5), {
            "area": 10.0, "c0": 2.0, "c1": 2.0, "start": 5.0, "end": 5.0}),
    "corner at a knot of full multiplicity": (
        cylinder({"bspline": {"degree": 2, "knots": [0, 0, 0, 1, 1, 2, 2, 2],
                              "points": [[0, 0, 0], [5, 5, 0], [10, 0, 0], [15, 5, 0], [20, 0, 0]]}}, [0, 0, 1], 7), {
            "area": 7 * PARABOLA, "c0": PARABOLA, "c1": PARABOLA, "start": 7.0, "end": 7.0}),
    "corners and an arc in a chain": (
        cylinder({"chain": [{"line": [[0, 0, 0], [10, 0, 0]]},
                            {"arc": {"center": [10, 5, 0], "radius": 5, "start": -90, "end": 0}},
                            {"line": [[15, 5, 0], [21, 9, 0]]}]}, [0, 0, 1], 3), {
            "area": 3 * (10 + 2.5 * pi + hypot(6, 4)), "c0": 10 + 2.5 * pi + hypot(6, 4), "start": 3.0, "end": 3.0}),
    "polyline that doubles back": (
        ruled({"polyline": [[0, 0, 0], [2, 0, 0], [1, 0, 0]]}, {"polyline": [[0, 0, 1], [2, 0, 1], [1, 0, 1]]}), {
            "area": 3.0, "c0": 3.0, "c1": 3.0, "start": 1.0, "end": 1.0}),
    "plane piece, then a fold": (
        ruled({"polyline": [[0, 0, 0], [4, 0, 0], [4, 3, 4]]}, {"polyline": [[0, 2, 0], [2, 2, 0], [2, 5, 4]]}), {
            "area": 6.0 + sqrt(164.0), "c0": 9.0, "c1": 7.0, "start": 2.0, "end": sqrt(8.0)}),
}  # fmt: skip


@pytest.fixture(scope="module", params=CASES)
def made(request: pytest.FixtureRequest) -> tuple[Passage, Figures]:
    table, figures = CASES[request.param]
    return passage(table, METAL), figures


@pytest.mark.parametrize("side", ["surface", "flat"])
def test_a_singular_part_has_the_lengths_and_the_area_of_its_closed_form(
    made: tuple[Passage, Figures], side: str
) -> None:
    found, figures = made
    assert found.pattern is not None, [report.findings for report in found.reports.values()]
    reached = found.side(side)
    edges = reached["edges"]
    assert isinstance(edges, dict)
    size = max(value for name, value in figures.items() if name != "area")
    for name, value in figures.items():
        if name == "area":
            assert_near(reached["area"], value, bound=1e-10 * size**2, why=f"as asked: area of the {side}")
        else:
            assert_near(edges[name], value, bound=1e-10 * size, why=f"as asked: {name} of the {side}")


def test_a_singular_part_unrolls_without_strain(made: tuple[Passage, Figures]) -> None:
    found, _ = made
    for name in ("length_error", "area_error", "max_strain"):
        assert_near(found.value("unroll", name), 0.0, bound=1e-9, why="an isometry, next to its singular places too")


CUSP: Rows = [[0, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0]]
CIRCLE: Table = {"circle": {"center": [0, 0, 0], "radius": 10}}
REFUSED: dict[str, tuple[Table, str, str, tuple[float, ...]]] = {
    "apex on the directrix, inside": (
        cone({"bezier": [[-1, 0, 0], [0, 2, 0], [1, 0, 0]]}, [0, 1, 0]), "construct", "apex-on-directrix", (0.5,)),
    "apex on a tangent inside": (
        cone(CIRCLE, [20, 0, 0]), "verify", "singular-ruling", (1 / 6, 5 / 6)),
    "edges that cross": (
        ruled({"line": [[0, 0, 0], [3, 0, 0]]}, {"line": [[0, 1, 0], [3, -2, 0]]}), "verify", "zero-ruling", (1 / 3,)),
    "edge of regression inside": (tangents(SPACE_CUBIC, "-1/4", "1/2"), "verify", "edge-of-regression", ()),
    "cusp of the directrix": (
        cylinder({"bezier": CUSP}, [0, 0, 1], 5), "verify", "cusp", (0.5,)),
    "ruling along the directrix inside": (
        cylinder(CIRCLE, [1, 0, 0], 5), "verify", "singular-ruling", (0.25, 0.75)),
    "pipe cut through its start": (
        {"kind": "cylinder", "directrix": CIRCLE, "direction": [0, 0, 1],
         "end_plane": {"point": [0, 0, 0], "normal": [1, 0, 1]}}, "verify", "zero-ruling", (0.25, 0.75)),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_part_that_cannot_be_made_is_refused_with_the_ruling(name: str) -> None:
    table, stage, code, places = REFUSED[name]
    found = passage(table, METAL)
    assert found.refused_by == stage
    fatal = [finding for finding in found.reports[stage].findings if finding.fatal]
    assert code in [finding.code for finding in fatal]
    where = next(finding.where for finding in fatal if finding.code == code)
    assert where is not None
    assert 0.0 <= float(where["v"]) <= 1.0
    if places:
        assert min(abs(float(where["v"]) - place) for place in places) < 1e-6, where


def test_the_ruling_of_a_strip_is_named_by_the_v_of_the_part() -> None:
    """The second piece of three shrinks to nothing in its middle."""
    table = ruled({"polyline": [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]},
                  {"polyline": [[0, 1, 0], [1, 1, 0], [2, -1, 0], [3, -1, 0]]})  # fmt: skip
    found = passage(table, METAL)
    (finding,) = [finding for finding in found.reports["verify"].findings if finding.code == "zero-ruling"]
    assert finding.where is not None
    assert_near(float(finding.where["v"]), 1.5, bound=1e-6, why="the middle of piece 1")
