"""The write stage: patterns and a nest to cut files, each read back and measured before it counts as made.

`drawing` says what goes into a file, in paths that its flavour holds (`flavours`), `dxf` writes it, `readback` reads
the text again, `faults` and `compare` judge it.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from stages.geometry.paths.compensation import Fit
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Outcome, StageReport
from stages.model.sheet import Nesting, SheetLayout
from stages.write.bridged import bridged
from stages.write.clipped import clipped_texts
from stages.write.closing import closed_again
from stages.write.compare import Comparison, common_lines, compared, metrics
from stages.write.contourfigures import measured_file
from stages.write.cutfigures import cut_figures
from stages.write.drawing import Drawing, flat_drawing
from stages.write.dxf import dxf_text
from stages.write.faults import faults
from stages.write.flavours import as_cut
from stages.write.helpfigures import cuts_of_parts, help_figures
from stages.write.helps import helped
from stages.write.kerf import beam_patterns, offset_metrics
from stages.write.pictured import pictured
from stages.write.readback import read
from stages.write.remnants import remnant_drawings
from stages.write.sheets import cut_drawings, seen, windows

DEFAULT = Machine()
REMNANTS = Machine(flavour="r12", version="R12")
"""How the drawings of remnants are written beside pattern files, which are R12 too."""


@dataclass(frozen=True, slots=True)
class Judged:
    """One file as it was read back: the text it was made of, what was found, measured and counted in it."""

    text: str
    findings: tuple[Finding, ...]
    comparison: Comparison
    fits: tuple[Fit, ...]
    entities: int
    figures: dict[str, float]
    sides: object | None
    by_part: object | None


Each = Callable[[Callable[[int], Judged], int], Iterable[Judged]]
"""How a call is made for each file, by its number: here, or by others."""


def in_turn(call: Callable[[int], Judged], count: int) -> Iterable[Judged]:
    """Make the calls one after the other."""
    return map(call, range(count))


def write(
    patterns: Sequence[FlatPattern], nesting: Nesting | None, machine: Machine, each: Each = in_turn
) -> Outcome[tuple[CutFile, ...]]:
    """Return `flat/<part>.dxf` of every pattern and, of a nest, the files in `cut/` that the machine wants, as text.

    What a sheet leaves in one piece is drawn in `remnants/<stock>-<n>.dxf`.

    Every file has been read back: its faults are findings, and a fatal one means that nothing may be cut from it.
    each: how the files are made, each by itself.
    """
    patterns = [as_cut(pattern, machine) for pattern in patterns]
    if machine.flavour == "aama":
        return _written_patterns(patterns, nesting.layouts if nesting else (), machine)
    by_part = {pattern.part: pattern for pattern in patterns}
    drawings = [flat_drawing(pattern, machine) for pattern in patterns]
    layouts = nesting.layouts if nesting else ()
    beams, narrow = beam_patterns(patterns, machine)
    cutting = machine.of_file("cut/")
    of_beams = {pattern.part: pattern for pattern in beams}
    drawings += [helped(drawing, cutting) for drawing in cut_drawings(layouts, of_beams, cutting)]
    drawings += remnant_drawings(layouts)
    shown = pictured(drawings, machine)
    found = list(each(lambda number: made(drawings[number], by_part, machine), len(drawings)))
    files = tuple(CutFile(drawing.path, one.text) for drawing, one in zip(drawings, found, strict=True))
    report = reported(drawings, found)
    told = (*clipped_texts(patterns, layouts, machine), *report.findings, *narrow, *shown.findings)
    report = replace(report, findings=told)
    if machine.file_per == "material" and layouts:
        report.detail["sheets"] = _sheet_figures(files, layouts, by_part, machine)
    return Outcome((*files, *shown.files), report)


def _written_patterns(
    patterns: Sequence[FlatPattern], layouts: Sequence[SheetLayout], machine: Machine
) -> Outcome[tuple[CutFile, ...]]:
    """Return pattern files instead of drawings; what a sheet leaves is no piece and is drawn as ever."""
    from stages.write.patternfiles import pattern_files

    files, report = pattern_files(patterns, layouts, machine)
    drawings = remnant_drawings(layouts)
    rests = tuple(CutFile(drawing.path, dxf_text(drawing, REMNANTS)) for drawing in drawings)
    report = replace(report, findings=(*report.findings, *judged(rests, drawings, {}, REMNANTS).findings))
    if machine.file_per == "material" and layouts:
        by_part = {pattern.part: pattern for pattern in patterns}
        report.detail["sheets"] = _sheet_figures(files, layouts, by_part, machine)
    return Outcome((*files, *rests), report)


def _sheet_figures(
    files: Sequence[CutFile], layouts: Sequence[SheetLayout], patterns: dict[str, FlatPattern], machine: Machine
) -> list[dict[str, float]]:
    """Return the figures of each sheet of a file that holds all of them."""
    path = machine.path("", 0)
    back = read(next(file.text for file in files if file.path == path), machine.of_file(path).layers)
    return [
        cut_figures(replace(back, entities=tuple(seen(back.entities, place)))) for place in windows(layouts, patterns)
    ]


def judged(
    files: Sequence[CutFile],
    drawings: Sequence[Drawing],
    patterns: dict[str, FlatPattern],
    machine: Machine = DEFAULT,
) -> StageReport:
    """Return the report on files as read back from their text."""
    pairs = zip(files, drawings, strict=True)
    return reported(drawings, [judge(file.text, drawing, patterns, machine) for file, drawing in pairs])


def made(drawing: Drawing, patterns: dict[str, FlatPattern], machine: Machine) -> Judged:
    """Return the file of a drawing, read back."""
    return judge(dxf_text(drawing, machine.of_file(drawing.path)), drawing, patterns, machine)


def judge(text: str, drawing: Drawing, patterns: dict[str, FlatPattern], machine: Machine) -> Judged:
    """Return a file as read back from its text."""
    layers = machine.of_file(drawing.path).layers
    back = read(text, layers)
    whole = replace(back, entities=bridged(back.entities, drawing.helps.gap_mm))
    closed = None if drawing.kerf_mm is None else closed_again(whole.entities, drawing.kerf_mm)
    comparison = compared(back, drawing, patterns if drawing.path.startswith("flat/") else {}, closed)
    helps = help_figures(back, whole, drawing)
    findings = (
        *faults(whole, drawing.path, comparison.shortest_mm, _chord(drawing, patterns), closed),
        *drawing.told,
        *helps.findings,
        *comparison.findings,
        *(common_lines(back, closed, drawing.path) if closed else ()),
    )
    as_drawn = not any(finding.fatal for finding in comparison.findings)
    alone = as_drawn and drawing.helps.any and drawing.kerf_mm is None
    return Judged(
        text,
        findings,
        comparison,
        helps.fits,
        sum(entity.count for entity in back.entities),
        cut_figures(back),
        measured_file(back, drawing, layers) if as_drawn else None,
        cuts_of_parts(back, drawing) if alone else None,
    )


def reported(drawings: Sequence[Drawing], found: Sequence[Judged]) -> StageReport:
    """Return the report on files as they were read back."""
    by_path = {drawing.path: one for drawing, one in zip(drawings, found, strict=True)}
    by_part = {path: one.by_part for path, one in by_path.items() if one.by_part is not None}
    detail: dict[str, object] = {
        "files": {path: one.figures for path, one in by_path.items()},
        "sides": {path: one.sides for path, one in by_path.items() if one.sides is not None},
        **({"parts": by_part} if by_part else {}),
    }
    comparisons = [one.comparison for one in found]
    entities = sum(one.entities for one in found)
    measured = (*metrics(comparisons, entities), *offset_metrics([fit for one in found for fit in one.fits]))
    return StageReport("write", "cut files", measured, tuple(line for one in found for line in one.findings), detail)


def _chord(drawing: Drawing, patterns: dict[str, FlatPattern]) -> float:
    """Return the largest chord that a contour of a drawing was approximated with, mm."""
    parts = {item.part for item in drawing.items if item.contour is not None}
    return max((patterns[part].outer.chord_mm for part in parts), default=0.0)
