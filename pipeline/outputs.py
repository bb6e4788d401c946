"""Everything that goes into the output folder of a job: report, drawings, pictures.

Where someone interrupted the search and waits, what takes seconds and can be made later is left out, and said.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING

from pipeline.files import drawings, file_names
from pipeline.inturn import Each, in_turn
from pipeline.layouts import LAYOUT, layout_document
from pipeline.remnants import REMNANTS, remnant_document
from pipeline.report.document import Document, class_of, document, encoded
from pipeline.report.lines import stage_line, trouble_lines
from pipeline.report.render import Made, as_json_has_it, rendered
from pipeline.run import JobResult, PartRun
from pipeline.sidefiles import side_files
from pipeline.store import REPORT

if TYPE_CHECKING:
    from stages.geometry.mesh.meshmap import MeshMap

SLOW_FORMATS = frozenset({"png", "traveller"})
"""Left out after an interruption: they take 0.1 to 0.3 s a part, the rest together a second for dozens of parts."""


def outputs(result: JobResult, each: Each = in_turn) -> tuple[Document, dict[str, bytes]]:
    """Return the report, and every file by its path below the output folder."""
    files = drawings(result)
    report = document(result, files)
    skipped = left_out(result)
    drawn = {} if "png" in skipped else pictures(result, each)
    every = {**stored(result), **files, **side_files(result, files), **drawn, **views(result)}
    return report, with_formats(encoded(report), every, skipped)


def left_out(result: JobResult) -> Collection[str]:
    """Return the formats that the job asks for and does not get."""
    return SLOW_FORMATS & {*result.job.formats} if result.interrupted else ()


def left_out_lines(result: JobResult) -> Iterator[str]:
    """Yield what to do for the formats that were left out."""
    if skipped := left_out(result):
        named = " and ".join(sorted(skipped))
        yield f"left out after the interruption: {named}; to have them: planish run JOB.toml --layout {LAYOUT}"


def with_formats(report: bytes, files: Mapping[str, bytes], skipped: Collection[str] = ()) -> dict[str, bytes]:
    """Return the report, the files beside it, and the report in the formats that the job asks for but those skipped."""
    return {REPORT: report, **files, **rendered(Made(as_json_has_it(report), files), skipped=skipped)}


def stored(result: JobResult) -> dict[str, bytes]:
    """Return what a later job may start from: the layout and what is left over."""
    documents = {LAYOUT: layout_document(result), REMNANTS: remnant_document(result)}
    return {name: encoded(content) for name, content in documents.items() if content is not None}


def views(result: JobResult) -> dict[str, bytes]:
    """Return what the page of the report and the traveller draw, if the job asks for one of them."""
    if not {"html", "traveller"} & {*result.job.formats}:
        return {}
    from pipeline.report.view.data import view_bytes, view_document
    from pipeline.report.view.entries import VIEW

    return {VIEW: view_bytes(view_document(result, worst_v))}


def pictures(result: JobResult, each: Each = in_turn) -> dict[str, bytes]:
    """Return a picture of every surface with its pattern and of every nested sheet, if the job asks for them."""
    if "png" not in result.job.formats:
        return {}
    wanted = [*_part_pictures(result), *_sheet_pictures(result)]
    drawn = each(lambda number: wanted[number][1](), len(wanted))
    return {name: content for (name, _), content in zip(wanted, drawn, strict=True)}


Drawn = Callable[[], bytes]
"""Draws a picture when it is called."""


def _part_pictures(result: JobResult) -> Iterator[tuple[str, Drawn]]:
    """Yield the name of the picture of each surface, and who draws it."""
    from pipeline.report.pictures.part import part_picture

    names = file_names(result.parts, result.job)
    for run in result.parts:
        if run.surface is not None:
            told = remarks(run), worst_v(run), class_of(run)
            draw = partial(part_picture, run.surface, run.pattern, *told, flat=map_of(run))
            yield f"preview/{names.parts[run.part.name]}.png", draw


def _sheet_pictures(result: JobResult) -> Iterator[tuple[str, Drawn]]:
    """Yield the name of the picture of each nested sheet, and who draws it."""
    from pipeline.report.pictures.part import sheet_picture

    names = file_names(result.parts, result.job)
    patterns = {run.part.name: run.pattern for run in result.parts if run.pattern is not None}
    for layout in result.nest.product.layouts if result.nest.product is not None else ():
        yield names.picture(layout), partial(sheet_picture, layout, patterns)


def remarks(run: PartRun) -> list[str]:
    """Return what the terminal says of a part."""
    steps = [step for step in run.steps if step.status != "skipped"]
    return [line for step in steps for line in (stage_line(step), *trouble_lines(step.report))]


def map_of(run: PartRun) -> "MeshMap | None":
    """Return the map of a mesh that was judged by it."""
    from stages.model.surface import Certificate

    judged = [step.product for step in run.steps if isinstance(step.product, Certificate)]
    return judged[0].flat if judged else None


def worst_v(run: PartRun) -> float | None:
    """Return the place of the ruling that a part was rejected for, v counted over its patches."""
    for step in run.steps:
        for finding in step.report.findings:
            place = (finding.where or {}).get("v") if finding.fatal else None
            if isinstance(place, float | int):
                return float(place)
    return None
