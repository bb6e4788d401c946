"""The summary of a batch: what is counted, what is listed, and that names stay text in all three files."""

import csv
import io
import json
import re
from collections.abc import Iterator

import pytest

from pipeline.report.document import Document
from pipeline.report.summary import COLUMNS, summary, summary_files
from pipeline.report.summaryrows import JobRow, grouped, job_row
from pipeline.report.summarytally import BINS, CAUSES, LISTED, OTHERS, SHOWN_CAUSES, tally
from tests.near import assert_relative

HOSTILE = '<script>alert("x")</script>=cmd()\''
NEXT_UP = 0.25000000000000006
"""The next double above 0.25."""


def report(value: float = 0.1, *, part: str = "hood", code: str = "", formats: list[str] | None = None) -> bytes:
    """Return the report of a job with one part and one check, which is at most 0.25."""
    good = value <= 0.25
    metric = {
        "name": "outer_fibre_strain",
        "value": value,
        "unit": "",
        "evidence": "sampled",
        "limit": 0.25,
        "pass": good,
    }
    free = {"name": "turn_deg", "value": 1e9, "unit": "deg", "evidence": "proved", "limit": None, "pass": True}
    found = [{"code": code, "message": "", "fatal": True}] if code else []
    stage = {"stage": "verify", "status": "pass" if good else "fail", "metrics": [free, metric], "findings": found}
    bare: dict[str, object] = {"status": "pass", "metrics": [], "findings": []}
    sheets = [{"stock": "s", "index": 1, "utilisation": share, "mass_kg": None, "cut_length_mm": None, "pierces": None,
               "used_length_mm": None, "offcut": None, "cost": None} for share in (0.5, 0.75)]  # fmt: skip
    one = {"name": part, "quantity": 1, "class": "exact" if good else "rejected", "flat": None, "surface": None,
           "mass_kg": None, "cut_length_mm": None, "pierces": None, "stages": [stage]}  # fmt: skip
    return json.dumps({
        "schema": "planish-report/1", "status": "made" if good else "rejected",
        "job": {"name": "job", "formats": formats}, "parts": [one],
        "nest": {**bare, "sheets": sheets}, "write": {**bare, "files": []},
    }).encode()  # fmt: skip


def jobs(count: int) -> Iterator[JobRow]:
    """Yield jobs of which every fourth failed, their loads rising."""
    for i in range(count):
        value = 0.25 * i / count
        yield (
            job_row(f"j{i}", "made", "", 2.0, report(value))
            if i % 4
            else job_row(f"j{i}", "crashed", "SIGSEGV", 1.0, None)
        )


def crash(group: str) -> JobRow:
    """Return a job that left nothing."""
    return JobRow("job", "crashed", "", group, None, 0, 0, None, 0.0, ())


def listed(document: Document, key: str) -> list[dict]:
    found = document[key]
    assert isinstance(found, list)
    return found


def test_the_worst_number_of_a_job_is_nearest_to_its_limit() -> None:
    row = job_row("a", "made", "", 1.0, report(0.2))
    assert row.worst is not None
    assert (row.worst.metric, row.worst.load, row.reached) == ("outer_fibre_strain", 0.8, "exact")
    assert row.utilisation == 0.625


def test_a_value_on_its_limit_passes_and_the_next_one_fails() -> None:
    on, beyond = (
        job_row("a", status, "", 1.0, report(value)) for status, value in (("made", 0.25), ("rejected", NEXT_UP))
    )
    assert (on.failed, beyond.failed) == (0, 1)
    (first, second) = listed(tally([on, beyond]), "worst_parts")
    assert (first["pass"], second["pass"], second["load"]) == (False, True, 1.0)


def test_a_cause_is_the_code_of_a_finding_else_the_metric_else_the_text() -> None:
    coded = job_row("a", "rejected", "told", 1.0, report(0.3, code="bend-strain"))
    measured = job_row("b", "rejected", "told", 1.0, report(0.3))
    told = job_row("c", "bad-input", "jobs.jsonl:17: expected 'x' or 2.5e-3", 0.1, None)
    assert [row.group for row in (coded, measured, told)] == [
        "bend-strain", "outer_fibre_strain", "bad-input: jobs.jsonl:#: expected … or #",
    ]  # fmt: skip


def test_like_causes_are_grouped_and_long_ones_cut() -> None:
    assert grouped("more than 60 s") == grouped("more than 7.5 s")
    assert len(grouped("x" * 300)) == 120


@pytest.mark.parametrize("one", [
    "/jobs/anna.toml:23:11: part[0].surface.radius0: -5 mm (a radius may not be negative)",
    "/jobs/1b/bert.toml:9:1: part[12].surface.radius0: -7.5 mm (a radius may not be negative)",
    "/orders.csv: part[3].surface.radius0: -1e-3 mm (a radius may not be negative)",
])  # fmt: skip
def test_one_mistake_in_several_files_is_one_cause(one: str) -> None:
    assert grouped(one) == "part[#].surface.radius0: # mm (a radius may not be negative)"


