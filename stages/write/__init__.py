"""The write stage: patterns and a nest to cut files, each read back and measured before it counts as made.

`drawing` says what goes into a file, `dxf` writes it, `readback` reads the text again, `faults` and `compare` judge it.
"""

from collections.abc import Sequence

from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Outcome, StageReport
from stages.model.sheet import Nesting
from stages.write.compare import Comparison, compared, cut_figures, metrics
from stages.write.drawing import Drawing, flat_drawing, sheet_drawing
from stages.write.dxf import dxf_text
from stages.write.faults import faults
from stages.write.readback import read


def write(patterns: Sequence[FlatPattern], nesting: Nesting | None, machine: Machine) -> Outcome[tuple[CutFile, ...]]:
    """Return `flat/<part>.dxf` of every pattern and, of a nest, `cut/<stock>-<n>.dxf` of every sheet, as text.

    Every file has been read back: its faults are findings, and a fatal one means that nothing may be cut from it.
    """
    by_part = {pattern.part: pattern for pattern in patterns}
    drawings = [flat_drawing(pattern, machine) for pattern in patterns]
    drawings += [sheet_drawing(layout, by_part, machine) for layout in (nesting.layouts if nesting else ())]
    files = tuple(CutFile(drawing.path, dxf_text(drawing, machine)) for drawing in drawings)
    return Outcome(files, judged(files, drawings, by_part))


def judged(files: Sequence[CutFile], drawings: Sequence[Drawing], patterns: dict[str, FlatPattern]) -> StageReport:
    """Return the report on files as read back from their text."""
    findings: list[Finding] = []
    comparisons: list[Comparison] = []
    figures: dict[str, object] = {}
    entities = 0
    for file, drawing in zip(files, drawings, strict=True):
        back = read(file.text)
        comparison = compared(back, drawing, patterns if drawing.path.startswith("flat/") else {})
        findings += faults(back, file.path, comparison.shortest_mm, _chord(drawing, patterns))
        findings += comparison.findings
        comparisons.append(comparison)
        figures[file.path] = cut_figures(back)
        entities += len(back.entities)
    return StageReport("write", "cut files", metrics(comparisons, entities), tuple(findings), {"files": figures})


def _chord(drawing: Drawing, patterns: dict[str, FlatPattern]) -> float:
    """Return the largest chord that a contour of a drawing was approximated with, mm."""
    parts = {item.part for item in drawing.items if item.contour is not None}
    return max((patterns[part].outer.chord_mm for part in parts), default=0.0)
