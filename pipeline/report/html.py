"""`report.html`: the report as one page that opens from disk, with nothing loaded from anywhere.

The page is a template, a style sheet and scripts of this package, put together here, and the data as one JSON block in
which `<` is written as an escape: no text of a job can end it.  A short row for every part makes the table; the rest of
a part is a JSON text inside that block, read when the part is opened.  The policy in its head forbids any request.

The page holds the numbers of `report.json` and, to draw, those of `view.json`; it computes but positions and colours.
"""

from collections.abc import Iterator, Mapping, Sequence

from pipeline.report.document import Document, compact
from pipeline.report.meanings import MEANINGS
from pipeline.report.pages import asset, page
from pipeline.report.telling import told_of

STYLES = ("page.css", "print.css")
LIBRARY = "three.min.js"
SCRIPTS = (
    "view3d_places.js", "view3d_ruled.js", "view3d_mesh.js", "view3d_paint.js", "view3d_over.js", "view3d_hands.js",
    "view3d.js", "format.js", "data.js", "table.js", "paths.js", "strain.js",
    "heat.js", "plan.js", "flat.js", "sheets.js", "tape.js", "part.js", "page.js",
)  # fmt: skip
"""In the order in which they run; those of the 3D view define one global name each, the others share one."""

PAGE = "report.html"
MOST_INSIDE = 2000
"""Parts that the page holds itself: of some 27 kB each, what a phone still opens."""

PER_FILE = 50
"""Parts in a file beside the page: some 1.4 MB, which is there before anyone sees that it is loaded."""

BESIDE = " 'self' file:"
"""Where scripts may come from then: a page that was opened from a disk has no origin to be the same as."""

Row = Mapping[str, object]


def report_pages(report: Document, view: Document, most: int = MOST_INSIDE) -> dict[str, bytes]:
    """Return the page of a report, and above so many parts the files beside it, by their paths."""
    texts = part_texts(report, view)
    if len(texts) <= most:
        return {PAGE: report_html(report, view)}
    return {PAGE: _page(data_block(report, view, ()), BESIDE)} | {
        f"report/parts-{number}.js": _part_file(first, texts[first : first + PER_FILE])
        for number, first in enumerate(range(0, len(texts), PER_FILE))
    }


def _part_file(first: int, texts: Sequence[str]) -> bytes:
    """Return the script that hands parts to the page, counted from the first."""
    return f"planishParts({first},{_escaped(compact(texts))});\n".encode()


def report_html(report: Document, view: Document) -> bytes:
    """Return the page of a report with all in it; view: the document of `view.json` that was made with it."""
    return _page(data_block(report, view, part_texts(report, view)), "")


def _page(data: str, scripts: str) -> bytes:
    """Return the page with its data; scripts: where others than its own may come from."""
    blocks = {
        "SCRIPTS": scripts,
        "STYLE": asset(*STYLES),
        "DATA": data,
        "LIBRARY": asset(LIBRARY),
        "SCRIPT": asset(*SCRIPTS),
    }
    return page("page.html", blocks)


def part_texts(report: Document, view: Document) -> list[str]:
    """Return every part as a JSON text of its own: what is reported and what is drawn of it."""
    shapes = {str(entry["name"]): entry for entry in entries(view, "parts")}
    return [compact({"report": part, "view": shapes.get(str(part["name"]))}) for part in entries(report, "parts")]


def data_block(report: Document, view: Document, texts: Sequence[str]) -> str:
    """Return what the page shows as JSON; texts: of the parts, none if they lie beside the page."""
    parts = list(entries(report, "parts"))
    nest = report.get("nest")
    job = {key: value for key, value in report.items() if key not in ("parts", "nest", "run")}
    content = {
        "job": {**job, "run": _timeless(report.get("run"))},
        "nest": {**nest, "views": view.get("sheets", [])} if isinstance(nest, Mapping) else None,
        "rows": [summary(part) for part in parts],
        "parts": texts,
        "per_file": None if len(texts) == len(parts) else PER_FILE,
        "meanings": {name: MEANINGS[name] for name in sorted(metric_names(report)) if name in MEANINGS},
    }
    return _escaped(compact(content))


def _timeless(run: object) -> Document:
    """Return what is the same in every run of a job."""
    return {"version": run.get("version")} if isinstance(run, Mapping) else {}


def _escaped(text: str) -> str:
    """Return JSON without `<` and the line ends that are none in a script."""
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def entries(document: Mapping[str, object], key: str) -> Iterator[Row]:
    """Yield the objects of a list of a document; nothing where there is none."""
    listed = document.get(key)
    for entry in listed if isinstance(listed, list) else ():
        if isinstance(entry, Mapping):
            yield entry


def summary(part: Row) -> Document:
    """Return the row of a part: what the table shows of it, and for how many reasons it failed."""
    stages = list(entries(part, "stages"))
    metrics = [metric for stage in stages for metric in entries(stage, "metrics")]
    findings = [finding for stage in stages for finding in entries(stage, "findings")]
    strains = [metric["value"] for metric in metrics if metric["name"] == "max_strain"]
    return {
        "name": part["name"],
        "quantity": part["quantity"],
        "class": part["class"],
        "failed": sum(map(_reasons, stages)),
        "checks": sum(metric["limit"] is not None for metric in metrics),
        "findings": len(findings),
        "strain": strains[-1] if strains else None,
        "mass": part.get("mass_kg"),
    }


def _reasons(stage: Row) -> int:
    """Return for how many reasons a stage failed: a number past its limit and the finding that tells of it are one."""
    fatal = [str(one["code"]) for one in entries(stage, "findings") if one["fatal"]]
    told = told_of(fatal)
    return len(fatal) + sum(not one["pass"] and one["name"] not in told for one in entries(stage, "metrics"))


def metric_names(report: Document) -> set[str]:
    """Return the names of all metrics of a report."""
    stages = [stage for part in entries(report, "parts") for stage in entries(part, "stages")]
    ends = [end for end in (report.get("nest"), report.get("write")) if isinstance(end, Mapping)]
    return {str(metric["name"]) for stage in [*stages, *ends] for metric in entries(stage, "metrics")}
