"""Rows of the benchmark: which layout counts, which run is the median, what is printed."""

from dataclasses import dataclass

import msgspec
import pytest

from tests.bench.nest.__main__ import chosen, main, parsed
from tests.bench.nest.engines import Run
from tests.bench.nest.instances import FOLDER
from tests.bench.nest.layouts import Said, Spot
from tests.bench.nest.made import made, many
from tests.bench.nest.table import HEADS, Asked, Report, Row, against, best, median, row, text
from tests.bench.nest.test_layouts import BARS, GOOD

BAD = [*GOOD[:2], Spot("bar", "sheet", 0, 5.0, 20.0, 0.0)]
ASKED = Asked("1.2", 3, 5.0)


def told(*said: Said) -> Row:
    return row(BARS, "engine", ASKED, Run(said, 5.1, 9.9))


def test_the_last_valid_layout_counts_and_later_invalid_ones_are_told() -> None:
    found = told(Said(GOOD), Said(BAD), Said(BAD))
    assert (found.valid, found.sheets) == ("valid", 2)
    assert found.remark.startswith("2 invalid: ")


def test_an_engine_whose_layouts_all_overlap_is_flagged() -> None:
    found = told(Said(BAD))
    assert (found.valid, found.sheets) == ("INVALID", 1)
    assert "overlap" in found.remark or "apart" in found.remark
    assert "INVALID" in text([found])


@pytest.mark.parametrize(
    ("said", "remark"),
    [
        ((), "no layout in time"),
        ((Said(error="panic"),), "panic"),
        ((Said(unable="strips only"),), "not offered: strips only"),
    ],
)
def test_an_engine_without_a_layout_says_why(said: tuple[Said, ...], remark: str) -> None:
    found = told(*said)
    assert (found.valid, found.sheets, found.density, found.remark) == ("-", 0, None, remark)
    assert best(said, BARS) == (None, remark)


@dataclass
class Worth:
    valid: str
    sheets: int
    density: float | None
    equivalent: float | None = None
    engine: str = ""
    instance: str = ""


def test_the_median_is_the_middle_by_validity_sheets_and_density() -> None:
    runs = [Worth("valid", 2, 0.8, 0.85), Worth("valid", 2, 0.8, 0.9), Worth("INVALID", 1, 0.99)]
    assert median(runs) is runs[0]
    assert median(runs[:2]) is runs[0], "of two the worse"
    assert median([Worth("valid", 1, 0.7), Worth("rounding", 1, 0.8), Worth("valid", 1, 0.9)]).density == 0.8


def test_means_are_taken_where_both_have_a_valid_layout() -> None:
    rows = [
        Worth("valid", 1, 0.80, None, "ours", "a"),
        Worth("rounding", 1, 0.75, None, "rival", "a"),
        Worth("valid", 1, 0.5, 0.90, "ours", "b"),
        Worth("valid", 1, 0.5, 0.91, "rival", "b"),
        Worth("valid", 1, 0.99, None, "ours", "c"),
        Worth("INVALID", 1, 0.1, None, "rival", "c"),
        Worth("-", 0, None, None, "other", "a"),
    ]
    assert against(rows, "ours") == ["ours and rival: 85.00 and 83.00 % on 2 instances, least ahead on b: -1.00 points"]


def test_the_table_has_its_heads_and_a_line_for_each_row() -> None:
    lines = text([told(Said(GOOD)), told()]).splitlines()
    assert len(lines) == 4
    assert all(head in lines[0] for head in HEADS)
    assert "12.00" in lines[2]
    assert "2 sheets" in lines[2]


def test_without_a_folder_the_stored_the_jigsaws_and_the_ring_are_run() -> None:
    names = [one.name for one in chosen(parsed([]))]
    assert len(names) == 9
    assert [f"strip_jigsaw20-s{seed}" for seed in range(1, 6)] == names[3:8]
    assert {one.name for one in made()} == set(names[3:])
    assert [one.name for one in chosen(parsed([str(FOLDER)]))] == names[:3]
    assert [one.name for one in chosen(parsed(["--only", "ring"]))] == ["ring_gap2"]


def test_strips_can_be_put_on_sheets() -> None:
    (found,) = chosen(parsed([str(FOLDER), "--sheets", "63x79"]))
    assert (found.stock[0].width_mm, found.stock[0].height_mm) == (63.0, 79.0)


def test_many_parts_are_all_different() -> None:
    assert len({str(one.shape) for one in many(100).items}) == 100


def test_planish_runs_in_the_table_and_its_layout_is_valid(tmp_path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "rows.json"
    main(["--only", "ring_gap2", "--engines", "planish,none", "--seconds", "0.5", "--json", str(file)])
    report = msgspec.json.decode(file.read_bytes(), type=Report)
    assert [(one.instance, one.engine, one.valid, one.sheets) for one in report.rows] == [
        ("ring_gap2", "planish", "valid", 1)
    ]
    printed = capsys.readouterr()
    assert "ring_gap2" in printed.out
    assert report.machine in printed.out
    assert "none: not installed" in printed.err
