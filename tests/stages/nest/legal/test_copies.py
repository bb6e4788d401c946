"""The certifier on lists of placements: pairs, mirrors, grain, one direction, fixed copies; faults and near misses."""

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2
from stages.model.pattern import FlatPattern
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.nest.legal.certify import certify, passed
from stages.nest.legal.copies import moved, off_grain_deg
from stages.nest.turns import allowed, contains
from tests.near import assert_near
from tests.stages.nest.shapes import rectangle

SHEET = Sheet("s", 1000.0, 500.0)
OPTIONS = NestOptions()
HAIR_DEG = 1e-9


def judged(
    part: FlatPattern, motions: Sequence[Rigid2], options: NestOptions = OPTIONS, sheet: Sheet = SHEET
) -> list[str]:
    """Return the codes for copies of one part, in the middle of quarters of a sheet."""
    placed = tuple(
        Placement(part.part, i, replace(motion, x=180.0 * i, y=250.0)) for i, motion in enumerate(motions, start=1)
    )
    nesting = Nesting((SheetLayout(sheet, 1, placed, 0.0),))
    metrics, findings = certify(nesting, [part.replace(quantity=len(placed))], [sheet], options)
    assert passed(metrics, findings) == (not findings)
    return [finding.code for finding in findings]


PART = rectangle("a", 60.0, 30.0)
PLAIN, TURNED = Rigid2(), Rigid2(mirrored=True)


def test_nothing_is_mirrored_unless_the_options_say_so() -> None:
    assert judged(PART, [PLAIN, TURNED]) == ["mirrored"]
    assert judged(PART, [PLAIN, TURNED], NestOptions(mirror=True)) == []


@pytest.mark.parametrize("options", [OPTIONS, NestOptions(mirror=True)])
def test_of_a_pair_the_even_copies_are_mirrored_and_no_others(options: NestOptions) -> None:
    pair = PART.replace(pair=True)
    assert judged(pair, [PLAIN, TURNED, PLAIN], options) == []
    assert judged(pair, [TURNED, PLAIN], options) == ["mirrored", "mirrored"]
    assert judged(pair, [PLAIN, PLAIN], options) == ["mirrored"]


GRAINED = replace(SHEET, grain_deg=30.0)


@pytest.mark.parametrize(("mirrored", "along"), [(False, 20.0), (True, 40.0)])
def test_a_part_with_an_axis_lies_along_the_grain_either_way_within_its_band(mirrored: bool, along: float) -> None:
    """A mirror takes the axis of 10 deg to 170."""
    part, options = PART.replace(axis_deg=10.0, axis_band_deg=5.0), NestOptions(mirror=True)
    for angle, wanted in [
        (along, []),
        (along + 180.0, []),
        (along + 5.0, []),
        (along - 5.0, []),
        (along + 5.0 + 3.0 * HAIR_DEG, ["grain"]),
        (along - 185.0 - 3.0 * HAIR_DEG, ["grain"]),
        (along + 90.0, ["grain"]),
    ]:
        assert judged(part, [Rigid2(angle_deg=angle, mirrored=mirrored)], options, GRAINED) == wanted, angle


def test_neither_an_axis_nor_a_grain_alone_binds_anything() -> None:
    assert judged(PART, [Rigid2(angle_deg=77.0)], sheet=GRAINED) == []
    assert judged(PART.replace(axis_deg=10.0), [Rigid2(angle_deg=77.0)]) == []


def test_a_list_of_angles_and_the_grain_bind_together() -> None:
    part = PART.replace(axis_deg=0.0, rotations=(0.0, 30.0))
    assert judged(part, [Rigid2(angle_deg=30.0)], sheet=GRAINED) == []
    assert judged(part, [Rigid2(angle_deg=0.0)], sheet=GRAINED) == ["grain"]
    assert judged(part, [Rigid2(angle_deg=210.0)], sheet=GRAINED) == ["rotation"]


def test_how_far_off_the_grain_is_measured() -> None:
    part = PART.replace(axis_deg=10.0, axis_band_deg=50.0)
    placed = Placement("a", 1, Rigid2(100.0, 100.0, 45.0))
    metrics, _ = certify(Nesting((SheetLayout(GRAINED, 1, (placed,), 0.0),)), [part], [GRAINED], OPTIONS)
    assert_near(metrics[-1].value, 25.0, bound=1e-12, why="45 + 10 - 30")
    assert metrics[-1].name == "off_grain_deg"