def test_another_key_is_another_cause_and_folders_are_none() -> None:
    first, second = (grouped(f"/a.toml:1:1: part[0].surface.k{i}: 3 (at most 2)") for i in (0, 1))
    assert (first, second) == ("part[#].surface.k0: # (at most #)", "part[#].surface.k1: # (at most #)")
    missing = (f"/{n}/job.toml:2:8: part[0].surface.file: there is no file h.stl (looked for /{n}/h.stl)" for n in "ab")
    assert {*map(grouped, missing)} == {"part[#].surface.file: there is no file h.stl (looked for …)"}
    assert grouped("speed in mm/min of 1/8 in") == "speed in mm/min of #/# in"


def test_a_pareto_falls_and_comes_to_all() -> None:
    rows = [
        JobRow(f"{k}-{i}", "crashed", "", f"cause {k}", None, 0, 0, None, 0.0, ())
        for k in range(80)
        for i in range(k + 1)
    ]
    causes = listed(tally(rows), "causes")
    counts = [one["jobs"] for one in causes[:-1]]
    assert len(counts) == SHOWN_CAUSES
    assert counts == sorted(counts, reverse=True)
    assert causes[-1]["cause"] == OTHERS
    assert sum(one["jobs"] for one in causes) == len(rows)
    assert causes[-1]["cumulative"] == 1.0


def test_kinds_of_causes_are_counted_without_end_and_kept_within_bounds() -> None:
    rows = (crash(f"cause {'x' * k}") for k in range(2 * CAUSES))
    causes = listed(tally(rows), "causes")
    assert len(causes) <= SHOWN_CAUSES + 1
    assert sum(one["jobs"] for one in causes) == 2 * CAUSES


@pytest.mark.parametrize("count", [1, BINS, BINS + 1, 1000])
def test_a_trend_counts_every_job_once_in_their_order(count: int) -> None:
    bins = listed(tally(jobs(count)), "trend")
    assert len(bins) <= BINS
    assert sum(one["jobs"] for one in bins) == count
    assert (bins[0]["first"], bins[-1]["last"]) == ("j0", f"j{count - 1}")
    loads = [one["largest_load"] for one in bins if one["largest_load"] is not None]
    assert loads == sorted(loads)
    seconds = sum(one["mean_seconds"] * one["jobs"] for one in bins)
    assert_relative(seconds, sum(row.seconds for row in jobs(count)), bound=1e-12, why="a sum of small whole numbers")


def test_the_worst_are_listed_and_no_more() -> None:
    document = tally(jobs(3000))
    worst = listed(document, "worst_jobs")
    assert len(worst) == len(listed(document, "worst_parts")) == LISTED
    assert {one["status"] for one in worst} == {"crashed"}
    assert listed(document, "worst_parts")[0]["job"] == "j2999"
    assert [one["jobs"] for one in listed(document, "statuses")] == [2250, 750]


def test_names_stay_text_in_every_file() -> None:
    rows = [job_row(HOSTILE, "made", "", 1.0, report(part=HOSTILE)), job_row("=cmd()", "crashed", HOSTILE, 1.0, None)]
    files = summary_files(rows)
    page = files["summary.html"].decode()
    assert page.count("<script>") == 1
    assert "&lt;script&gt;" in page
    assert not re.search(r"href=\"(?:https?:|//|javascript)", page)
    head, *table = csv.reader(io.StringIO(files["summary.csv"].decode(), newline=""))
    assert tuple(head) == COLUMNS
    assert [one[0] for one in table] == [HOSTILE, "'=cmd()"]
    assert json.loads(files["summary.json"])["worst_jobs"][0]["cause"] == HOSTILE


def test_every_number_of_the_page_is_one_of_the_document() -> None:
    files = summary_files(jobs(200))
    held = set(re.findall(r'<data value="([^"]*)"', files["summary.html"].decode()))
    known = set(re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", files["summary.json"].decode()))
    assert len(held) > 100
    assert held <= known


def test_a_job_leads_to_what_it_left() -> None:
    kept = {"page": report(formats=["json", "html"]), "bare": report(formats=["json"]), "old": report(), "lost": None}
    page = summary(job_row(name, "made", "", 1.0, content) for name, content in kept.items()).decode()
    led = {"page/report.html", "bare/report.json", "old/report.html"}
    assert set(re.findall(r'href="([^"#]+/[^"]*)"', page)) == led
    assert ">lost<" in page


def test_a_number_that_is_none_has_no_load() -> None:
    document = json.loads(report())
    metrics = document["parts"][0]["stages"][0]["metrics"]
    metrics[:] = [{**metrics[1], "value": value, "limit": limit} for value, limit in ((True, True), (None, 1.0))]
    assert job_row("a", "made", "", 1.0, json.dumps(document).encode()).held == ()


def test_one_of_a_thing_is_not_several() -> None:
    page = summary([job_row("a", "made", "", 1.0, report())]).decode()
    assert "1 of 1 job made" in page
    assert "1 part, 0 refused by their geometry" in page


def test_the_same_jobs_give_the_same_bytes() -> None:
    assert summary(jobs(50)) == summary(jobs(50))
    assert summary(jobs(50)) != summary(jobs(51))


def test_no_jobs_make_a_page() -> None:
    page = summary([]).decode()
    assert "0 of 0 jobs made" in page
    assert "Nothing was refused." in page
