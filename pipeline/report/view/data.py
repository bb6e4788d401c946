"""What a page needs to draw parts and sheets again, apart from the report: `view.json`, schema planish-view/1.

Contours and marks are the lines and arcs that are cut, as x, y and bulge of every vertex, so that arcs stay arcs;
rulings are by their two ends and v.  Places of metrics are those that the report gives on the surface, taken to the
flat frame.  Everything is in mm in the flat frame of the part, or in the frame of its sheet; nothing is measured here.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from pipeline.report.document import Document, compact
from pipeline.report.pictures.edges import flat_pieces, rulings
from pipeline.report.pictures.net import ruling_places
from pipeline.report.view.formed import formed
from pipeline.run import JobResult, PartRun
from stages.geometry.flat.flatmap import FlatPiece
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import FlatPattern
from stages.model.report import Metric
from stages.model.sheet import Sheet

VIEW_SCHEMA = "planish-view/1"


def view_document(result: JobResult, worst_v: Callable[[PartRun], float | None]) -> Document:
    """Return what is drawn of the parts and the sheets of a job; worst_v: the ruling that a part was rejected for."""
    layouts = result.nest.product.layouts if result.nest.product is not None else ()
    return {
        "schema": VIEW_SCHEMA,
        "parts": [part_view(run, worst_v(run)) for run in result.parts],
        "sheets": [sheet_view(layout.sheet) for layout in layouts],
    }


def view_bytes(document: Document) -> bytes:
    """Return the document as JSON, every part and every sheet on a line of its own."""
    rows = {key: value if isinstance(value, list) else None for key, value in document.items()}
    lines = [
        f'"{key}": {compact(document[key])}' if listed is None else f'"{key}": [\n{_lines(listed)}\n]'
        for key, listed in rows.items()
    ]
    return "".join(["{\n", ",\n".join(lines), "\n}\n"]).encode()


def _lines(rows: Sequence[object]) -> str:
    return ",\n".join(compact(row) for row in rows)


def part_view(run: PartRun, worst_v: float | None = None) -> Document:
    """Return what is drawn of a part: nothing flat of one that was refused."""
    return {
        "name": run.part.name,
        "flat": None if run.pattern is None else flat_view(run.pattern, run),
        "formed": formed(run, worst_v),
    }


def flat_view(pattern: FlatPattern, run: PartRun) -> Document:
    """Return the pattern: contours, marks, texts, rulings, and where the extremes of its metrics lie."""
    pieces = flat_pieces(pattern)
    return {
        "contours": [
            {"name": contour.name, "purpose": contour.purpose, **path_view(contour.path)}
            for contour in (pattern.outer, *pattern.inner)
        ],
        "marks": [{"name": mark.name, "layer": mark.layer, **path_view(mark.path)} for mark in pattern.marks],
        "label": pattern.label_at.tolist(),
        "texts": [
            {"text": text.text, "at": text.at.tolist(), "height": text.height_mm, "angle": text.angle_deg}
            for text in pattern.texts
        ],
        "rulings": list(ruling_rows(pattern, len(pieces))),
        "places": list(places(run, pieces)),
    }


def path_view(path: ArcPath) -> Document:
    """Return a path as x, y, bulge of one vertex after another."""
    return {"closed": path.closed, "points": np.column_stack([path.vertices, path.bulges]).ravel().tolist()}


def ruling_rows(pattern: FlatPattern, pieces: int) -> Iterator[list[float]]:
    """Yield x, y of both ends and v of the rulings that are shown."""
    shown = ruling_places(pieces)
    for ends, v in zip(rulings(pattern, shown), shown.tolist(), strict=True):
        yield [*ends.ravel().tolist(), v]


def places(run: PartRun, pieces: Sequence[FlatPiece]) -> Iterator[Document]:
    """Yield the metrics whose extreme has a place in the pattern, with x and y in the flat frame."""
    for step in run.steps:
        for metric in step.report.metrics:
            at = _place(metric, pieces)
            if at is not None:
                yield {"stage": step.report.stage, "metric": metric.name, "at": at}


def _place(metric: Metric, pieces: Sequence[FlatPiece]) -> list[float] | None:
    where = metric.where or {}
    for x, y in (("flat_x", "flat_y"), ("x", "y")):
        if x in where and y in where and not (x == "x" and "z" in where):
            return [float(where[x]), float(where[y])]
    if not pieces or "v" not in where or "u" not in where:
        return None
    v = float(where["v"])
    piece = min(max(int(np.floor(v)), 0), len(pieces) - 1)
    local = min(max(v - piece, 0.0), 1.0)
    at: list[float] = pieces[piece].positions(np.array([float(where["u"])]), np.array([local]))[0].tolist()
    return at


def sheet_view(sheet: Sheet) -> Document:
    """Return the outline of a sheet and what is kept free on it; its rectangle is in the report."""
    return {
        "outline": None if sheet.outline is None else path_view(sheet.outline),
        "defects": [path_view(defect) for defect in sheet.defects],
        "zones": [{"quality": zone.quality, **path_view(zone.outline)} for zone in sheet.zones],
    }
