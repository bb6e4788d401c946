"""The edges of a pattern as pictures name them: those of the report, with allowances and without."""

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.report.pictures.edges import flat_pieces, side_length, sides
from pipeline.report.pictures.features import flat_net
from pipeline.report.pictures.net import net
from pipeline.run import JobResult, PartRun, run_job
from stages.geometry.arrays import Array
from stages.geometry.paths.arcpath import length
from stages.model.surface import RuledSurface
from tests.near import assert_near
from tests.pipeline.jobs import write_job

SURFACE = """\
[part.surface]
kind = "transition"
rectangle = [500, 300]
round = 315
height = 400
offset = [60, 0]
"""
"""Plane triangles between cones: each piece has an apex on one of its sides."""
HEAD = 'schema = 1\n[report]\nformats = ["json"]\n'
SEWN = {"bare": (), "ends": ("start", "end"), "rims": ("c0", "c1"), "all": ("start", "c1", "end", "c0")}


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, PartRun]:
    parts = [
        f'[[part]]\nname = "{name}"\n'
        + "".join(f'[[part.seam]]\nedge = "{edge}"\nallowance = 10\n' for edge in edges)
        + SURFACE
        for name, edges in SEWN.items()
    ]
    result: JobResult = run_job(job_of(read(write_job(tmp_path_factory.mktemp("job"), HEAD + "".join(parts)))))
    return {run.part.name: run for run in result.parts}


def places(run: PartRun) -> Array:
    """Return the flat images of the net of a part."""
    assert isinstance(run.surface, RuledSurface)
    assert run.pattern is not None
    found = flat_net(net(run.surface), run.pattern)
    assert found is not None
    return found


@pytest.mark.parametrize("name", SEWN)
def test_an_edge_is_named_with_the_length_that_the_report_has(made: dict[str, PartRun], name: str) -> None:
    pattern, unrolled = made[name].pattern, made[name].steps[-1].report
    assert pattern is not None
    flat = unrolled.detail["flat"]
    assert isinstance(flat, dict)
    told = {edge: side_length(curves) for edge, curves in sides(pattern).items()}
    assert told == pytest.approx(flat["edges"], rel=1e-9)


@pytest.mark.parametrize("name", SEWN)
def test_an_allowance_loses_no_piece_that_has_an_apex(made: dict[str, PartRun], name: str) -> None:
    bare, run = made["bare"], made[name]
    assert isinstance(run.surface, RuledSurface)
    assert run.pattern is not None
    assert len(flat_pieces(run.pattern)) == len(run.surface.patches)
    assert_near(places(run), places(bare), bound=0.0, why="the same pieces in the same order")


@pytest.mark.parametrize("name", ["ends", "rims", "all"])
def test_a_sew_line_runs_along_its_edge_past_the_points_in_it(made: dict[str, PartRun], name: str) -> None:
    pattern = made[name].pattern
    assert pattern is not None
    drawn = {mark.name: length(mark.path) for mark in pattern.marks if mark.layer == "SEW"}
    assert drawn == pytest.approx({edge: side_length(sides(pattern)[edge]) for edge in SEWN[name]}, rel=1e-4)


def test_edges_without_a_length_are_left_out_where_a_part_is_widened(made: dict[str, PartRun]) -> None:
    """So that a piece may be on one side of the outline only."""
    bare, ends = made["bare"].pattern, made["ends"].pattern
    assert bare is not None
    assert ends is not None
    assert len(ends.outer.edges) < len(bare.outer.edges)
