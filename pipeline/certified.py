"""Cut files that were read back and certified: nothing is cut whose gaps were not measured in the file itself.

The write stage compares a file with its drawing; here the contours read from its text are held against the rules of the
nest, by the certifier that judged the layout.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from pipeline.inturn import Each, in_turn
from stages.geometry.paths.arcpath import transform
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import FlatPattern
from stages.model.report import Finding, Metric, Outcome
from stages.model.sheet import Nesting, NestOptions, SheetLayout
from stages.write.bridged import bridged
from stages.write.chains import Entity
from stages.write.closing import closed_again
from stages.write.kerf import beam_patterns
from stages.write.readback import read
from stages.write.sheets import seen, windows

if TYPE_CHECKING:
    from stages.nest.legal.files import ReadSheet

DEFAULT = Machine()
DRAWING = re.compile(r"cut/.*\.dxf")
"""What is read: pictures of the same name lie beside it."""
MITRE = Finding(
    "rounded-corners",
    "a common line ends where the kerf rounds a corner, and does not run on beside the next part: set kerf_corners = "
    '"mitre" under [process], or leave nest.common_line out',
)


def written(
    patterns: Sequence[FlatPattern],
    nesting: Nesting | None,
    machine: Machine,
    options: NestOptions,
    each: Each = in_turn,
) -> Outcome[tuple[CutFile, ...]]:
    """Return the files of a job, those of its sheets certified as they read; the report tells the gaps and overlaps."""
    from stages.write import write

    outcome = write(patterns, nesting, replace(machine, common_kerf_mm=options.common_kerf_mm), each)
    report = outcome.report
    if nesting is None or not nesting.layouts or not report.passed:
        return outcome
    metrics, findings = certified_files(outcome.product, nesting, patterns, options, machine)
    rounded = options.common_line and machine.helps.compensated and not machine.helps.mitred
    advice = (MITRE,) if rounded and any(finding.code == "gap" for finding in findings) else ()
    told = replace(report, metrics=(*report.metrics, *metrics), findings=(*report.findings, *findings, *advice))
    return replace(outcome, report=told)


def certified_files(
    files: Sequence[CutFile],
    nesting: Nesting,
    patterns: Sequence[FlatPattern],
    options: NestOptions,
    machine: Machine = DEFAULT,
) -> tuple[tuple[Metric, ...], tuple[Finding, ...]]:
    """Return what was measured on the sheets of a nest as their files read, and what is wrong.

    Where each part has a file of its own, what that holds is laid on the sheets as the parts are.  Contours that are
    offset by half a kerf are certified as they are, with gaps that are as much less.
    """
    from stages.nest.legal.files import certify_contours

    nesting, options = _offset(machine.helps.offset_mm, nesting, options)
    patterns, _ = beam_patterns(patterns, machine)
    texts = {file.path: file.text for file in files if DRAWING.fullmatch(file.path)}
    back = {path: bridged(_read(path, text, machine), machine.helps.gap_mm) for path, text in texts.items()}
    found = (
        _of_parts(back, nesting, machine)
        if machine.file_per == "part"
        else _of_sheets(back, nesting, patterns, machine)
    )
    sheets = [read_sheet(layout, entities, options) for layout, entities in zip(nesting.layouts, found, strict=True)]
    return certify_contours(sheets, patterns, options)


def _read(path: str, text: str, machine: Machine) -> Sequence[Entity]:
    return read(text, machine.of_file(path).layers).entities


def _offset(offset: float, nesting: Nesting, options: NestOptions) -> tuple[Nesting, NestOptions]:
    """Return what offset contours are held against: gaps less by what they are offset, and no zones.

    Zones limit where parts lie, not where the beam goes: the nest was certified against them.
    """
    if offset == 0.0:
        return nesting, options
    sheets = [
        layout.sheet.replace(edge_gap_mm=layout.sheet.edge_gap_mm - offset, zones=()) for layout in nesting.layouts
    ]
    layouts = [replace(layout, sheet=sheet) for layout, sheet in zip(nesting.layouts, sheets, strict=True)]
    kerf = options.kerf_mm - 2.0 * offset
    return Nesting(tuple(layouts)), replace(options, gap_mm=options.gap_mm - 2.0 * offset, kerf_mm=kerf)


def _of_parts(back: Mapping[str, Sequence[Entity]], nesting: Nesting, machine: Machine) -> list[Sequence[Entity]]:
    """Return what the files of the parts hold, as it lies on each sheet."""
    return [
        [
            replace(entity, path=transform(entity.path, placed.motion))
            for placed in layout.placements
            for entity in back[machine.part_path(placed.part)]
            if entity.path is not None
        ]
        for layout in nesting.layouts
    ]


def _of_sheets(
    back: Mapping[str, Sequence[Entity]], nesting: Nesting, patterns: Sequence[FlatPattern], machine: Machine
) -> list[Sequence[Entity]]:
    """Return what each sheet holds, from the file of its own or that of all."""
    paths = [machine.path(layout.sheet.id, layout.index) for layout in nesting.layouts]
    if machine.file_per == "sheet":
        return [back[path] for path in paths]
    places = windows(nesting.layouts, {pattern.part: pattern for pattern in patterns})
    return [tuple(seen(back[path], place)) for path, place in zip(paths, places, strict=True)]


def read_sheet(layout: SheetLayout, entities: Sequence[Entity], options: NestOptions) -> "ReadSheet":
    """Return the contours that will be cut, of what a file holds; those that share cuts put together again."""
    from stages.nest.legal.files import ReadSheet

    by_layer = {
        layer: [one.path for one in entities if one.layer == layer and one.closed and one.path is not None]
        for layer in ("CUT_OUTER", "CUT_INNER")
    }
    shared = closed_again(entities, options.kerf_mm).outlines if options.common_line else ()
    return ReadSheet(layout, [*by_layer["CUT_OUTER"], *(one.path for one in shared)], by_layer["CUT_INNER"])
