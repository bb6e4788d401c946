"""The side file of every drawing: `flat/<part>.json` beside `flat/<part>.dxf`, `cut/<name>.json` beside its drawing.

Bend table and roll schedule are those of the report, each line moved with its copy; contours and layers were measured
on the file as it reads; placements are those of the nest.  Nothing is computed twice.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import msgspec
from msgspec import Struct
from msgspec.structs import replace

from pipeline import __version__
from pipeline.files import FileNames, file_names
from pipeline.report.document import plain
from pipeline.sideentries import (
    UNITS,
    ContourSide,
    FileSide,
    JobSide,
    LayerSide,
    MarkSide,
    MaterialSide,
    PlacementSide,
    SheetSide,
    SideFile,
)
from pipeline.sidefeatures import features
from pipeline.sidelines import Copy, bends, rolls
from pipeline.store import digest

if TYPE_CHECKING:
    from pipeline.run import JobResult
    from stages.model.sheet import Placement, SheetLayout

SHOWN = re.compile(r"(flat|cut)/.*\.dxf")
"""Drawings that have a side file: of those of remnants `remnant.json` tells all."""


class Figures(Struct, frozen=True):
    """What the write stage measured of a file."""

    contours: tuple[ContourSide, ...]
    layers: dict[str, LayerSide]
    marks: tuple[MarkSide, ...] = ()


def side_files(result: "JobResult", files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the side files of drawings by their paths.  files: all drawings, in all formats."""
    names = file_names(result.parts, result.job)
    measured = msgspec.convert(result.write.report.detail.get("sides", {}), dict[str, Figures])
    shown = [path for path in files if SHOWN.fullmatch(path)]
    sides = {path: _side_file(result, files, path, measured[path], names) for path in shown}
    return {f"{_stem(path)}.json": _encoded(side) for path, side in sides.items()}


def _encoded(side: SideFile) -> bytes:
    """Return a side file as JSON, each row on a line of its own: sheets of many copies have thousands of them."""
    entries = (f'"{key}": {_rows(value)}' for key, value in msgspec.to_builtins(side).items())
    return "".join(["{\n", ",\n".join(entries), "\n}\n"]).encode()


def _rows(value: object) -> str:
    if not isinstance(value, list | tuple):
        return _row(value)
    return "".join(["[\n", ",\n".join(map(_row, value)), "\n]"])


def _row(value: object) -> str:
    return json.dumps(plain(value), ensure_ascii=False, allow_nan=False)


def side_schema() -> str:
    """Return the JSON Schema of a side file."""
    schema = msgspec.json.schema(SideFile)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "planish side file"}
    return json.dumps({**head, **schema}, indent=1)


def _stem(path: str) -> str:
    return path.rpartition(".")[0]


def _side_file(
    result: "JobResult", files: Mapping[str, bytes], path: str, measured: Figures, names: FileNames
) -> SideFile:
    """Return the side file of the drawing at a path."""
    job, sheets = result.job, _sheets(result, path, names)
    copies = [*_placed(result, sheets)] or [_alone(result, path, names)]
    known = all(copy.run.steps for copy in copies)
    return SideFile(
        schema="planish-cut/1",
        version=__version__,
        job=JobSide(job.name, job.customer, job.revision, job.digest),
        material=MaterialSide(job.material.name, job.material.thickness_mm),
        units=UNITS,
        frame="sheet" if sheets else "flat",
        files=tuple(FileSide(name, digest(files[name])) for name in files if _stem(name) == _stem(path)),
        layers=measured.layers,
        sheets=tuple(SheetSide(layout.sheet.id, layout.index, shift) for layout, shift in sheets),
        placements=tuple(_placements(sheets, copies, names)),
        contours=tuple(_contours(measured.contours, names)),
        bends=tuple(bend for copy in copies for bend in bends(copy)) if known else None,
        rolls=tuple(roll for copy in copies for roll in rolls(copy)) if known and not sheets else None,
        features=features(copies[0].run, measured.marks, job.machine) if path.startswith("flat/") else None,
    )


def _sheets(result: "JobResult", path: str, names: FileNames) -> list[tuple["SheetLayout", float]]:
    """Return the sheets that a drawing shows, each with how far it was moved there, mm; none on that of a part."""
    layouts = result.nest.product.layouts if result.nest.product is not None else ()
    shown = [layout for layout in layouts if names.drawing(layout) == path]
    if names.machine.file_per != "material" or not shown:
        return [(layout, 0.0) for layout in shown]
    from stages.write.sheets import windows

    patterns = {run.part.name: run.pattern for run in result.parts if run.pattern is not None}
    return [(layout, place.shift) for layout, place in zip(shown, windows(shown, patterns), strict=True)]


def _placed(result: "JobResult", sheets: Sequence[tuple["SheetLayout", float]]) -> Iterator[Copy]:
    """Yield the copies on some sheets as they lie in the drawing."""
    runs = {run.part.name: run for run in result.parts}
    for layout, shift in sheets:
        for placed in layout.placements:
            yield Copy(runs[placed.part], placed.copy, placed.motion.replace(x=placed.motion.x + shift))


def _alone(result: "JobResult", path: str, names: FileNames) -> Copy:
    """Return the part that a drawing shows in its flat frame."""
    from stages.geometry.curves.rigid import Rigid2

    drawn = {safe: part for part, safe in names.parts.items()}
    paths = {f"flat/{safe}.dxf": part for safe, part in drawn.items()}
    paths |= {names.machine.part_path(safe): part for safe, part in drawn.items()}
    (run,) = (run for run in result.parts if run.part.name == paths[path])
    return Copy(run, None, Rigid2())


def _placements(
    sheets: Sequence[tuple["SheetLayout", float]], copies: Sequence[Copy], names: FileNames
) -> Iterator[PlacementSide]:
    """Yield the copies on some sheets, in their order."""
    places: list[tuple[SheetLayout, Placement]] = [(one, placed) for one, _ in sheets for placed in one.placements]
    for (layout, placed), copy in zip(places, copies if sheets else (), strict=True):
        yield PlacementSide(
            part=placed.part,
            drawn_as=names.parts[placed.part],
            copy=placed.copy,
            stock=layout.sheet.id,
            index=layout.index,
            x=placed.motion.x,
            y=placed.motion.y,
            angle=placed.motion.angle_deg,
            mirrored=placed.motion.mirrored,
            turned_over=copy.turned_over,
            matrix=copy.matrix(),
        )


def _contours(contours: Sequence[ContourSide], names: FileNames) -> Iterator[ContourSide]:
    """Yield the contours of a file, under the names that their parts have in the job."""
    known = {safe: part for part, safe in names.parts.items()}
    for contour in contours:
        yield replace(contour, part=known.get(contour.part or ""), copy=contour.copy or None)
