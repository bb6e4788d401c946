"""Bends between flat faces: each by itself, in one hit where it is tight, its angles in closed form."""

import numpy as np
import pytest

from stages.construct.meshes.bends import bent_sheet
from stages.model.forming import BendSpec
from stages.model.kfactor import KFactor
from stages.model.material import Material
from stages.model.pattern import FlatPattern
from stages.model.report import StageReport
from stages.model.scalars import Angle, Length
from stages.unroll import unroll
from stages.verify import verify
from tests.bentmeshes import Bend, Flat, Legs, bent, rectangle
from tests.meshregions import loops_of, moved
from tests.near import assert_near
from tests.parts import DEFAULT, RIGHT_FRUSTUM, part

T, K = 2.0, 0.4
WIDTH = 100.0
UNLIKE: Legs = (Flat(40.0), Bend(5.0, 80.0), Flat(60.0), Bend(4.0, 100.0), Flat(30.0))
JOGGLE: Legs = (Flat(30.0), Bend(6.0, 90.0), Bend(9.0, -90.0), Flat(25.0))
HEM: Legs = (Flat(50.0), Bend(4.0, 180.0), Flat(30.0))
WIDE: Legs = (Flat(40.0), Bend(30.0, 90.0), Flat(40.0), Bend(3.0, 90.0), Flat(20.0))
MANY: Legs = tuple(leg for _ in range(10) for leg in (Flat(1.0), Bend(50.0, 5.0)))
EXACT = 1e-8
"""Of angles in deg and lengths in mm from meshes of 0.1 m that keep all digits, fitted by least squares."""


def made(
    legs: Legs, *specs: BendSpec, thickness: float | None = T, step_deg: float = 10.0
) -> tuple[FlatPattern, StageReport]:
    """Return the pattern of a mesh of bent sheet, its middle surface, and what unroll says."""
    sheet = Material("steel", thickness, k_factor=KFactor(K, given=True))
    mesh = moved(bent(legs, rectangle(WIDTH, legs), step_deg))
    found = bent_sheet(part(RIGHT_FRUSTUM, sheet, bend=_tables(specs)), mesh, loops_of(mesh), DEFAULT)
    assert found is not None
    certificate = verify(found.surface, DEFAULT).product
    assert certificate is not None
    outcome = unroll(certificate, DEFAULT)
    assert outcome.product is not None, outcome.report.findings
    return outcome.product, outcome.report


def _tables(specs: tuple[BendSpec, ...]) -> list[dict[str, float]]:
    """Return bend specifications as a job file has them."""
    return [
        {key: float(value) for key in ("max_angle", "facet_error") if (value := getattr(spec, key)) is not None}
        for spec in specs
    ]


def rows(report: StageReport) -> list[dict]:
    found = report.detail["bends"]
    assert isinstance(found, list)
    return found


def angles(report: StageReport) -> list[float]:
    """Return the angles, from the end of the sheet with the longer flange on."""
    found = [row["angle_deg"] for row in rows(report)]
    side = np.sign(found[0]) if found else 1.0
    return [float(side * angle) for angle in found]


def test_each_bend_of_a_sheet_is_a_line_in_its_middle_without_being_asked_for() -> None:
    pattern, report = made(UNLIKE)
    found = rows(report)
    assert [row["name"] for row in found] == ["bend-1", "bend-2"]
    assert_near(sorted(angles(report)), [80.0, 100.0], bound=EXACT, why="the legs")
    by_angle = {round(abs(row["angle_deg"])): row for row in found}
    assert_near(by_angle[80]["radius_mm"], [4.0, 4.0], bound=EXACT, why="5 in the middle, less half the thickness")
    allowances = [np.radians(80.0) * (4.0 + K * T), np.radians(100.0) * (3.0 + K * T)]
    middles = [40.0 + allowances[0] / 2.0, 40.0 + allowances[0] + 60.0 + allowances[1] / 2.0]
    apart = abs(np.subtract(by_angle[80]["from"], by_angle[100]["from"])).max()
    assert_near(apart, middles[1] - middles[0], bound=EXACT, why="theta (r + K t), and the leg between")
    assert_near(found[0]["pitch_mm"], [apart, apart], bound=EXACT, why="the same, along the table")
    drawn = [mark.name for mark in pattern.marks if mark.layer.startswith("BEND_")]
    assert drawn[:2] == ["bend-1", "bend-2"]
    assert report.metric("bend_angle_error_deg").passed


def test_steps_of_bends_apart_do_not_share_a_hit() -> None:
    """In steps of at most 90 deg: one of 80, two of 50; divided together there would be two of 90."""
    _, report = made(UNLIKE, BendSpec(max_angle=Angle(90)))
    assert_near(sorted(angles(report)), [50.0, 50.0, 80.0], bound=EXACT, why="each bend by itself")
    assert report.metric("bend_angle_error_deg").passed


def test_by_facet_error_bends_apart_are_divided_by_themselves_too() -> None:
    _, report = made(UNLIKE, BendSpec(facet_error=Length(1)))
    found = np.array(sorted(angles(report)))
    assert_near([found[found < 45.0].sum(), found.sum()], [found[found < 45.0].sum(), 180.0], bound=EXACT, why="sum")
    for angle, radius in ((80.0, 5.0), (100.0, 4.0)):
        count = next(n for n in range(1, 9) if radius * (1.0 - np.cos(np.radians(angle / n / 2.0))) <= 1.0)
        assert np.count_nonzero(np.abs(found - angle / count) <= EXACT) == count


def test_narrow_flats_do_not_part_what_is_bent_as_if_it_were_round() -> None:
    _, report = made(MANY, BendSpec(max_angle=Angle(25)), step_deg=1.0)
    assert_near(angles(report), [25.0, 25.0], bound=EXACT, why="50 deg in two steps over five flats of 1 mm each")


@pytest.mark.parametrize(("legs", "wanted"), [(JOGGLE, [90.0, -90.0]), (HEM, [180.0])])
def test_bends_of_both_ways_and_hems_are_one_hit_each(legs: Legs, wanted: list[float]) -> None:
    _, report = made(legs)
    assert_near(angles(report), wanted, bound=EXACT, why="the legs")


def test_a_wide_bend_is_rolled_and_only_the_tight_one_is_a_line() -> None:
    """30 mm is more than ten thicknesses of 2 mm: what is told is no longer all of the turning."""
    _, report = made(WIDE)
    assert_near(angles(report), [90.0], bound=EXACT, why="the bend of 3 mm")
    assert rows(report)[0]["radius_mm"] == pytest.approx([2.0, 2.0], abs=EXACT)
    assert "bend_angle_error_deg" not in {metric.name for metric in report.metrics}
    _, thick = made(WIDE, thickness=3.5)
    assert_near(angles(thick), [90.0, 90.0], bound=EXACT, why="28 mm inside is less than ten of 3.5 mm")


def test_without_a_thickness_nobody_knows_what_is_tight() -> None:
    _, report = made(UNLIKE, thickness=None)
    assert rows(report) == []
