"""A finished job as its output folder holds it: the patterns of its parts, its stock, and how it was to be nested.

`report.json` says what the parts are and how they want to lie; `flat/<part>.dxf` holds their contours, marks and texts,
which come back as they were written: lines and arcs to half the last decimal of a drawing, 5e-11 mm.  A file that is
not the one the report lists, by its sha256, is refused.  What a drawing does not say, names, notches and what
holes are for, comes from the side file beside it (`recalled`); parts that have none are told.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from pipeline.finishedentries import JobEntry, MaterialEntry, PartEntry, ReportEntry, StatusEntry
from pipeline.rates import Rates
from pipeline.report.nestentries import sheet_of
from pipeline.store import REPORT, digest, safe_names
from stages.errors import BadInputError, Problem
from stages.model.cutfile import Machine
from stages.model.sheet import NestOptions, Sheet

if TYPE_CHECKING:
    from stages.model.pattern import FlatPattern

SCHEMA = "planish-report/1"
RUN_AGAIN = "run the job again with this version"


@dataclass(frozen=True, slots=True)
class Finished:
    """A finished job: its patterns by the names of its parts, and what they were to be cut from.

    paths: of the drawings of the parts below the folder, by their names.  unrecalled: parts without a side file of
        their drawing, of which nothing is known but what that shows.
    """

    folder: Path
    job: JobEntry
    patterns: "tuple[FlatPattern, ...]"
    stock: tuple[Sheet, ...]
    options: NestOptions
    machine: Machine
    rates: Rates
    paths: dict[str, str]
    report_digest: str
    unrecalled: tuple[str, ...] = ()


def finished(folder: Path) -> Finished:
    """Return the job whose output folder this is; `BadInputError` with everything that stands against it."""
    file = folder / REPORT
    try:
        content = file.read_bytes()
    except OSError as error:
        hint = "give the output folders of finished jobs"
        raise BadInputError(Problem(f"cannot be read: {error.strerror}", hint=hint, file=str(file))) from None
    report = _report(content, file)
    drawings = dict(_drawings(report, folder))
    problems = [*_changed(report, drawings, folder)]
    if problems:
        raise BadInputError(*problems)
    job = report.job
    patterns, unrecalled = _recalled(_patterns(report, drawings, folder), _paths(report), drawings, folder)
    return Finished(
        folder,
        job,
        patterns,
        tuple(_sheets(report, file)),
        report.nest.options,
        job.dxf.machine(),
        report.nest.cost.rates,
        _paths(report),
        digest(content),
        unrecalled,
    )


def _report(content: bytes, file: Path) -> ReportEntry:
    """Return what is needed of a report that says that its job was made."""
    hint = "give the output folders of finished jobs"
    try:
        said = msgspec.json.decode(content, type=StatusEntry)
        if said.schema != SCHEMA:
            raise BadInputError(Problem(f'"{said.schema}" is not the report of a job', "schema", hint, str(file)))
        if said.status != "made":
            message = f"the job is {said.status}, not made"
            raise BadInputError(Problem(message, "status", "only what may be cut is nested", str(file)))
        return msgspec.json.decode(content, type=ReportEntry)
    except (msgspec.DecodeError, RecursionError) as error:
        message = f"is no report that can be read: {error}"
        raise BadInputError(Problem(message, hint=RUN_AGAIN, file=str(file))) from None


def _sheets(report: ReportEntry, file: Path) -> Iterator[Sheet]:
    """Yield the stock of a report; `BadInputError` for a path that is none."""
    for number, entry in enumerate(report.nest.stock):
        try:
            yield sheet_of(entry)
        except ValueError as error:
            raise BadInputError(Problem(str(error), f"nest.stock[{number}]", RUN_AGAIN, str(file))) from None


def _paths(report: ReportEntry) -> dict[str, str]:
    """Return the path of the drawing of every part by its name, as the job chose it."""
    return {name: f"flat/{safe}.dxf" for name, safe in safe_names(part.name for part in report.parts).items()}


def _drawings(report: ReportEntry, folder: Path) -> Iterator[tuple[str, bytes | None]]:
    """Yield the drawings of all parts by their paths; None for one that cannot be read."""
    for path in _paths(report).values():
        try:
            yield path, (folder / path).read_bytes()
        except OSError:
            yield path, None


def _changed(report: ReportEntry, drawings: dict[str, bytes | None], folder: Path) -> Iterator[Problem]:
    """Yield the drawings that are missing, or not those that the report lists."""
    listed = {file.path: file.sha256 for file in report.write.files}
    hint = "run the job again, or put the drawing back"
    for path, content in drawings.items():
        if content is None:
            yield Problem("the drawing is missing", hint=hint, file=str(folder / path))
        elif digest(content) != listed.get(path):
            yield Problem("the drawing was changed after the job had been made", hint=hint, file=str(folder / path))


def _patterns(report: ReportEntry, drawings: dict[str, bytes | None], folder: Path) -> "tuple[FlatPattern, ...]":
    """Return the patterns of all parts; `BadInputError` for drawings that do not hold one."""
    from pipeline.readpatterns import read_pattern
    from pipeline.readpieces import NoPatternError

    paths, patterns, problems = _paths(report), [], []
    machine = report.job.dxf.machine()
    for part in report.parts:
        path = paths[part.name]
        try:
            text = (drawings[path] or b"").decode("ascii")
            drawn = read_pattern(text, report.job.tolerance.chord_mm, machine.layers)
        except (NoPatternError, UnicodeDecodeError) as error:
            problems.append(Problem(f"holds no pattern: {error}", file=str(folder / path)))
            continue
        patterns.append(_wished(drawn, part, report.job.material))
    if problems:
        raise BadInputError(*problems)
    return tuple(patterns)


def _recalled(
    patterns: "Sequence[FlatPattern]", paths: Mapping[str, str], drawings: Mapping[str, bytes | None], folder: Path
) -> "tuple[tuple[FlatPattern, ...], tuple[str, ...]]":
    """Return the patterns with what their side files say, and the parts of which none does.

    Raises BadInputError for side files that their drawings contradict.
    """
    from pipeline.recalled import SideFileError, recalled

    found: list[FlatPattern] = []
    unknown: list[str] = []
    problems: list[Problem] = []
    for pattern in patterns:
        path = paths[pattern.part]
        try:
            made = recalled(pattern, _side(folder / path), drawings[path] or b"")
        except SideFileError as error:
            hint = "run the job again, or remove this file: then the part is cut as drawn"
            problems.append(
                Problem(f"contradicts its drawing: {error}", hint=hint, file=str(_side_file(folder / path)))
            )
            continue
        found.append(made or pattern)
        unknown += [] if made else [pattern.part]
    if problems:
        raise BadInputError(*problems)
    return tuple(found), tuple(unknown)


def _side_file(drawing: Path) -> Path:
    return drawing.with_suffix(".json")


def _side(drawing: Path) -> bytes | None:
    """Return the side file of a drawing; None where it cannot be read."""
    try:
        return _side_file(drawing).read_bytes()
    except OSError:
        return None


def _wished(drawn: "FlatPattern", part: PartEntry, material: MaterialEntry) -> "FlatPattern":
    """Return a pattern with what its report says of it."""
    import numpy as np

    wish = part.nest
    return drawn.replace(
        part=part.name,
        quantity=part.quantity,
        corners=np.array(part.flat.corners),
        rotations=wish.rotations,
        thickness_mm=material.thickness_mm,
        density_kg_m3=material.density_kg_m3,
        quality=wish.quality,
        axis_deg=wish.axis_deg,
        axis_band_deg=wish.axis_band_deg,
        pair=wish.pair,
    )


def all_finished(folders: Sequence[Path]) -> tuple[Finished, ...]:
    """Return all jobs; `BadInputError` with what stands against any of them."""
    jobs: list[Finished] = []
    problems: list[Problem] = []
    for folder in folders:
        try:
            jobs.append(finished(folder))
        except BadInputError as error:
            problems += error.problems
    if problems:
        raise BadInputError(*problems)
    return tuple(jobs)
