"""What is drawn of a part: the lines and arcs that are cut, the rulings, and where its extremes lie."""

import json

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.report.view.data import flat_view, view_bytes, view_document
from pipeline.run import JobResult, run_job
from tests.near import assert_near
from tests.samples import SAMPLES

PLATE = SAMPLES.parent / "pipeline" / "data" / "init" / "cone.toml"

LAST_DIGITS = "the last digits of positions of some hundred mm"


@pytest.fixture(scope="module")
def made() -> JobResult:
    return run_job(job_of(read(PLATE, ["report.formats=['json']", "nest.time_limit=0.1"])))


def test_contours_are_those_that_are_cut(made: JobResult) -> None:
    (run, *_) = made.parts
    assert run.pattern is not None
    drawn = flat_view(run.pattern, run)["contours"]
    assert isinstance(drawn, list)
    for one, contour in zip(drawn, (run.pattern.outer, *run.pattern.inner), strict=True):
        assert one["points"][0::3] == contour.path.vertices[:, 0].tolist()
        assert one["points"][1::3] == contour.path.vertices[:, 1].tolist()
        assert one["points"][2::3] == contour.path.bulges.tolist()


def test_rulings_run_from_edge_to_edge(made: JobResult) -> None:
    (run, *_) = made.parts
    assert run.pattern is not None
    rulings = flat_view(run.pattern, run)["rulings"]
    assert isinstance(rulings, list)
    corners = run.pattern.corners
    assert_near(rulings[0][:4], corners[[0, 1]].ravel(), bound=1e-9, why=LAST_DIGITS)
    assert_near(rulings[-1][:4], corners[[3, 2]].ravel(), bound=1e-9, why=LAST_DIGITS)


def test_places_lie_in_the_box_of_the_pattern(made: JobResult) -> None:
    (run, *_) = made.parts
    assert run.pattern is not None
    places = flat_view(run.pattern, run)["places"]
    assert isinstance(places, list)
    assert "max_strain" in {place["metric"] for place in places}
    low, high = run.pattern.outer.path.vertices.min(axis=0) - 1.0, run.pattern.outer.path.vertices.max(axis=0) + 1.0
    for place in places:
        assert (low <= place["at"]).all()
        assert (place["at"] <= high).all()


def test_it_reads_back_as_it_was(made: JobResult) -> None:
    document = view_document(made, lambda _run: None)
    assert json.loads(view_bytes(document)) == json.loads(json.dumps(document))
