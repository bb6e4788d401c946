"""results.csv: every number of the report and no other, read back as any program would read it."""

import csv
import io
import json

import pytest

from pipeline.report.entries import entries
from pipeline.report.results import COLUMNS, guarded, results_csv
from pipeline.report.rows import rows, unit_of
from tests.pipeline.reports import JOBS, Report, changed, made, numbers

Rows = list[dict[str, str]]


def table(report: Report) -> Rows:
    text = results_csv(report).decode()
    return list(csv.DictReader(io.StringIO(text, newline="")))


def value_of(found: Rows, part: str, stage: str, metric: str) -> str:
    (row,) = (row for row in found if (row["part"], row["stage"], row["metric"]) == (part, stage, metric))
    return row["value"]


@pytest.mark.parametrize("name", JOBS)
def test_every_metric_has_a_row_with_its_value_limit_verdict_and_evidence(name: str) -> None:
    report, files = made(name)
    read = entries(report)
    stages = [(part.name, stage.stage, stage) for part in read.parts for stage in part.stages]
    stages += [("", "nest", read.nest), ("", "write", read.write)]
    found = list(csv.reader(io.StringIO(files["results.csv"].decode(), newline="")))
    assert tuple(found[0]) == COLUMNS
    for part, stage, entry in stages:
        for metric in entry.metrics:
            limit = "" if metric.limit is None else json.dumps(metric.limit)
            value = "" if metric.value is None else json.dumps(metric.value)
            row = [part, stage, metric.name, value, metric.unit, limit, json.dumps(metric.passed), metric.evidence]
            assert row in found


@pytest.mark.parametrize("name", JOBS)
def test_no_number_is_not_in_the_report(name: str) -> None:
    report, _ = made(name)
    known = numbers(report)
    cells = [row[column] for row in table(report) for column in ("value", "limit")]
    told = {float(cell) for cell in cells if cell not in ("", "true", "false")}
    assert told
    assert told <= known


def test_a_number_that_is_not_in_the_report_would_be_seen() -> None:
    report, _ = made("flat only")
    other = changed(report, 1200.0000000001, "parts", 0, "flat", "area")
    told = {float(row["value"]) for row in table(other) if row["metric"] == "area" and row["stage"] == "flat"}
    assert not told <= numbers(report)


def test_figures_of_flat_and_surface_sheets_and_parts_are_told_by_their_paths() -> None:
    report, _ = made("nested")
    found = table(report)
    part, nest = entries(report).parts[1], entries(report).nest
    assert part.flat is not None
    assert part.surface is not None
    assert value_of(found, "cone", "flat", "area") == json.dumps(part.flat["area"])
    edges = part.surface["edges"]
    assert isinstance(edges, dict)
    assert value_of(found, "cone", "surface", "edges.c0") == json.dumps(edges["c0"])
    assert value_of(found, "cone", "part", "mass_kg") == json.dumps(part.mass_kg)
    assert value_of(found, "", "sheet", "sheet-1.utilisation") == json.dumps(nest.sheets[0].utilisation)
    assert value_of(found, "", "sheet", "sheet-1.cost") == "12.5"
    flat = [row for row in found if row["stage"] in ("flat", "surface", "part", "sheet", "cost")]
    assert all((row["limit"], row["pass"], row["evidence"]) == ("", "", "") for row in flat)


def test_decimals_are_the_shortest_that_come_back() -> None:
    report, _ = made("flat only")
    for value in (0.1, 1e-300, 1 / 3, 5e22, 2**53, -0.0, 1.7976931348623157e308):
        found = table(changed(report, value, "parts", 0, "flat", "area"))
        cell = value_of(found, "plate", "flat", "area")
        assert cell == repr(value)
        assert json.loads(cell) == value


def test_a_part_that_fails_by_a_finding_has_a_row_that_is_not_passed() -> None:
    report, _ = made("rejected")
    assert any(row["part"] == "twisted" and row["pass"] == "false" for row in table(report))
    stage = {"stage": "verify", "status": "fail", "metrics": [], "findings": []}
    for findings, name in (([], "status"), ([{"code": "warp", "message": "m", "fatal": True, "where": {}}], "warp")):
        failed = changed(report, [{**stage, "findings": findings}], "parts", 1, "stages")
        (row,) = (row for row in table(failed) if (row["part"], row["stage"]) == ("twisted", "verify"))
        assert (row["metric"], row["value"], row["pass"]) == (name, "", "false")


HOSTILE = [
    "=cmd()",
    "+1",
    "-1",
    "@x",
    "\t=1",
    "\r=1",
    "\n=1",
    '"quotes", commas',
    "two\r\nlines",
    "<script>alert(1)</script>",
    "Größe ß 型",
    "n" * 300,
    "'",
]


@pytest.mark.parametrize("name", HOSTILE)
def test_names_stay_text_and_come_back(name: str) -> None:
    report, _ = made("flat only")
    found = table(changed(report, name, "parts", 0, "name"))
    (cell,) = {row["part"] for row in found if row["stage"] == "flat"}
    assert cell in (name, f"'{name}")
    assert not cell.startswith(("=", "+", "-", "@", "\t", "\r", "\n"))


def test_negative_numbers_are_no_text() -> None:
    report, _ = made("flat only")
    found = table(changed(report, -1.5, "parts", 0, "flat", "corners", 0, 0))
    assert value_of(found, "plate", "flat", "corners.0.x") == "-1.5"
    assert guarded("-1.5") == "'-1.5"


def test_marks_of_one_name_have_rows_of_their_own() -> None:
    report, _ = made("flat only")
    mark = {"name": "m", "x": 1.0, "y": 2.0, "distance": 0.0}
    read = entries(changed(report, [mark, {**mark, "x": 3.0}], "parts", 0, "flat", "marks"))
    told = {row.metric: row.value for row in rows(read) if row.metric.startswith("marks.m.x")}
    assert told == {"marks.m.x": 1.0, "marks.m.x (2)": 3.0}


def test_units_follow_from_the_last_key() -> None:
    paths = ("area", "marks.a.x", "offcut.width_mm", "total.mass_kg", "time_s", "pierces", "utilisation")
    assert [unit_of(path) for path in paths] == ["mm2", "mm", "mm", "kg", "s", "", ""]


def test_lines_end_and_bytes_begin_as_rfc_4180_and_utf_8_have_it() -> None:
    _, files = made("flat only")
    text = files["results.csv"]
    assert text.startswith(b"part,stage,metric,value,unit,limit,pass,evidence\r\n")
    assert text.count(b"\n") == text.count(b"\r\n")
    assert text.endswith(b"\r\n")
