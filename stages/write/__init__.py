"""The write stage: patterns and a nest to cut files, each read back and measured before it counts as made.

`drawing` says what goes into a file, in paths that its flavour holds (`flavours`), `dxf` writes it, `readback` reads
the text again, `faults` and `compare` judge it.
"""

from collections.abc import Sequence
from dataclasses import replace

from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Outcome, StageReport
from stages.model.sheet import Nesting, SheetLayout
from stages.write.closing import closed_again
from stages.write.compare import Comparison, common_lines, compared, cut_figures, metrics
from stages.write.drawing import Drawing, flat_drawing
from stages.write.dxf import dxf_text
from stages.write.faults import faults
from stages.write.flavours import as_cut
from stages.write.readback import read
from stages.write.remnants import remnant_drawings
from stages.write.sheets import cut_drawings, seen, windows

DEFAULT = Machine()


def write(patterns: Sequence[FlatPattern], nesting: Nesting | None, machine: Machine) -> Outcome[tuple[CutFile, ...]]:
    """Return `flat/<part>.dxf` of every pattern and, of a nest, the files in `cut/` that the machine wants, as text.

    What a sheet leaves in one piece is drawn in `remnants/<stock>-<n>.dxf`.

    Every file has been read back: its faults are findings, and a fatal one means that nothing may be cut from it.
    """
    patterns = [as_cut(pattern, machine) for pattern in patterns]
    by_part = {pattern.part: pattern for pattern in patterns}
    drawings = [flat_drawing(pattern, machine) for pattern in patterns]
    layouts = nesting.layouts if nesting else ()
    drawings += cut_drawings(layouts, by_part, machine)
    drawings += remnant_drawings(layouts)
    files = tuple(CutFile(drawing.path, dxf_text(drawing, machine)) for drawing in drawings)
    report = judged(files, drawings, by_part, machine)
    if machine.file_per == "material" and layouts:
        report.detail["sheets"] = _sheet_figures(files, layouts, by_part, machine)
    return Outcome(files, report)


def _sheet_figures(
    files: Sequence[CutFile], layouts: Sequence[SheetLayout], patterns: dict[str, FlatPattern], machine: Machine
) -> list[dict[str, float]]:
    """Return the figures of each sheet of a file that holds all of them."""
    path = machine.path("", 0)
    back = read(next(file.text for file in files if file.path == path), machine.layers)
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
    findings: list[Finding] = []
    comparisons: list[Comparison] = []
    figures: dict[str, object] = {}
    entities = 0
    for file, drawing in zip(files, drawings, strict=True):
        back = read(file.text, machine.layers)
        closed = None if drawing.kerf_mm is None else closed_again(back.entities, drawing.kerf_mm)
        comparison = compared(back, drawing, patterns if drawing.path.startswith("flat/") else {}, closed)
        findings += faults(back, file.path, comparison.shortest_mm, _chord(drawing, patterns), closed)
        findings += comparison.findings
        findings += common_lines(back, closed, file.path) if closed else ()
        comparisons.append(comparison)
        figures[file.path] = cut_figures(back)
        entities += sum(entity.count for entity in back.entities)
    return StageReport("write", "cut files", metrics(comparisons, entities), tuple(findings), {"files": figures})


def _chord(drawing: Drawing, patterns: dict[str, FlatPattern]) -> float:
    """Return the largest chord that a contour of a drawing was approximated with, mm."""
    parts = {item.part for item in drawing.items if item.contour is not None}
    return max((patterns[part].outer.chord_mm for part in parts), default=0.0)
