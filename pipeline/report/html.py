"""`report.html`: the report as one page that opens from disk, with nothing loaded from anywhere.

The page is a template, a style sheet and scripts of this package, put together here, and the data as one JSON block in
which `<` is written as an escape: no text of a job can end it.  A short row for every part makes the table; the rest of
a part is a JSON text inside that block, read when the part is opened.  The policy in its head forbids any request.

The page holds the numbers of `report.json` and, to draw, those of `view.json`; it computes but margins and positions.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files

from pipeline.report.document import Document, plain
from pipeline.report.meanings import MEANINGS

ASSETS = files("pipeline") / "data" / "report"
STYLES = ("page.css", "print.css")
LIBRARY = "three.min.js"
SCRIPTS = (
    "view3d_model.js", "view3d_paint.js", "view3d.js", "format.js", "data.js", "table.js", "paths.js", "strain.js",
    "plan.js", "flat.js", "sheets.js", "part.js", "page.js",
)  # fmt: skip
"""In the order in which they run; those of the 3D view define one global name each, the others share one."""

Row = Mapping[str, object]


def report_html(report: Document, view: Document) -> bytes:
    """Return the page of a report; view: the document of `view.json` that was made with it."""
    style = "\n".join(_asset(name) for name in STYLES)
    blocks = {
        "STYLE": style,
        "DATA": data_block(report, view),
        "LIBRARY": _asset(LIBRARY),
        "SCRIPT": "\n".join(_asset(name) for name in SCRIPTS),
    }
    head, *rest = _asset("page.html").split("<!--")
    return "".join([head, *_filled(rest, blocks)]).encode()


def _filled(pieces: Sequence[str], blocks: Mapping[str, str]) -> Iterator[str]:
    """Yield the pieces of the template, each behind the block that its comment names."""
    for piece in pieces:
        name, _, after = piece.partition("-->")
        yield blocks[name.strip()]
        yield after


def _asset(name: str) -> str:
    return (ASSETS / name).read_text(encoding="utf-8")


def data_block(report: Document, view: Document) -> str:
    """Return what the page shows as JSON, without `<` and the line ends that are none in a script."""
    shapes = {str(entry["name"]): entry for entry in entries(view, "parts")}
    parts = list(entries(report, "parts"))
    nest = report.get("nest")
    job = {key: value for key, value in report.items() if key not in ("parts", "nest")}
    content = {
        "job": job,
        "nest": {**nest, "views": view.get("sheets", [])} if isinstance(nest, Mapping) else None,
        "rows": [summary(part) for part in parts],
        "parts": [_json({"report": part, "view": shapes.get(str(part["name"]))}) for part in parts],
        "meanings": {name: MEANINGS[name] for name in sorted(metric_names(report)) if name in MEANINGS},
    }
    return _json(content).replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _json(value: object) -> str:
    return json.dumps(plain(value), ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def entries(document: Mapping[str, object], key: str) -> Iterator[Row]:
    """Yield the objects of a list of a document; nothing where there is none."""
    listed = document.get(key)
    for entry in listed if isinstance(listed, list) else ():
        if isinstance(entry, Mapping):
            yield entry


def summary(part: Row) -> Document:
    """Return the row of a part: what the table shows of it, and how many of its checks failed."""
    stages = list(entries(part, "stages"))
    metrics = [metric for stage in stages for metric in entries(stage, "metrics")]
    findings = [finding for stage in stages for finding in entries(stage, "findings")]
    strains = [metric["value"] for metric in metrics if metric["name"] == "max_strain"]
    return {
        "name": part["name"],
        "quantity": part["quantity"],
        "class": part["class"],
        "failed": sum(not metric["pass"] for metric in metrics) + sum(bool(one["fatal"]) for one in findings),
        "checks": sum(metric["limit"] is not None for metric in metrics),
        "findings": len(findings),
        "strain": strains[-1] if strains else None,
        "mass": part.get("mass_kg"),
    }


def metric_names(report: Document) -> set[str]:
    """Return the names of all metrics of a report."""
    stages = [stage for part in entries(report, "parts") for stage in entries(part, "stages")]
    ends = [end for end in (report.get("nest"), report.get("write")) if isinstance(end, Mapping)]
    return {str(metric["name"]) for stage in [*stages, *ends] for metric in entries(stage, "metrics")}