LISTS = st.none() | st.lists(st.sampled_from([0.0, 45.0, 90.0, -90.0]), min_size=1, max_size=3).map(tuple)
DIRECTIONS = st.tuples(st.floats(-180.0, 360.0), st.floats(0.0, 95.0), st.floats(-180.0, 180.0))
"""The axis of a part, its band, and the grain of a sheet."""


@given(DIRECTIONS, LISTS, st.floats(0.0, 360.0), st.booleans())
@settings(max_examples=200, deadline=None)
def test_the_certifier_and_the_spans_of_the_engines_agree(
    directions: tuple[float, float, float], listed: tuple[float, ...] | None, angle: float, mirrored: bool
) -> None:
    axis, band, grain = directions
    part = PART.replace(axis_deg=axis, axis_band_deg=band, rotations=listed)
    sheet, options = replace(SHEET, grain_deg=grain), NestOptions(mirror=True)
    motion = Rigid2(angle_deg=angle if listed is None else listed[0], mirrored=mirrored)
    off = off_grain_deg(Placement("a", 1, motion), part, sheet)
    assert off is not None
    if abs(off - band) > 1e-8:
        wanted = contains(allowed(part, sheet, options, mirrored=mirrored), motion.angle_deg)
        assert (judged(part, [motion], options, sheet) == []) == wanted


def test_one_direction_holds_for_each_handedness() -> None:
    options = NestOptions(mirror=True, one_direction=True)
    motions = [Rigid2(angle_deg=20.0), Rigid2(angle_deg=380.0), Rigid2(angle_deg=70.0, mirrored=True)]
    assert judged(PART, motions, options) == []
    assert judged(PART, [*motions, Rigid2(angle_deg=20.0 + 3.0 * HAIR_DEG)], options) == ["direction"]
    assert judged(PART, [*motions, Rigid2(angle_deg=200.0)], options) == ["direction"]
    assert judged(PART, [*motions, Rigid2(angle_deg=200.0)], NestOptions(mirror=True)) == []


def nesting(*placed: Placement, sheet: Sheet = SHEET, index: int = 1) -> SheetLayout:
    return SheetLayout(sheet, index, placed, 0.0)


ONE, TWO = Placement("a", 1, Rigid2(100.0, 100.0), fixed=True), Placement("a", 2, Rigid2(300.0, 100.0), fixed=True)
GIVEN = Nesting((nesting(ONE, TWO),))


def test_fixed_copies_that_lie_where_they_were_put_pass() -> None:
    assert moved(Nesting((nesting(TWO, Placement("b", 1, Rigid2()), ONE),)), GIVEN) == []


FAULTS = {
    "moved a little": [nesting(ONE, replace(TWO, motion=Rigid2(300.0 + 1e-12, 100.0)))],
    "turned round": [nesting(ONE, replace(TWO, motion=Rigid2(300.0, 100.0, 360.0)))],
    "missing": [nesting(ONE)],
    "on another stock": [nesting(ONE), nesting(TWO, sheet=replace(SHEET, id="t"))],
    "on another sheet": [nesting(ONE), nesting(TWO, index=2)],
    "exchanged": [nesting(replace(ONE, copy=2), replace(TWO, copy=1))],
}


@pytest.mark.parametrize("name", FAULTS)
def test_fixed_copies_that_were_moved_are_found(name: str) -> None:
    found = moved(Nesting(tuple(FAULTS[name])), GIVEN)
    assert {finding.code for finding in found} == {"moved"}
    assert all(finding.fatal for finding in found)


def test_the_certifier_asks_for_fixed_copies() -> None:
    part = rectangle("a", 60.0, 30.0, quantity=2)
    free = Nesting((nesting(replace(ONE, motion=Rigid2(500.0, 100.0)), TWO),))
    assert certify(free, [part], [SHEET], OPTIONS)[1] == ()
    assert [finding.code for finding in certify(free, [part], [SHEET], OPTIONS, GIVEN)[1]] == ["moved"]
