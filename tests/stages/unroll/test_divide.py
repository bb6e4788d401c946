"""Parts divided along rulings: how many and where by closed forms, exact blanks, v of the part."""

from fractions import Fraction
from itertools import pairwise
from math import ceil, hypot, pi

import numpy as np
import pytest

from stages.geometry.curves.curves import Circular, Curve
from stages.geometry.flat.development import develop
from stages.geometry.paths import arcpath
from stages.geometry.ruled import ruled
from stages.model.surface import Certificate, RuledSurface, whole_spans
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.unroll.divide import STEPS, blanks, division, run_outline, strip_of
from tests.near import assert_near, assert_relative
from tests.parts import QUINTIC_TANGENT, RIGHT_FRUSTUM, Table, part, passage, patches

TOL = Tolerances()
ZIGZAG = [
    [10, 0, 0],
    [5, 5, 8],
    [0, 10, 0],
    [-5, 5, -8],
    [-10, 0, 0],
    [-5, -5, 8],
    [0, -10, 0],
    [5, -5, -8],
    [10, 0, 0],
]
WAVY: Table = {"kind": "cone", "apex": [0, 0, 0], "directrix": {"polyline": ZIGZAG}}
"""Eight triangles of 62.07 deg each at the apex, 496.6 deg in all."""


def helix_strip(radius: float, pitch: float, turns: float, *, pieces: int = 1, cut: str = "auto") -> RuledSurface:
    """Tangents of a helix from 5 to 60 mm along them: flat, a ring whose turns are radius / slant of a full one."""
    h = pitch / (2 * pi)
    slant = hypot(radius, h)

    def edge(d: float, k: int) -> Curve:
        U, V = np.array([radius, d * radius / slant, 0.0]), np.array([-d * radius / slant, radius, 0.0])
        sweep = 2 * pi * turns / pieces
        return Circular(np.array([0.0, 0.0, d * h / slant]), U, V, np.array([0.0, 0.0, h]), k * sweep, sweep)

    patches = tuple(ruled.between(edge(5.0, k), edge(60.0, k)) for k in range(pieces))
    return RuledSurface(part(RIGHT_FRUSTUM, cut=cut), patches, ruled.size_of(patches), whole_spans(pieces))


def certified(surface: RuledSurface) -> Certificate:
    return Certificate(surface, "exact", proved=True)


def certificate(table: Table, cut: str) -> Certificate:
    found = passage(table, cut=cut).certificate
    assert found is not None
    return found


def surface_of(blank: Certificate) -> RuledSurface:
    assert isinstance(blank.surface, RuledSurface)
    return blank.surface


