"""Seams of a job that do not fit are refused or told, and keys that go wrong are told with their place."""

from pathlib import Path

import pytest

from pipeline.jobfile import read
from pipeline.outputs import outputs
from stages.errors import BadInputError
from tests.near import assert_relative
from tests.pipeline.jobs import write_job
from tests.pipeline.test_sewing import CUP, ROUND, codes, metric, part, run


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("length = 80\n", "length = 80\nstart_plane = { point = [0, 0, 20], normal = [0.6, 0, 1] }\n", "seams-differ"),
        ("depth = 4", "depth = 6.5", "notch-too-deep"),
        ('fraction = "1/4"', "distance = 200", "notch-off-edge"),
        ("ends = [5, 5]", "ends = [50, 40]", "stitch-no-room"),
        ("diameter = 1\n", "diameter = 13\n", "stitch-overlap"),
        ("margin = 3", 'margin = 0.5\nline = "cut"', "slit-outside"),
    ],
)
def test_what_does_not_fit_is_refused_and_nothing_of_it_is_cut(tmp_path: Path, old: str, new: str, code: str) -> None:
    assert old in CUP
    result = run(tmp_path, CUP.replace(old, new, 1))
    assert result.status == "rejected"
    assert code in codes(result)
    assert not any(path.startswith("cut/") for path in outputs(result)[1])


def test_a_mate_without_a_pattern_leaves_its_seam_without_one(tmp_path: Path) -> None:
    crossing = "outline = { polyline = [[0, 0], [40, 0], [0, 40], [40, 50], [0, 0]] }"
    result = run(tmp_path, CUP.replace("outline = { circle = { center = [0, 0], radius = 30 } }", crossing))
    assert [run.pattern for run in result.parts] == [None, None]
    assert "mate-missing" in codes(result)


def test_seams_that_differ_by_more_than_they_may_say_both_lengths(tmp_path: Path) -> None:
    result = run(tmp_path, CUP.replace("center = [0, 0], radius = 30", "center = [0, 0], radius = 31"))
    (finding,) = (one for one in part(result, "wall").steps[-1].report.findings if one.code == "seams-differ")
    assert "188.496 mm" in finding.message and "194.779 mm" in finding.message and "max_difference" in finding.message
    wide = CUP.replace("center = [0, 0], radius = 30", "center = [0, 0], radius = 31")
    eased = run(tmp_path, wide.replace('mate = "floor.outline"', 'mate = "floor.outline"\nmax_difference = 6.4'))
    assert eased.status == "made"
    assert metric(eased, "wall", "seam_difference_mm").limit == 6.4


def test_the_accepted_strain_is_what_mating_lengths_may_differ_by(tmp_path: Path) -> None:
    wide = CUP.replace("center = [0, 0], radius = 30", "center = [0, 0], radius = 30.5")
    leather = run(tmp_path, wide.replace("chord = 0.02", 'chord = 0.02\naccept = "leather"'))
    assert leather.status == "made"
    assert_relative(
        [float(metric(leather, "wall", "seam_difference_mm").limit or 0)], [0.03 * ROUND], bound=1e-12, why="3 %"
    )


def test_a_pitch_outside_its_range_is_told_and_stops_nothing(tmp_path: Path) -> None:
    result = run(tmp_path, CUP.replace("pitch = 12\n", "pitch = 12\npitch_range = [12, 12.2]\n"))
    assert result.status == "made"
    found = [f for one in result.parts for f in one.steps[-1].report.findings if f.code == "stitch-pitch"]
    assert len(found) == 2 and "12.3 mm apart" in found[0].message


BAD = [
    ('mate = "floor.outline"', 'mate = "floor.rim"', 'no seam "floor.rim" in this job'),
    ('mate = "floor.outline"', 'mate = "wall.c0"', "is sewn to itself"),
    ('mate = "floor.outline"', 'mate = "floor"', '"floor" names no seam'),
    ("allowance = 6\n", "", "a closed seam without one"),
    ('kind = "cut"', 'kind = "cut"\nallowance = 3', "3 mm beside a cut edge"),
    ('edge = "c0"', 'edge = "outline"', 'no edge "outline" on this kind'),
    ('[[part.stitch]]\nseam = "c0"', '[[part.stitch]]\nseam = "c1"', 'no seam "c1" on this part'),
    ("pitch = 12\n", "pitch = 12\ncount = 5\n", "exactly one of pitch and count"),
    ("slit = 2\n", "", "exactly one of diameter and slit"),
    ('fraction = "1/4"', 'fraction = "5/4"', "1.25"),
    ('fraction = "1/4"', 'fraction = "1/4"\nat = 0.5', "a seam has no parameter"),
    ("allowance = 10", "alowance = 10", "unknown key"),
    ("ends = [5, 5]", "ends = [-5, 5]", "before the seam begins"),
    ('edge = "start"\n', 'edge = "start"\nreverse = true\n', "without a mate"),
    ('edge = "start"\n', 'edge = "start"\nfrom = 3\n', "exactly one of from and to"),
    ('edge = "end"\n', 'edge = "end"\nname = "a.b"\n', '"a.b" has a dot'),
    ("allowance = 10", "allowance = -10", "-10"),
]


@pytest.mark.parametrize(("old", "new", "message"), BAD)
def test_keys_that_go_wrong_are_told_with_their_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in CUP
    with pytest.raises(BadInputError) as caught:
        read(write_job(tmp_path, CUP.replace(old, new, 1)))
    assert any(message in problem.message for problem in caught.value.problems), caught.value.problems
    assert all(problem.line is not None and problem.hint for problem in caught.value.problems)
