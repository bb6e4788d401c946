"""Parts of several blanks that are sewn: an elbow whose gores are sewn to each other, hole on hole, and to a plate."""

from functools import cache
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.run import JobResult, run_job
from stages.errors import BadInputError
from stages.geometry.curves import contours
from stages.geometry.paths import arcpath
from tests.near import assert_near
from tests.pipeline.jobs import write_job

ELBOW = """
schema = 1
[material]
thickness = 1
k_factor = 0.5
[[part]]
name = "bend"
[[part.seam]]
edge = "c0"
allowance = 6
[[part.seam]]
edge = "c1"
allowance = 6
[[part.seam]]
edge = "start"
kind = "lapped"
allowance = 8
[[part.seam]]
edge = "end"
kind = "cut"
mate = "bend.start"
[[part.stitch]]
seam = "c1"
pitch = 6
diameter = 1
[[part.stitch]]
seam = "start"
count = 5
diameter = 1
margin = 3
[[part.notch]]
seam = "c1"
fraction = "1/4"
[part.surface]
kind = "elbow"
diameter = 80
angle = 60
gores = 3
bend_radius = 120
seam = "throat"
"""
LID = """
[[part]]
name = "lid"
[[part.seam]]
edge = "outline"
allowance = 6
mate = "bend.1.mouth"
[part.surface]
kind = "flat"
outline = { circle = { center = [0, 0], radius = 40 } }
"""
MOUTH = """
[[part.seam]]
edge = "c0"
name = "mouth"
blank = 1
allowance = 6
[[part.seam]]
edge = "c0"
name = "joint-2"
blank = 2
allowance = 6
[[part.seam]]
edge = "c0"
name = "joint-3"
blank = 3
allowance = 6
"""
WITH_LID = ELBOW.replace('[[part.seam]]\nedge = "c0"\nallowance = 6\n', MOUTH) + LID


def ran(text: str) -> JobResult:
    with TemporaryDirectory() as folder:
        return run_job(job_of(read(write_job(Path(folder), text))))


@cache
def made(text: str) -> JobResult:
    result = ran(text)
    assert result.status == "made", [run.steps[-1].report.findings for run in result.parts]
    return result


def table(result: JobResult, part: str, name: str) -> dict[str, dict]:
    (run,) = (run for run in result.parts if run.part.name == part)
    rows = run.steps[-1].report.detail[name]
    assert isinstance(rows, list)
    return {row["seam" if name == "stitches" else "name"]: row for row in rows}


def test_every_gore_has_the_seams_of_the_part_and_is_sewn_to_the_next() -> None:
    for number, mate in ((1, "bend.2.c0"), (2, "bend.3.c0"), (3, None)):
        seams = table(made(ELBOW), f"bend.{number}", "seams")
        assert [seams[name]["mate"] for name in ("c0", "c1", "start")] == [None, mate, None]
        assert seams["end"]["mate"] == f"bend.{number}.start", "a gore is closed along itself"
        assert_near(seams["end"]["difference"], 0.0, bound=1e-9, why="one ruling")
        if mate:
            assert_near(seams["c1"]["difference"], 0.0, bound=1e-9, why="one ellipse, on the middle surface")


def test_both_sides_of_a_joint_have_as_many_holes_and_the_notch_at_one_share() -> None:
    result = made(ELBOW)
    for number in (1, 2):
        one, other = (table(result, f"bend.{n}", "stitches") for n in (number, number + 1))
        assert one["c1"]["count"] == other["c0"]["count"]
        assert_near(one["c1"]["pitch"], other["c0"]["pitch"], bound=1e-9, why="equal lengths")
    names = [[place.name for place in run.pattern.notches] for run in result.parts if run.pattern]
    assert names == [["notch-1"], ["bend.1.notch-1", "notch-1"], ["bend.2.notch-1", "notch-1"]]


def test_what_is_cut_is_wider_by_the_allowances() -> None:
    """The first gore is 251.327 mm around, and as long as the mitre leaves it: 160 tan 15 at its heel."""
    run = made(ELBOW).parts[0]
    assert run.pattern is not None
    low_x, low_y, high_x, high_y = arcpath.bounds(run.pattern.outer.path)
    found = sorted([high_x - low_x, high_y - low_y])
    heel = 160.0 * np.tan(np.radians(15.0))
    assert_near(found, [heel + 2.0 * 6.0, 80.0 * pi + 8.0], bound=0.05, why="6 mm at both ends, 8 mm at one side")


def test_another_part_is_sewn_to_the_blank_that_it_names() -> None:
    result = made(WITH_LID)
    lid = table(result, "lid", "seams")["outline"]
    assert lid["mate"] == "bend.1.mouth"
    assert_near(lid["difference"], 0.0, bound=1e-9, why="80 pi, once flat and once rolled")
    assert {*table(result, "bend.2", "seams")} == {"joint-2", "c1", "start", "end"}
    assert table(result, "bend.1", "seams")["c1"]["mate"] == "bend.2.joint-2"
    assert_near(contours.length(result.parts[-1].pattern.outer.edges), 92.0 * pi, bound=1e-6, why="6 mm wider")  # type: ignore[union-attr]


def problems(text: str) -> list[str]:
    with pytest.raises(BadInputError) as caught:
        ran(text)
    return [problem.message for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('seam = "throat"', 'seam = "staggered"', "begin half a turn apart"),
        ('name = "mouth"\nblank = 1', 'name = "mouth"\nblank = 4', "the part takes 3 blanks"),
        ('mate = "bend.1.mouth"', 'mate = "bend.2.mouth"', 'no seam "bend.2.mouth" in this job'),
        ('mate = "bend.1.mouth"', 'mate = "bend.4.c1"', 'no seam "bend.4.c1" in this job'),
        ('edge = "c1"\n', 'edge = "c1"\nmate = "lid.outline"\n', "missing beside a mate of another part"),
        ('edge = "outline"\n', 'edge = "outline"\nblank = 2\n', "the part is one blank"),
        ('seam = "c1"\nfraction = "1/4"', 'edge = "c1"\ndistance = 10', "which of the blanks is meant is not said"),
    ],
)
def test_what_no_blank_could_be_sewn_by_is_refused(old: str, new: str, message: str) -> None:
    assert WITH_LID.count(old) >= 1
    assert any(message in problem for problem in problems(WITH_LID.replace(old, new, 1)))


def test_a_mate_without_its_blank_has_no_pattern_and_says_how_to_name_it() -> None:
    result = ran(WITH_LID.replace('mate = "bend.1.mouth"', 'mate = "bend.mouth"'))
    found = [finding.message for run in result.parts for finding in run.steps[-1].report.findings if finding.fatal]
    assert any('write "part.n.seam"' in message for message in found)


TEE = """
schema = 1
[material]
thickness = 1
[[part]]
name = "tee"
[[part.seam]]
edge = "c1"
allowance = 5
mate = "tee.2.outline"
blank = 1
[[part.seam]]
edge = "outline"
allowance = 5
[[part.stitch]]
seam = "c1"
pitch = 5
diameter = 1
[part.surface]
kind = "tee"
branch = 60
main = 100
length = 120
hole = true
"""


def test_a_branch_is_sewn_to_the_opening_in_its_main() -> None:
    result = made(TEE)
    one, other = (table(result, f"tee.{n}", "stitches") for n in (1, 2))
    assert one["c1"]["count"] == other["outline"]["count"] > 30
    assert [*table(result, "tee.1", "seams")] == ["c1"]
    assert [*table(result, "tee.2", "seams")] == ["outline"]