def test_the_outline_that_is_looked_at_is_of_arcs_through_the_pattern() -> None:
    """Of a frustum a sector of a ring: from 1/8 to 3/4 of its v it has 5/8 of the area, and its four sides."""
    strip = strip_of(develop(patches(RIGHT_FRUSTUM)))
    slant = hypot(1.5, 4.0)
    for low, high in ((0, STEPS), (STEPS // 8, STEPS * 3 // 4)):
        share = (high - low) / STEPS
        path = run_outline(strip, low, high)
        assert_relative(arcpath.area(path), share * pi * 4.5 * slant, bound=1e-12, why="arcs of circles, exactly")
        around = share * 2.0 * pi * 4.5 + 2.0 * slant
        assert_relative(float(arcpath.lengths(path).sum()), around, bound=1e-12, why="both arcs and both rulings")


@pytest.mark.parametrize("table", [RIGHT_FRUSTUM, QUINTIC_TANGENT, RIGHT_FRUSTUM | {"radius1": 0, "height": 0}])
def test_a_part_that_does_not_overlap_is_not_divided(table: Table) -> None:
    whole = certificate(table, "auto")
    assert blanks(whole, TOL) == (whole,)


def test_a_part_is_divided_on_request_only() -> None:
    whole = certificate(WAVY, "none")
    assert blanks(whole, TOL) == (whole,)
    refused = passage(WAVY)
    assert refused.codes("unroll", fatal=True) == ["flat-overlap"]
    assert 'cut = "auto"' in refused.reports["unroll"].findings[-1].message


def test_a_cone_of_more_than_a_full_turn_is_divided_in_the_middle() -> None:
    pieces = blanks(certificate(WAVY, "auto"), TOL)
    assert [surface_of(piece).part.name for piece in pieces] == ["part.1", "part.2"]
    assert [surface_of(piece).spans[0][0] for piece in pieces] == [0, 4]
    assert all(surface_of(piece).part.spec.cut == "none" for piece in pieces)
    for piece in pieces:
        made = unroll(piece, TOL)
        assert made.product is not None
        assert made.report.metric("overlap_mm2").value == 0.0
        assert made.product.part == surface_of(piece).part.name


@pytest.mark.parametrize(
    ("pitch", "turns", "pieces"), [(60.0, 3.0, 1), (600.0, 3.0, 3), (300.0, 2.5, 1), (60.0, 1.004, 1)]
)
def test_a_helical_strip_takes_as_few_blanks_as_its_turning_asks_for(pitch: float, turns: float, pieces: int) -> None:
    surface = helix_strip(100.0, pitch, turns, pieces=pieces)
    full = turns * 100.0 / hypot(100.0, pitch / (2 * pi))
    found = [surface_of(blank) for blank in blanks(certified(surface), TOL)]
    assert len(found) == ceil(full)
    if len(found) == 1:
        return
    ends = [*(blank.spans[0][0] for blank in found), found[-1].spans[-1][1]]
    assert ends[0] == 0 and ends[-1] == pieces
    shares = np.diff([float(end) / pieces for end in ends])
    assert_near(shares, np.full(len(found), 1 / len(found)), bound=2 / 256, why="evened out to 1/256 of the area")


def test_the_blanks_are_exact_parts_and_their_v_is_the_part_s() -> None:
    surface = helix_strip(100.0, 60.0, 3.0)
    found = [surface_of(blank) for blank in blanks(certified(surface), TOL)]
    for before, after in pairwise(found):
        assert before.spans[-1][1] == after.spans[0][0]
    for blank in found:
        (patch,), (span,) = blank.patches, blank.spans
        assert span[0] * 4096 == int(span[0] * 4096)
        local = np.linspace(0.0, 1.0, 7)
        v = np.array([blank.v_of(0, float(x)) for x in local])
        for u in (0.0, 1.0):
            here, there = (ruled.at(p, np.full(7, u), x) for p, x in ((patch, local), (surface.patches[0], v)))
            assert_near(here, there, bound=64 * np.finfo(float).eps * surface.size_mm, why="angles of 19 rad, rounded")
        assert_near(blank.size_mm, ruled.size_of(blank.patches), bound=0.0, why="its own box")


def test_the_areas_of_the_blanks_add_up_to_that_of_the_part() -> None:
    """Ring sectors of the flat: half the difference of the squares of both distances times the turning."""
    surface = helix_strip(100.0, 60.0, 3.0)
    found = [unroll(blank, TOL) for blank in blanks(certified(surface), TOL)]
    areas = [outcome.report.detail["flat"]["area"] for outcome in found]  # type: ignore[index]
    turning = 3.0 * 2 * pi * 100.0 / hypot(100.0, 60.0 / (2 * pi))
    assert_relative(float(np.sum(areas)), 0.5 * (60.0**2 - 5.0**2) * turning, bound=1e-12, why="closed form")


def test_a_blank_says_between_which_rulings_it_lies() -> None:
    first, second = (surface_of(blank) for blank in blanks(certificate(WAVY, "auto"), TOL))
    assert [finding.where for finding in (*division(first), *division(second))] == [
        {"v": 0.0, "v_end": 4.0}, {"v": 4.0, "v_end": 8.0}]  # fmt: skip
    assert division(surface_of(certificate(WAVY, "auto"))) == ()


def test_a_blank_may_be_divided_again_and_keeps_the_part_s_v() -> None:
    surface = helix_strip(100.0, 60.0, 3.0)
    later = surface.part.spec.blank(1)
    shifted = RuledSurface(surface.part, surface.patches, surface.size_mm, ((Fraction(2), Fraction(5)),))
    found = [surface_of(blank) for blank in blanks(certified(shifted), TOL)]
    assert later.cut == "none" and found[0].spans[0][0] == 2 and found[-1].spans[-1][1] == 5
    assert_near(float(found[0].spans[0][1]), 3.0, bound=3 * 2 / 256, why="a third of three")
