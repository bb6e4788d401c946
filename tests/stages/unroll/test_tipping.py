"""Parts that tip up on their slats: sides whatever way the part is turned, and the limits of a pitch."""

import pytest

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import transform
from stages.model.helps import Tabs
from stages.model.pattern import Contour
from stages.model.process import Process
from stages.unroll.tipping import sides, tipping
from tests.near import assert_near
from tests.stages.geometry.paths.test_beside import CIRCLE, polygon


def bar(width: float, height: float) -> Contour:
    return Contour((), polygon((0.0, 0.0), (width, 0.0), (width, height), (0.0, height)), 0.05)


@pytest.mark.parametrize("angle", [0.0, 33.0, 90.0])
def test_sides_do_not_depend_on_how_the_part_lies(angle: float) -> None:
    found = sides(transform(bar(120.0, 40.0).path, Rigid2(5.0, 6.0, angle)))
    assert_near(found, (40.0, 120.0), bound=1e-9, why="rounding at 100 mm")


def test_a_disc_is_as_wide_as_its_diameter_or_a_hair_more() -> None:
    short, long = sides(CIRCLE)
    assert 10.0 - 1e-12 <= short <= long <= 10.1


@pytest.mark.parametrize(
    ("width", "height", "sure"),
    [(400.0, 150.0, None), (400.0, 149.0, 0), (120.0, 99.0, 0), (99.0, 99.0, 1), (60.0, 40.0, 1)],
)
def test_slats_75_apart_carry_sides_of_150(width: float, height: float, sure: int | None) -> None:
    found = [finding.where for finding in tipping(bar(width, height), Process(slat_pitch_mm=75.0))]
    assert [where["sure"] for where in found if where] == ([] if sure is None else [sure])


def test_nothing_is_said_without_slats_nor_of_what_tabs_hold() -> None:
    small = bar(60.0, 40.0)
    assert list(tipping(small, Process())) == []
    assert list(tipping(small, Process(slat_pitch_mm=75.0, tabs=Tabs(0.3, count=3)))) == []
    assert list(tipping(small, Process(slat_pitch_mm=75.0, tabs=Tabs(0.3, count=3, below_mm=50.0)))) == []
    assert len(list(tipping(small, Process(slat_pitch_mm=75.0, tabs=Tabs(0.3, count=3, below_mm=30.0))))) == 1
