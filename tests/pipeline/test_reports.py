"""Reports read back: rendered again to the same bytes, refused where they are broken, compared with one another."""

import json
from math import inf, nextafter
from pathlib import Path

import jsonschema
import pytest

from pipeline.cli import main
from pipeline.jobfile import ReportTable
from pipeline.report.comparison import compare, comparison_document
from pipeline.report.comparisontable import comparison_lines
from pipeline.report.render import FORMATS
from pipeline.report.schema import report_schema
from pipeline.reports import Folder, render_again, stored
from stages.errors import BadInputError
from tests.pipeline.jobs import PLATE, STOCK, write_job
from tests.pipeline.reports import ALL, JOBS, Report, changed, made, output

SCHEMA = json.loads(report_schema())


def planish(*words: str | Path) -> int:
    """Return the exit code of a command."""
    with pytest.raises(SystemExit) as caught:
        main([str(word) for word in words])
        raise SystemExit(0)
    return int(caught.value.code or 0)


def spoil(out: Path, report: Report) -> Path:
    (out / "report.json").write_text(json.dumps(report), "utf-8")
    return out


@pytest.mark.parametrize("name", JOBS)
def test_rendering_again_writes_the_bytes_of_the_run(tmp_path: Path, name: str) -> None:
    out = output(tmp_path, name)
    before = dict(Folder(out))
    for path in ("results.csv", "junit.xml"):
        (out / path).write_bytes(b"lost")
    _, written = render_again(out)
    assert {"results.csv", "junit.xml"} <= set(written)
    assert dict(Folder(out)) == before


def test_only_what_the_job_asks_for_is_rendered_and_what_is_asked_for_besides(tmp_path: Path) -> None:
    out = output(tmp_path, "flat only")
    report = stored(out).made.report
    spoil(out, changed(dict(report), ["json", "junit"], "job", "formats"))
    assert render_again(out)[1] == ["junit.xml"]
    assert render_again(out, ["csv"])[1] == ["results.csv", "junit.xml"]


def test_a_job_has_every_format_unless_it_says_otherwise(tmp_path: Path) -> None:
    assert {"csv", "junit"} <= {*ReportTable().formats} <= {"json", "png", *FORMATS}
    write_job(tmp_path, PLATE + STOCK)
    assert planish("run", tmp_path / "job.toml", "-o", tmp_path / "o", "--quiet") == 0
    assert not {"results.csv", "junit.xml"} & {path.name for path in (tmp_path / "o").iterdir()}


def test_a_pool_has_the_formats_of_each_group_in_its_folder(tmp_path: Path) -> None:
    text = (PLATE + STOCK).replace('formats = ["json"]', ALL)
    write_job(tmp_path, text)
    assert planish("run", tmp_path / "job.toml", "-o", tmp_path / "a", "--quiet") == 0
    assert planish("nest", tmp_path / "a", "-o", tmp_path / "pool", "--quiet") == 0
    before = dict(Folder(tmp_path / "pool"))
    (table,) = (path for path in before if path.endswith("/results.csv"))
    assert b"utilisation" in before[table]
    _, written = render_again(tmp_path / "pool")
    assert table in written
    assert dict(Folder(tmp_path / "pool")) == before
    assert planish("report", tmp_path / "pool", tmp_path / "pool") == 0


BROKEN: dict[str, tuple[object, tuple[str | int, ...], str, str]] = {
    "a value that is text": ("x", ("parts", 0, "stages", 0, "metrics", 0, "value"), "metrics[0].value", "str"),
    "no verdict": (None, ("parts", 0, "stages", 0, "metrics", 0, "pass"), "metrics[0].pass", "bool"),
    "no parts": (None, ("parts",), "parts", "array"),
    "newer": ("planish-report/2", ("schema",), "schema", "newer"),
    "another document": ("planish-cut/1", ("schema",), "schema", "no report"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_or_newer_report_is_refused_with_place_and_remedy(tmp_path: Path, name: str) -> None:
    value, path, place, message = BROKEN[name]
    out = output(tmp_path, "flat only")
    before = (out / "results.csv").read_bytes()
    spoil(out, changed(dict(stored(out).made.report), value, *path))
    with pytest.raises(BadInputError) as caught:
        render_again(out)
    (problem,) = caught.value.problems
    assert problem.path.endswith(place)
    assert message in problem.message
    assert problem.hint
    assert problem.file.endswith("report.json")
    assert (out / "results.csv").read_bytes() == before


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "nul", '{"schema": NaN}', '{"schema": 1}', '{"schema": "planish-pool/1"}', "\xff"]
)
def test_what_is_no_report_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "report.json").write_text(text, "latin-1")
    with pytest.raises(BadInputError):
        stored(tmp_path)


def test_a_group_outside_the_folder_is_refused(tmp_path: Path) -> None:
    pool = {"schema": "planish-pool/1", "groups": [{"name": "../x"}]}
    with pytest.raises(BadInputError, match="is no folder"):
        stored(spoil(tmp_path, pool))


