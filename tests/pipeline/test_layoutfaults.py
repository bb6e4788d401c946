"""Whatever is wrong with a kept layout is told at once, each fault with its place in the file."""

from collections.abc import Callable
from pathlib import Path

import pytest

from pipeline.job import Job, job_of
from pipeline.jobfile import read
from pipeline.layouts import with_layout
from stages.errors import BadInputError
from tests.pipeline.jobs import write_job
from tests.pipeline.test_layouts import TEXT, Layout, sheets_of, stored

Edit = Callable[[list[dict[str, object]]], object]
FAULTS: dict[str, tuple[Edit, str, str]] = {
    "unknown part": (
        lambda sheets: sheets[0]["placements"][0].update(part="plat"),  # type: ignore[index]
        "sheets[0].placements[0].part",
        'the job has no part "plat"',
    ),
    "beyond the quantity": (
        lambda sheets: sheets[0]["placements"][0].update(part="strip", copy=2),  # type: ignore[index]
        "sheets[0].placements[0].copy",
        'copy 2 of "strip", of which 1 are wanted',
    ),
    "copy 0": (
        lambda sheets: sheets[0]["placements"][0].update(copy=0),  # type: ignore[index]
        "sheets[0].placements[0].copy",
        "0 where a whole number from 1 on belongs",
    ),
    "twice": (
        lambda sheets: sheets[0]["placements"].append(dict(sheets[0]["placements"][0])),  # type: ignore[attr-defined, call-overload, index]
        "sheets[0].placements[2].copy",
        "is placed twice",
    ),
    "unknown stock": (
        lambda sheets: sheets[0].update(stock="shet"),
        "sheets[0].stock",
        'the job has no stock "shet"',
    ),
    "not a number": (
        lambda sheets: sheets[0]["placements"][0].update(x=float("nan")),  # type: ignore[index]
        "sheets[0].placements[0].x",
        "nan is not a number of this world",
    ),
    "infinite": (
        lambda sheets: sheets[0]["placements"][0].update(angle=float("inf")),  # type: ignore[index]
        "sheets[0].placements[0].angle",
        "inf is not a number of this world",
    ),
    "a text for a number": (
        lambda sheets: sheets[0]["placements"][0].update(y="3 mm"),  # type: ignore[index]
        "sheets[0].placements[0].y",
        '"3 mm" where a number belongs',
    ),
    "no number": (
        lambda sheets: sheets[0]["placements"][0].pop("x"),  # type: ignore[index]
        "sheets[0].placements[0].x",
        "missing",
    ),
    "no boolean": (
        lambda sheets: sheets[0]["placements"][0].update(fixed=1),  # type: ignore[index]
        "sheets[0].placements[0].fixed",
        "1 where true or false belongs",
    ),
    "unknown key": (
        lambda sheets: sheets[0]["placements"][0].update(fix=True),  # type: ignore[index]
        "sheets[0].placements[0].fix",
        "unknown key",
    ),
    "sheet twice": (
        lambda sheets: sheets[1].update(index=1),
        "sheets[1].index",
        'sheet 1 of "sheet" is there twice',
    ),
    "no table": (
        lambda sheets: sheets.append(3),  # type: ignore[arg-type]
        "sheets[3]",
        "3 where a table belongs",
    ),
    "no array": (
        lambda sheets: sheets[0].update(placements=None),
        "sheets[0].placements",
        "nothing (null) where an array belongs",
    ),
}


def refused(job: Job, file: Path) -> list[tuple[str, str]]:
    """Return path and message of every problem; all name the file and a line."""
    with pytest.raises(BadInputError) as caught:
        with_layout(job, file)
    assert all(problem.file == str(file) and problem.line for problem in caught.value.problems)
    return [(problem.path, problem.message) for problem in caught.value.problems]


@pytest.fixture(scope="module")
def job(tmp_path_factory: pytest.TempPathFactory) -> Job:
    return job_of(read(write_job(tmp_path_factory.mktemp("job"), TEXT)))


@pytest.fixture
def layout() -> Layout:
    """The layout of the job of these tests, as a person would write it."""
    plates = [{"part": "plate", "copy": n, "x": 0.0, "y": 0.0, "angle": 0, "mirrored": False} for n in range(1, 6)]
    cone = {"part": "strip", "copy": 1, "x": 0.0, "y": 0.0, "angle": 0, "mirrored": False}
    lots = [plates[:2], plates[2:4], [plates[4], cone]]
    sheets = [{"stock": "sheet", "index": i, "placements": lot} for i, lot in enumerate(lots, 1)]
    return {"schema": "planish-layout/1", "sheets": sheets}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_the_file_is_told_with_its_place_and_nothing_else(
    tmp_path: Path, job: Job, layout: Layout, name: str
) -> None:
    edit, path, message = FAULTS[name]
    edit(sheets_of(layout))
    ((found_path, found),) = refused(job, stored(tmp_path, layout))
    assert found_path == path
    assert message in found


def test_all_faults_are_told_at_once_in_the_order_of_the_file(tmp_path: Path, job: Job, layout: Layout) -> None:
    sheets = sheets_of(layout)
    sheets[0]["placements"][0].update(part="nope", x=float("nan"))  # type: ignore[index]
    sheets[0]["placements"][1].update(copy=9)  # type: ignore[index]
    sheets[1]["stock"] = "none"
    sheets[2]["placements"][1].update(angle=None)  # type: ignore[index]
    assert [path for path, _ in refused(job, stored(tmp_path, layout))] == [
        "sheets[0].placements[0].part",
        "sheets[0].placements[0].x",
        "sheets[0].placements[1].copy",
        "sheets[1].stock",
        "sheets[2].placements[1].angle",
    ]


def test_more_sheets_than_there_are_is_a_fault_of_the_file(tmp_path: Path, layout: Layout) -> None:
    few = job_of(read(write_job(tmp_path, TEXT.replace('id = "sheet"', 'id = "sheet"\nquantity = 2'))))
    ((path, message),) = refused(few, stored(tmp_path, layout))
    assert (path, message) == ("sheets[2].stock", 'more sheets of "sheet" are used than there are: 2')
    sheets_of(layout)[1]["placements"][0]["fixed"] = True  # type: ignore[index]
    assert with_layout(few, stored(tmp_path, layout)).layout is not None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "JSON"),
        ("[]", "one table"),
        ("{}", "missing"),
        ('{"schema": "planish-layout/9", "sheets": []}', "is no layout"),
        ('{"schema": "planish-report/1"}', "where an array belongs"),
        ('{"schema": "planish-layout/1", "sheets": {}}', "where an array belongs"),
    ],
)
def test_what_is_no_layout_is_refused(tmp_path: Path, job: Job, text: str, message: str) -> None:
    (tmp_path / "layout.json").write_text(text, "utf-8")
    ((_, found),) = refused(job, tmp_path / "layout.json")
    assert message in found


def test_a_job_without_stock_takes_no_layout(tmp_path: Path, layout: Layout) -> None:
    bare = job_of(read(write_job(tmp_path)))
    with pytest.raises(BadInputError, match="no stock"):
        with_layout(bare, stored(tmp_path, layout))
