"""Pattern files of a job: written, read back and measured before they count as made.

    flat/<part>.dxf       each part by itself
    pieces/<style>.dxf    all parts, one style: what a pattern program takes in
    cut/...               nested sheets, each copy a piece where it lies

Each is read again twice: as a pattern file (`readpieces`), whose faults are found from the file alone (`piecefaults`)
and whose content must be what was written, and as a drawing (`readback`), for whoever cuts what it holds.  In `flat/`
outline, cut-outs and their validation curves are held against the exact edges.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from stages.geometry.flat.sampling import resolved
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.hausdorff import hausdorff
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import Contour, FlatPattern
from stages.model.patternlayers import CURVE, DRILL, NOTCH_LAYERS, TURN
from stages.model.report import Finding, StageReport
from stages.model.sheet import SheetLayout
from stages.write.compare import GRID_SHARE, Comparison, ContourFigures, contour_figures, metrics
from stages.write.contourfigures import measured_file
from stages.write.cutfigures import cut_figures
from stages.write.faults import faults
from stages.write.piececompare import unlike
from stages.write.piecedxf import pieces_text
from stages.write.piecefaults import piece_faults
from stages.write.pieces import PatternFile, as_drawing, flat_file, sheet_files, style_file
from stages.write.readback import read
from stages.write.readpieces import Content, ReadPieces, read_pieces

ANY_LENGTH_MM = 0.0
"""A pattern program reads pieces of any length; no controller follows these files."""


def pattern_files(
    patterns: Sequence[FlatPattern], layouts: Sequence[SheetLayout], machine: Machine
) -> tuple[tuple[CutFile, ...], StageReport]:
    """Return the pattern files of all parts and of nested sheets, and the report on them as read back."""
    by_part = {pattern.part: pattern for pattern in patterns}
    files = [flat_file(pattern, machine) for pattern in patterns]
    files += [style_file(patterns, machine), *sheet_files(layouts, by_part, machine)]
    texts = tuple(CutFile(file.path, pieces_text(file, machine)) for file in files)
    return texts, judged_patterns(texts, files, by_part, machine)


@dataclass(frozen=True, slots=True)
class Judged:
    """One pattern file as read back: what is wrong with it, its figures, and what is measured of its contours."""

    findings: tuple[Finding, ...]
    figures: dict[str, float]
    counts: dict[str, int]
    sides: dict[str, object] | None
    comparison: Comparison
    entities: int


def judged_patterns(
    texts: Sequence[CutFile], files: Sequence[PatternFile], patterns: Mapping[str, FlatPattern], machine: Machine
) -> StageReport:
    """Return the report on pattern files as read back from their text."""
    found = {file.path: _judged(text.text, file, patterns, machine) for text, file in zip(texts, files, strict=True)}
    detail: dict[str, object] = {
        "files": {path: one.figures for path, one in found.items()},
        "sides": {path: one.sides for path, one in found.items() if one.sides is not None},
        "pieces": {path: one.counts for path, one in found.items()},
    }
    measured = metrics([one.comparison for one in found.values()], sum(one.entities for one in found.values()))
    findings = tuple(finding for one in found.values() for finding in one.findings)
    return StageReport("write", "pattern files", measured, findings, detail)


def _judged(text: str, file: PatternFile, patterns: Mapping[str, FlatPattern], machine: Machine) -> Judged:
    back, drawing = read_pieces(text), read(text, machine.layers)
    chord = max(patterns[piece.part].outer.chord_mm for piece in file.pieces)
    wrong = [*piece_faults(back, file.path), *faults(drawing, file.path, ANY_LENGTH_MM, chord)]
    wrong += [] if any(one.fatal for one in wrong) else list(unlike(back, file, machine))
    good = not any(one.fatal for one in wrong)
    exact = tuple(_exact(back, file, patterns)) if good and file.exact else ()
    return Judged(
        tuple(wrong),
        cut_figures(drawing),
        _counts(back),
        measured_file(drawing, as_drawing(file), machine.layers) if good else None,
        Comparison(exact, (), inf),
        sum(map(_entities, (*back.blocks, back.space))),
    )


def _entities(content: Content) -> int:
    return len(content.lines) + len(content.points) + len(content.texts)


def _counts(back: ReadPieces) -> dict[str, int]:
    """Return how much of everything a pattern file says."""
    points = [point.layer for block in back.blocks for point in block.points]
    return {
        "pieces": len(back.blocks),
        "turn_points": points.count(TURN),
        "curve_points": points.count(CURVE),
        "notches": sum(points.count(layer) for layer in set(NOTCH_LAYERS.values())),
        "drill_holes": points.count(DRILL),
    }


def _exact(back: ReadPieces, file: PatternFile, patterns: Mapping[str, FlatPattern]) -> Iterator[ContourFigures]:
    """Yield the figures of the contours against their exact edges, as read, those of their validation curves too."""
    for block, piece in zip(back.blocks, file.pieces, strict=True):
        pattern = patterns[piece.part]
        contours = (pattern.outer, *pattern.inner)
        read_paths = iter([line.path for line in block.lines])
        for line in piece.lines:
            path = next(read_paths)
            finer = next(read_paths) if line.traced is not None else None
            if line.contour is not None and path is not None and finer is not None:
                yield _figures(path, finer, contours[line.contour], piece.part, line.contour)


def _figures(path: ArcPath, finer: ArcPath, contour: Contour, part: str, number: int) -> ContourFigures:
    """Return how a contour and its validation curve compare with the exact edges: the larger distance of the two."""
    edges = [resolved(edge, accuracy=GRID_SHARE * contour.chord_mm) for edge in contour.edges]
    figures = contour_figures(path, 0.0, contour, part, number)
    also = hausdorff(edges, finer, accuracy=contour.chord_mm).bound_mm
    return replace(figures, deviation_mm=max(figures.deviation_mm, also))
