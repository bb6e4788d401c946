"""Groups of seams that are sewn together: who belongs to whom, which way it runs, and how stitches are divided."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.seamgroups import difference, divided, fractions, groups, pitch_mm, seam_notches, too_different, unmated
from stages.model.part import PartSpec
from stages.model.report import Finding
from stages.model.sewing import StitchSpec
from stages.model.tolerances import Tolerances
from stages.unroll.stitches import Stitches
from tests.near import assert_near, assert_relative
from tests.parts import Table, read
from tests.stages.geometry.ruled.test_drill import HALF_TUBE


def part(name: str, *seams: Table, **keys: object) -> PartSpec:
    return read(HALF_TUBE, seam=[{"allowance": 5} | seam for seam in seams], **keys | {"name": name})


BODY = part("body", {"edge": "c0"}, {"edge": "start", "mate": "gusset.c0"}, stitch=[
    {"seam": "c0", "pitch": 4, "diameter": 1}, {"seam": "start", "count": 5, "diameter": 1},
])  # fmt: skip
GUSSET = part("gusset", {"edge": "c0"}, {"edge": "end"})
BASE = part("base", {"edge": "c1", "name": "front", "mate": "body.c0", "reverse": True},
            {"edge": "c0", "name": "back", "mate": "body.c0"})  # fmt: skip
LENGTHS = {
    "body.c0": 100.0,
    "body.start": 60.0,
    "gusset.c0": 62.0,
    "gusset.end": 9.0,
    "base.front": 101.0,
    "base.back": 99.0,
}


def rows(*parts: PartSpec, lengths: dict[str, float] = LENGTHS) -> dict[tuple[str, str], Stitches]:
    return {(name, row.seam): row for group in groups(parts) for name, row in divided(group, lengths).rows}


def test_a_seam_is_in_one_group_with_all_that_it_is_sewn_to() -> None:
    found = groups([BODY, GUSSET, BASE])
    named = [[half.name for half in group.halves] for group in found]
    assert named == [["body.c0", "base.front", "base.back"], ["body.start", "gusset.c0"], ["gusset.end"]]
    assert [group.turned for group in found] == [(False, True, False), (False, False), (False,)]


def test_the_order_of_the_parts_does_not_change_the_groups() -> None:
    found = groups([BASE, GUSSET, BODY])
    assert {frozenset(half.name for half in group.halves) for group in found} == {
        frozenset({"body.c0", "base.front", "base.back"}),
        frozenset({"body.start", "gusset.c0"}),
        frozenset({"gusset.end"}),
    }  # fmt: skip
    front, *others = next(group for group in found if len(group.halves) == 3).turned
    assert (front, others) == (False, [True, True]), "the front runs against the other two"


def test_all_sides_of_a_group_have_as_many_stitches_at_the_same_fractions() -> None:
    made = rows(BODY, GUSSET, BASE)
    body, front, back = (made[key].fractions for key in (("body", "c0"), ("base", "front"), ("base", "back")))
    assert len(body) == 24, "100 mm less a pitch at both ends, 4 apart"
    assert_near(back, body, bound=0.0, why="the same way round")
    assert_near(front, 1.0 - body[::-1], bound=0.0, why="the other way round")
    assert ("gusset", "end") not in made


def test_a_side_that_asks_for_its_own_row_keeps_its_hole_and_takes_the_places() -> None:
    own = part("gusset", {"edge": "c0"}, stitch=[{"seam": "c0", "pitch": 9, "slit": 3, "margin": 2}])
    made = rows(BODY, own)
    leader, follower = made["body", "start"], made["gusset", "c0"]
    assert (leader.spec.diameter, follower.spec.slit, float(follower.spec.margin)) == (1, 3, 2.0)
    assert_near(follower.fractions, leader.fractions, bound=0.0, why="the row that comes first says where")
    assert len(leader.fractions) == 5


def test_a_row_on_the_second_side_alone_is_made_on_the_first_as_well() -> None:
    plain = part("body", {"edge": "start", "mate": "gusset.c0"})
    own = part("gusset", {"edge": "c0"}, stitch=[{"seam": "c0", "count": 4, "diameter": 1}])
    assert {key: len(row.fractions) for key, row in rows(plain, own).items()} == {
        ("body", "start"): 4,
        ("gusset", "c0"): 4,
    }


def stitch(**keys: object) -> StitchSpec:
    return read(HALF_TUBE, seam=[{"edge": "c0", "allowance": 5}], stitch=[{"seam": "c0", "diameter": 1} | keys]).stitch[
        0
    ]


@given(st.integers(20, 2000), st.fractions(Fraction(1), Fraction(6), max_denominator=100))
def test_a_row_is_even_keeps_its_ends_and_is_as_near_to_the_pitch_as_whole_steps_are(
    long: int, pitch: Fraction
) -> None:
    places = fractions(stitch(pitch=str(pitch), ends=[2, 3]), float(long))
    assert places is not None
    assert_near(places[[0, -1]] * long, [2.0, long - 3.0], bound=1e-10, why="the margins at both ends")
    steps = np.diff(places) * long
    assert_relative(steps, np.full(steps.size, pitch_mm(places, float(long))), bound=1e-9, why="evenly")
    room, count = long - 5.0, len(places) - 1
    best = min((abs(room / k - float(pitch)), k) for k in (count - 1, count, count + 1) if k > 0)
    # rounding the number of steps comes nearest in steps, which is nearest in the pitch but for half a step
    assert abs(room / count - float(pitch)) <= best[0] + room / (count * (count + 1)) + 1e-12


@pytest.mark.parametrize(
    ("keys", "ends"),
    [({"pitch": 5}, [5.0, 5.0]), ({"count": 11}, [100.0 / 22.0] * 2), ({"pitch": 5, "ends": [0, 7]}, [0.0, 7.0])],
)
def test_without_ends_the_first_hole_is_a_pitch_from_the_end(keys: Table, ends: list[float]) -> None:
    places = fractions(stitch(**keys), 100.0)
    assert places is not None
    assert_near([places[0] * 100.0, 100.0 - places[-1] * 100.0], ends, bound=1e-12, why="as asked, or the usual")


@pytest.mark.parametrize("ends", [[60, 40], [99, 2]])
def test_ends_that_leave_no_room_are_told(ends: list[int]) -> None:
    assert fractions(stitch(pitch=4, ends=ends), 100.0) is None


def test_more_stitches_than_anyone_sews_are_refused_before_they_are_made() -> None:
    fine = part("body", {"edge": "c0"}, stitch=[{"seam": "c0", "pitch": 0.0001, "diameter": 1}])
    (group,) = groups([fine])
    made = divided(group, {"body.c0": 100.0})
    assert made.rows == ()
    ((name, found),) = made.findings
    assert (name, found.code, found.fatal) == ("body", "stitch-too-many", True)
    assert "1e+06 of them on 100 mm" in found.message


def test_stitch_holes_that_run_into_each_other_are_refused_on_the_side_where_they_do() -> None:
    two = [part("body", {"edge": "c0"}, stitch=[{"seam": "c0", "pitch": 4, "diameter": 1}]),
           part("base", {"edge": "c1", "mate": "body.c0"})]  # fmt: skip
    (group,) = groups(two)
    near = divided(group, {"body.c0": 100.0, "base.c1": 30.0})
    assert not near.findings
    made = divided(group, {"body.c0": 100.0, "base.c1": 10.0})
    assert made.rows == ()
    ((name, found),) = made.findings
    assert (name, found.code, found.fatal) == ("base", "stitch-overlap", True)


def test_lengths_are_compared_with_the_mate_and_limited_by_the_class_or_the_seam() -> None:
    back = groups([BODY, GUSSET, BASE])[0].halves[2]
    metric = difference(back, LENGTHS, Tolerances(accept="leather"))
    assert (metric.value, metric.passed) == (1.0, True)
    assert_relative([float(metric.limit or 0.0)], [0.03 * 99.0], bound=1e-12, why="3 % of the shorter one")
    exact = difference(back, LENGTHS, Tolerances(accept="fabrication", join_mm=0.2))
    assert (exact.limit, exact.passed) == (0.2, False), "1e-5 of 99 mm is less than what joins may gape"
    (finding,) = too_different(exact, LENGTHS)
    assert finding.fatal and "base.back is 99 mm long and body.c0" in finding.message
    assert not [*too_different(metric, LENGTHS)]


def test_a_mate_that_is_no_part_is_told_to_the_seam() -> None:
    lone = groups([BASE])
    told = [found for group in lone for found in unmated(group.halves, ["base.front", "base.back"])]
    assert [(name, finding.code) for name, finding in told] == [("base", "mate-missing")] * 2
    assert not [*unmated(groups([BODY, BASE])[0].halves, ["body.c0"])]


def test_a_notch_is_on_every_side_unless_it_says_no() -> None:
    body = part("body", {"edge": "c0"}, notch=[
        {"seam": "c0", "fraction": "1/4"}, {"seam": "c0", "distance": 90, "mate": False, "name": "mine"},
    ])  # fmt: skip
    (group,) = groups([body, BASE])
    made = [
        (name, one.name, one.seam, one.fraction)
        for name, one in seam_notches(group, LENGTHS)
        if not isinstance(one, Finding)
    ]
    assert made == [
        ("body", "notch-1", "c0", 0.25),
        ("base", "body.notch-1", "front", 0.75),
        ("base", "body.notch-1", "back", 0.25),
        ("body", "mine", "c0", 0.9),
    ]


def test_a_notch_beyond_the_end_of_its_seam_is_told_with_the_length() -> None:
    body = part("body", {"edge": "c0"}, notch=[{"seam": "c0", "distance": "100.5"}])
    ((name, found),) = seam_notches(groups([body])[0], LENGTHS)
    assert name == "body" and isinstance(found, Finding)
    assert found.code == "notch-off-edge" and "100 mm" in found.message
