"""`summary.html`, `summary.json`, `summary.csv`: what became of a batch, in the style of the report of a job.

The page is readable above for any number of jobs: what was made, the causes of what was not (a Pareto), trends over the
jobs in their order, and the worst parts and jobs, each with a link to its report.  It stands without scripts; those
that it has sort and filter the lists.  It holds no number that is not in `summary.json`.  Jobs are read once.
"""

import csv
import io
import json
from collections.abc import Iterable, Iterator, Mapping
from urllib.parse import quote

from pipeline.report.document import Document
from pipeline.report.html import STYLES, Row, entries
from pipeline.report.markup import Child, Element, element, shown
from pipeline.report.pages import asset, page
from pipeline.report.results import guarded, number
from pipeline.report.summarycharts import bars, charts, heading
from pipeline.report.summaryrows import MADE, JobRow
from pipeline.report.summarytally import LISTED, tally
from pipeline.report.traveller.numbers import counted

COLUMNS = (
    "job", "status", "cause", "class", "parts", "parts_failed", "utilisation", "seconds", "part", "stage", "metric",
    "value", "unit", "limit", "load", "evidence",
)  # fmt: skip


def summary(rows: Iterable[JobRow]) -> bytes:
    """Return the page of the jobs of a batch."""
    return summary_html(tally(rows))


def summary_files(rows: Iterable[JobRow]) -> dict[str, bytes]:
    """Return page, document and table of the jobs of a batch; the table has every job."""
    table = io.StringIO(newline="")
    document = tally(_written(rows, table))
    return {
        "summary.html": summary_html(document),
        "summary.json": (json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode(),
        "summary.csv": table.getvalue().encode(),
    }


def _written(rows: Iterable[JobRow], table: io.StringIO) -> Iterator[JobRow]:
    """Yield the rows, each written to the table on its way."""
    writer = csv.writer(table, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow(csv_cells(row))
        yield row


def csv_cells(row: JobRow) -> tuple[str, ...]:
    """Return the cells of a job: its worst number has the last ones."""
    held = row.worst
    own = (guarded(row.job), row.status, guarded(row.cause), guarded(row.reached or ""))
    counts = (str(row.parts), str(row.failed), number(row.utilisation), number(row.seconds))
    if held is None:
        return (*own, *counts, *[""] * (len(COLUMNS) - len(own) - len(counts)))
    names = (guarded(held.part), guarded(held.stage), guarded(held.metric))
    return (
        *own, *counts, *names, number(held.value), guarded(held.unit), number(held.limit), number(held.load),
        guarded(held.evidence),
    )  # fmt: skip


def summary_html(document: Document) -> bytes:
    """Return the page of a summary."""
    statuses = {str(one["status"]): one for one in entries(document, "statuses")}
    blocks = {
        "STYLE": asset(*STYLES, "summary.css"),
        "VERDICT": verdict(document, statuses).text,
        "STATUSES": bars(list(statuses.values()), "status").text,
        "CAUSES": causes(document).text,
        "TREND": charts(list(entries(document, "trend"))).text,
        "PARTS": worst_parts(document).text,
        "JOBS": worst_jobs(document).text,
        "FOOT": f"planish-summary/1 \u00b7 load: value over limit; lists hold the worst {LISTED}",
        "SCRIPT": asset("format.js", "summary.js"),
    }
    return page("summary.html", blocks)


def verdict(document: Document, statuses: Mapping[str, Row]) -> Element:
    """Return what comes first: how many jobs were made."""
    jobs, made = document["jobs"], statuses.get(MADE, {}).get("jobs", 0)
    good = jobs == made
    parts = counted(int(str(document["parts"])), "part")
    more = f"{parts}, {document['parts_failed']} refused by their geometry, {shown(document['seconds'], 's')} of work."
    word = f"{sign(good)} {made} of {counted(int(str(jobs)), 'job')} made"
    return element(
        "div", element("h1", "Batch"), element("div", word, cls="word"), element("div", more),
        id="verdict", role="status", cls=None if good else "bad",
    )  # fmt: skip


def sign(good: bool) -> str:
    """Return what says good or bad without a colour."""
    return "\u2713" if good else "\u2717"


def link(one: Row) -> Child:
    """Return the name of a job, as a link to its report where it left one."""
    name, report = str(one["job"]), one["report"]
    return name if report is None else element("a", name, href=f"{quote(name, safe='')}/{report}")


def causes(document: Document) -> Element:
    """Return the causes of what was not made, the most frequent first."""
    found = list(entries(document, "causes"))
    if not found:
        return element("p", "Nothing was refused.")
    return bars(found, "cause")


def worst_parts(document: Document) -> Element:
    """Return the parts that are nearest to a limit, or beyond one."""
    heads = ("Job", "Part", "Metric", "Value", "Limit", "Load", "Verdict", "Evidence")
    rows = [
        row(
            link(one), str(one["part"]), f"{one['stage']} {one['metric']}",
            figure(one["value"], one["unit"]), figure(one["limit"], one["unit"]), figure(one["load"]),
            passed(one["pass"] is True), str(one["evidence"]),
        )
        for one in entries(document, "worst_parts")
    ]  # fmt: skip
    return listing("worst-parts", "Parts nearest to a limit or beyond one, the worst first", heads, rows)


def worst_jobs(document: Document) -> Element:
    """Return the jobs that went worst."""
    heads = ("Job", "Status", "Class", "Cause", "Parts", "Failed", "Load", "Seconds")
    rows = [job_row(one) for one in entries(document, "worst_jobs")]
    return listing("worst-jobs", "Jobs, the gravest failure first", heads, rows)


def job_row(one: Row) -> Element:
    """Return the row of a job."""
    worst, status = one["worst"], str(one["status"])
    told = element("span", f"{sign(status == MADE)} {status}", cls="pass" if status == MADE else "fail")
    load = worst.get("load") if isinstance(worst, dict) else None
    figures = (figure(value) for value in (one["parts"], one["parts_failed"], load, one["seconds"]))
    return row(link(one), told, str(one["class"] or "\u2013"), str(one["cause"]), *figures)


def passed(good: bool) -> Element:
    """Return the verdict of a check."""
    word = "pass" if good else "fail"
    return element("span", f"{sign(good)} {word}", cls=word)


def figure(value: object, unit: object = "") -> Element:
    """Return a number: rounded to be read, in full in its title."""
    full = None if value is None else json.dumps(value)
    return element("data", shown(value, str(unit)), value=full, title=full)


def row(*cells: Child) -> Element:
    """Return a row of a table."""
    return element("tr", *(element("td", cell, cls="n" if _is_figure(cell) else None) for cell in cells))


def _is_figure(cell: Child) -> bool:
    return isinstance(cell, Element) and cell.text.startswith("<data")


def listing(name: str, caption: str, heads: Iterable[str], rows: list[Element]) -> Element:
    """Return a table that can be filtered and sorted; a line that says so where it would be empty."""
    if not rows:
        return element("p", "None.")
    head = element("thead", element("tr", *map(heading, heads)))
    table = element("table", element("caption", caption, cls="unseen"), head, element("tbody", *rows), id=name)
    find = element("label", "Find ", element("input", type="search", data_table=name, autocomplete="off"))
    controls = element("div", find, element("span", cls="count", role="status"), cls="controls")
    return element(
        "div", controls, element("div", table, cls="scroll", tabindex="0", role="region", aria_label=caption)
    )
