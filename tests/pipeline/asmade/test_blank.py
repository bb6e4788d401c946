"""What `compare` has of a blank is what the traveller has of it; where all sides are straight, a kerf counts."""

from pathlib import Path

import pytest

from pipeline.asmade.nominal import nominal_of
from pipeline.asmade.sizes import Dimension
from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.traveller.numbers import millimetres
from pipeline.run import run_job
from pipeline.store import write_files
from tests.pdfs import page_operators, texts
from tests.pipeline.jobs import CONE, write_job

JOB = """\
schema = 1
[report]
formats = ["json", "traveller"]
[[part]]
name = "L"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [40, 0], [40, 10], [10, 10], [10, 30], [0, 30], [0, 0]] }
[[part]]
name = "sewn"
[[part.seam]]
edge = "outline"
allowance = 5
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]] }
"""
PARTS = ("L", "sewn", "cone")
BETWEEN = ("edge", "straight", "diagonal")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("blank")
    _, files = outputs(run_job(job_of(read(write_job(folder, JOB + CONE)))))
    write_files(folder / "out", files)
    return folder / "out"


@pytest.fixture(scope="module")
def sizes(made: Path) -> dict[tuple[str, str], Dimension]:
    return {(one.part, one.what): one for one in nominal_of(made).dimensions}


def test_every_size_between_corners_stands_in_the_traveller_and_no_other(
    made: Path, sizes: dict[tuple[str, str], Dimension]
) -> None:
    pages = page_operators((made / "traveller.pdf").read_bytes())
    for part in PARTS:
        (page,) = (told for told in map(texts, pages) if told[0] == part)
        table = page[page.index("Measure on the blank") : page.index("Checks")]
        asked = {
            millimetres(one.nominal) for (of, what), one in sizes.items() if of == part and what.split()[0] in BETWEEN
        }
        assert len(asked) > 2
        assert asked == {one for one in table if one.replace(".", "").isdigit()}


def test_names_are_those_of_edges_or_the_letters_of_their_ends(sizes: dict[tuple[str, str], Dimension]) -> None:
    named = {part: {what for of, what in sizes if of == part} for part in PARTS}
    assert {"edge c0", "edge start", "straight D-A", "diagonal 1"} <= named["cone"]
    assert {"edge A-B", "edge F-A", "diagonal 3"} <= named["L"]
    assert not [what for what in named["L"] if what.startswith("straight")]


def test_a_kerf_shortens_what_lies_between_two_corners_that_stand_out(sizes: dict[tuple[str, str], Dimension]) -> None:
    rates = {what: one.rate for (part, what), one in sizes.items() if part == "L"}
    outer = {"width", "height", "edge A-B", "edge B-C", "edge E-F", "edge F-A"}
    assert {what: rates[what] for what in outer} == pytest.approx(dict.fromkeys(outer, -1.0))
    assert {what: rates[what] for what in ("edge C-D", "edge D-E")} == pytest.approx({"edge C-D": 0.0, "edge D-E": 0.0})
    assert [one.rate for (part, _), one in sizes.items() if part == "cone"] == [None] * len(
        [part for part, _ in sizes if part == "cone"]
    )


def test_a_blank_with_allowances_is_measured_as_it_is_cut(sizes: dict[tuple[str, str], Dimension]) -> None:
    found = [sizes["sewn", what].nominal for what in ("width", "height", "edge A-B")]
    assert found == pytest.approx([50.0, 40.0, 50.0])
    assert sizes["sewn", "edge A-B"].rate == pytest.approx(-1.0), "its sides are straight: they tell the kerf"
