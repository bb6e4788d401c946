"""Parts of several blanks in a job: names, files, the seams between them, and a seam whose sides differ."""

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.files import drawings
from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.run import JobResult, PartRun, Step, run_job, spread
from pipeline.sets import with_seams
from stages.construct.sets import Edges, Seam
from stages.errors import BadInputError
from stages.model.tolerances import Tolerances
from tests.near import assert_near
from tests.pipeline.jobs import write_job

ELBOW = """
schema = 1
[[part]]
name = "bend"
  [part.surface]
  kind = "elbow"
  diameter = 80
  angle = 60
  gores = 3
  bend_radius = 120
"""


TEE = """
schema = 1
[material]
thickness = 1
k_factor = 0.4
[[part]]
name = "branch"
face = "inner"
  [part.surface]
  kind = "tee"
  main = 120
  branch = 80
  length = 150
  hole = true
"""


def job(folder: Path) -> Job:
    return job_of(read(write_job(folder, ELBOW)))


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> JobResult:
    return run_job(job(tmp_path_factory.mktemp("elbow")))


def metrics(run: PartRun) -> dict[str, object]:
    return {metric.name: metric.value for metric in run.steps[-1].report.metrics}


def test_every_blank_is_a_part_with_a_drawing_of_its_own(result: JobResult) -> None:
    assert result.status == "made"
    assert [run.part.name for run in result.parts] == ["bend.1", "bend.2", "bend.3"]
    assert sorted(drawings(result)) == ["flat/bend.1.dxf", "flat/bend.2.dxf", "flat/bend.3.dxf"]


def test_mating_edges_are_compared_on_the_flat_patterns(result: JobResult) -> None:
    found = [metrics(run).get("seam_difference_mm") for run in result.parts]
    assert found[0] is None
    assert_near([float(str(value)) for value in found[1:]], [0.0, 0.0], bound=1e-10, why="260 mm to 1e-13, twice")
    assert not [f for run in result.parts for f in run.steps[-1].report.findings if f.code == "seams-differ"]


@pytest.mark.parametrize(("allowed", "found"), [(0.01, ["seams-differ"]), (100.0, [])])
def test_sides_that_differ_by_more_than_the_tolerance_are_a_finding(
    result: JobResult, allowed: float, found: list[str]
) -> None:
    # the mitred edge of the first gore against the square one of the last
    seam = Seam(Edges("bend.1", ("c1",)), Edges("bend.3", ("c1",)))
    told = with_seams(result.parts, [seam], replace(Tolerances(), join_mm=allowed))[-1]
    codes = [f.code for f in told.steps[-1].report.findings if f.code == "seams-differ"]
    assert codes == found
    assert not any(f.fatal for f in told.steps[-1].report.findings)
    one, other = (run.steps[-1].report.detail["flat"] for run in (result.parts[0], result.parts[2]))
    assert isinstance(one, dict) and isinstance(other, dict)
    difference = abs(one["edges"]["c1"] - other["edges"]["c1"])
    assert difference > 1.0
    assert told.steps[-1].report.metrics[-1].value == difference


@pytest.mark.parametrize("workers", [1, 2])
def test_seams_that_differ_are_told_as_soon_as_they_are_known(tmp_path: Path, workers: int) -> None:
    told: list[Step[object]] = []
    tee = job_of(read(write_job(tmp_path, TEE)))
    run_job(tee, told.append, spread(workers))
    codes = [(step.report.subject, f.code) for step in told for f in step.report.findings]
    assert codes.count(("branch.2", "seams-differ")) == 1


def test_a_seam_with_a_blank_that_was_refused_is_not_compared(result: JobResult) -> None:
    seam = Seam(Edges("bend.1", ("c1",)), Edges("bend.2", ("c0",)))
    refused = replace(result.parts[0], pattern=None)
    for runs in ([refused, result.parts[1]], [result.parts[0], replace(result.parts[1], pattern=None)]):
        assert with_seams(runs, [seam], Tolerances())[1] is runs[1]
    assert with_seams(result.parts[:2], [seam], Tolerances())[1] is not result.parts[1]


def test_a_part_may_not_take_the_name_of_a_blank(tmp_path: Path) -> None:
    outline = "{ circle = { center = [0, 0], radius = 5 } }"
    plate = f'[[part]]\nname = "Bend.2"\n[part.surface]\nkind = "flat"\noutline = {outline}\n'
    with pytest.raises(BadInputError) as caught:
        read(write_job(tmp_path, ELBOW + plate))
    assert ["may be a blank of" in problem.message for problem in caught.value.problems] == [True]
