"""Tees with the main's opening: the plate, its seam with the branch to rounding, its marks, refusals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp

from stages.construct import construct
from stages.construct.sets import Edges, Seam, parts_of, seams_of
from stages.geometry.arrays import norm
from stages.geometry.curves import contours
from stages.model.ducts import is_set
from stages.model.features import CurveMark, PointMark
from stages.model.material import Part
from stages.model.surface import Plate, RuledSurface
from stages.unroll import unroll
from stages.unroll.sides import surface_figures
from stages.verify import verify
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, Table, part

TEE: Table = {"kind": "tee", "branch": 120, "main": 200, "length": 260, "angle": 60, "offset": 20, "hole": True}


def blanks(table: Table) -> tuple[RuledSurface, Plate]:
    branch, hole = (construct(blank, DEFAULT).product for blank in parts_of(part(table)))
    assert isinstance(branch, RuledSurface) and isinstance(hole, Plate)
    return branch, hole


def flat(blank: Part) -> dict[str, object]:
    made = construct(blank, DEFAULT).product
    assert made is not None
    certificate = verify(made, DEFAULT).product
    assert certificate is not None
    figures = unroll(certificate, DEFAULT).report.detail["flat"]
    assert isinstance(figures, dict)
    return figures


def test_a_tee_is_one_blank_and_with_its_hole_two() -> None:
    assert [blank.name for blank in parts_of(part(TEE))] == ["part.1", "part.2"]
    assert seams_of(part(TEE)) == (Seam(Edges("part.1", ("c1",)), Edges("part.2", ("outline",))),)
    alone = part(TEE | {"hole": False})
    assert parts_of(alone) == (alone,)
    assert not seams_of(alone)
    assert not is_set(alone.spec.surface)


def test_the_branch_is_that_of_the_tee_without_the_hole() -> None:
    alone = construct(part(TEE | {"hole": False}), DEFAULT).product
    assert isinstance(alone, RuledSurface)
    v = np.linspace(0.0, 1.0, 9)
    for a, b in zip(blanks(TEE)[0].patches, alone.patches, strict=True):
        assert_near(a.c1.jet(v, 1), b.c1.jet(v, 1), bound=0.0, why="the same construction")


def seam_difference(table: Table) -> float:
    branch, hole = blanks(table)
    saddle = surface_figures(branch.patches)[0].c1
    return abs(contours.length(hole.outline) / saddle - 1.0)


@pytest.mark.parametrize("angle", [30, 45, 60, 75, 90, 120])
@pytest.mark.parametrize(("branch", "offset"), [(120, 0), (120, 40), (120, -40), (200, 0), (60, 55), (199.99, 0)])
def test_outline_and_saddle_have_one_length(angle: int, branch: float, offset: float) -> None:
    table = TEE | {"angle": angle, "branch": branch, "offset": offset, "length": 900}
    assert_near(seam_difference(table), 0.0, bound=1e-12, why="development keeps lengths; two quadratures")


@settings(max_examples=20, deadline=None)
@given(
    st.integers(min_value=1, max_value=10_000),
    st.floats(min_value=0.01, max_value=1.0),
    st.floats(min_value=-1.0, max_value=1.0),
    st.integers(min_value=20, max_value=160),
)
def test_seams_agree_for_all_sizes(main: int, share: float, aside: float, angle: int) -> None:
    branch = share * main
    offset = aside * (main - branch) / 2.0
    table = TEE | {"main": main, "branch": repr(branch), "offset": repr(offset), "angle": angle, "length": 10 * main}
    assert_near(seam_difference(table), 0.0, bound=1e-11, why="two quadratures, corners nearly touching among them")


def test_patterns_are_compared_as_they_are_cut() -> None:
    branch, hole = (flat(blank) for blank in parts_of(part(TEE)))
    edges = branch["edges"]
    assert isinstance(edges, dict)
    assert_relative(hole["outline_length"], edges["c1"], bound=1e-13, why="two quadratures")


@pytest.mark.parametrize("offset", [0, 20, -35])
def test_marks_say_how_the_template_is_laid_on(offset: int) -> None:
    line, cross = blanks(TEE | {"offset": offset})[1].features
    assert isinstance(line.spec, CurveMark) and isinstance(cross.spec, PointMark)
    y = float(100 * mp.asin(mp.mpf(offset) / 100))
    ends = line.curve[0].at(np.array([0.0, 1.0]))
    assert_near(ends[:, 1], [y, y], bound=1e-13, why="the ruling of the main that the branch's axis meets")
    assert_relative(ends[1, 0] - ends[0, 0], 120.0 / float(mp.sin(mp.pi / 3)), bound=1e-14, why="branch / sin(angle)")
    assert cross.at is not None
    leaves = float(mp.sqrt(100**2 - offset**2) / mp.tan(mp.pi / 3))
    assert_near(cross.at, [leaves, y], bound=1e-13, why="where the axis leaves the main")


@pytest.mark.parametrize("offset", [0, 20, -35])
def test_the_marked_line_ends_on_the_outline(offset: int) -> None:
    hole = blanks(TEE | {"offset": offset})[1]
    ends = hole.features[0].curve[0].at(np.array([0.0, 1.0]))
    t = np.linspace(0.0, 1.0, 4001)
    points = np.concatenate([edge.at(t) for edge in hole.outline])
    for end in ends:
        assert float(norm(points - end).min()) <= np.pi * 120.0 / 4000, "as near as samples come"


@pytest.mark.parametrize(("change", "code"), [({"branch": 201, "offset": 0}, "saddle-misses"),
                                              ({"offset": 41}, "saddle-misses")])  # fmt: skip
def test_a_branch_that_misses_the_main_leaves_no_opening(change: Table, code: str) -> None:
    for blank in parts_of(part(TEE | change)):
        made = construct(blank, DEFAULT)
        assert made.product is None
        assert [finding.code for finding in made.report.findings if finding.fatal] == [code]


def test_a_branch_too_short_for_the_main_leaves_its_opening() -> None:
    branch, hole = (construct(blank, DEFAULT) for blank in parts_of(part(TEE | {"length": 100})))
    assert branch.product is None
    assert hole.product is not None


def test_features_of_a_tee_of_two_blanks_do_not_say_which_is_meant() -> None:
    spec = part(TEE, hole=[{"kind": "drill", "at": [0.5, 0.5], "diameter": 5}]).spec
    assert [trouble.key for trouble in spec.troubles()] == ["hole"]
    spec = part(TEE | {"hole": False}, hole=[{"kind": "drill", "at": [0.5, 0.5], "diameter": 5}]).spec
    assert not [*spec.troubles()]