def test_the_command_tells_paths_prints_the_report_and_refuses_what_it_does_not_know(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = output(tmp_path, "rejected")
    assert planish("report", out, "--json") == 0
    told = capfd.readouterr()
    assert told.out == (out / "report.json").read_text("utf-8")
    assert str(out / "results.csv") in told.err
    assert planish("report", out, "--format", "docx") == 2
    assert planish("report", out, out, out) == 2
    assert planish("report", out, out, "--format", "csv") == 2
    assert planish("report", tmp_path / "none") == 2


def test_the_schema_is_printed_and_carries_its_version(capfd: pytest.CaptureFixture[str]) -> None:
    assert planish("schema", "--report") == 0
    schema = json.loads(capfd.readouterr().out)
    assert schema == SCHEMA
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["properties"]["schema"]["const"] == schema["title"]
    assert schema["$id"].endswith(schema["title"].rpartition("/")[2])


@pytest.mark.parametrize("name", JOBS)
def test_a_run_compared_with_itself_has_no_change(name: str) -> None:
    report, _ = made(name)
    other = changed(report, {"seconds": 1.0}, "run")
    found = compare(report, other)
    assert found.same
    assert not found.worse
    assert comparison_lines(found) == ["nothing changed"]


def test_the_next_double_is_a_change() -> None:
    report, _ = made("flat only")
    other = changed(report, nextafter(1200.0, inf), "parts", 0, "flat", "area")
    (change,) = compare(report, other).changes
    assert (change.part, change.stage, change.metric, change.unit) == ("plate", "flat", "area", "mm2")
    assert (change.a, change.b, change.difference) == (1200.0, nextafter(1200.0, inf), nextafter(1200.0, inf) - 1200.0)
    assert change.verdict == ""


METRIC = {"name": "m", "value": 0.1, "unit": "", "evidence": "proved", "limit": 0.2, "pass": True, "where": None}
PLACE = ("parts", 0, "stages", 0, "metrics")


def test_verdicts_turn_worse_one_way_and_better_the_other() -> None:
    plain, _ = made("flat only")
    good, bad = changed(plain, [METRIC], *PLACE), changed(plain, [{**METRIC, "value": 0.3, "pass": False}], *PLACE)
    down, up = compare(good, bad), compare(bad, good)
    assert [change.verdict for change in down.changes] == ["worse"]
    assert [change.verdict for change in up.changes] == ["better"]
    assert (down.worse, up.worse) == (True, False)
    assert [change.verdict for change in compare(plain, bad).changes if change.present == "b"] == ["worse"]
    limited = compare(good, changed(good, [{**METRIC, "limit": 0.15}], *PLACE))
    assert [change.limits for change in limited.changes] == [(0.2, 0.15)]
    assert any("limit 0.2 -> 0.15" in line for line in comparison_lines(limited))


def test_classes_statuses_findings_settings_and_drawings_are_compared() -> None:
    report, _ = made("nested")
    assert compare(report, changed(report, "metal", "parts", 0, "class")).worse
    assert not compare(changed(report, "metal", "parts", 0, "class"), report).worse
    assert compare(report, changed(report, "rejected", "status")).worse
    finding = {"code": "c", "message": "m", "fatal": False, "where": {}}
    (found,) = compare(report, changed(report, [finding], "write", "findings")).changes
    assert (found.stage, found.metric, found.a, found.b, found.present) == ("write", "finding c", None, "m", "b")
    (limit,) = compare(report, changed(report, 0.5, "job", "tolerance", "chord_mm")).changes
    assert (limit.stage, limit.metric, limit.b) == ("job", "tolerance.chord_mm", 0.5)
    (named,) = compare(report, changed(report, "fox", "job", "customer")).changes
    assert (named.a, named.b, named.present) == (None, "fox", "both"), "said by both, known to one"
    drawn = compare(report, changed(report, "0" * 64, "write", "files", 0, "sha256"))
    assert [change for _, change in drawn.files] == ["changed"]
    assert not drawn.changes


def test_parts_that_came_and_went_are_named_and_their_numbers_are_not() -> None:
    one, two = made("flat only")[0], made("rejected")[0]
    found = compare(one, two)
    assert (found.added, found.removed, found.spoilt) == (("twisted",), (), ("twisted",))
    assert found.worse
    assert not any(change.part == "twisted" for change in found.changes)
    back = compare(two, one)
    assert (back.added, back.removed, back.spoilt) == ((), ("twisted",), ())


def test_names_do_not_reach_the_terminal_as_commands() -> None:
    report, _ = made("flat only")
    one = changed(report, "a\x1b[2J\nb", "parts", 0, "name")
    lines = comparison_lines(compare(one, changed(one, 1.0, "parts", 0, "flat", "area")))
    assert any("a\\x1b[2J\\x0ab" in line for line in lines)
    assert not any(character in line for line in lines for character in "\x1b\n")


def test_two_runs_are_compared_on_the_command_line(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    a, b = tmp_path / "a", tmp_path / "b"
    for folder in (a, b):
        folder.mkdir()
    one, two = output(a, "flat only"), output(b, "rejected")
    assert planish("report", one, one) == 0
    assert capfd.readouterr().out == "nothing changed\n"
    assert planish("report", one, two) == 1
    assert "part added: twisted" in capfd.readouterr().out
    assert planish("report", one, two, "--json") == 1
    document = json.loads(capfd.readouterr().out)
    assert (document["same"], document["worse"], document["parts"]["added"]) == (False, True, ["twisted"])
    found = compare(stored(one).made.report, stored(two).made.report)
    assert document == json.loads(json.dumps(comparison_document(found)))


def test_a_format_that_lacks_what_it_draws_is_refused_and_not_left_out(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="html needs files"):
        render_again(output(tmp_path, "flat only"), ["html"])
