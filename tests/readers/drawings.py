"""The cut files that every reader is asked about, and what they say by themselves.

Between them they hold what a cut file can hold: a curve of many arcs, quarter arcs, full circles, holes, marks, bend
lines both ways, texts, copies that are turned and mirrored, the outline of the stock, common lines.
"""

from dataclasses import dataclass, replace
from functools import cache
from typing import cast, get_args

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import length
from stages.model.cutfile import Flavour, Machine, Version
from stages.model.pattern import FlatPattern, Mark
from stages.model.patternlayers import BOUNDARY, CUT_OUT, PATTERN_LAYERS, VALIDATION
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.drawing import Drawing, Item, flat_drawing
from stages.write.flavours import as_cut
from stages.write.pieces import PatternFile, flat_file, sheet_files, style_file
from stages.write.sheets import cut_drawings
from tests.stages.write.patterns import contour, line_mark, nesting, pattern, plate, polygon_edges, sector, strip
from tests.stages.write.pieces import flap

FLAVOURS: tuple[Flavour, ...] = get_args(Flavour)
VERSIONS: tuple[Version, ...] = get_args(Version)
OLD = ("r12", "aama")


def kinds() -> list[tuple[Flavour, Version]]:
    """Return every flavour in every version that holds it."""
    return [
        (flavour, version) for flavour in FLAVOURS for version in VERSIONS if (flavour in OLD) == (version == "R12")
    ]


COMMON_KERF_MM = 0.2


def asked() -> list[tuple[Flavour, Version]]:
    """Return what the tests ask about: the default flavour in every version, the others in their first one."""
    return [kind for kind in kinds() if kind[0] == FLAVOURS[0] or kind[1] in ("R2000", "R12")]


@dataclass(frozen=True)
class Sample:
    """A cut file as text, the drawing it was made from, and the figures that the write stage reports of it.

    pattern: whether it is a pattern file, whose layers have numbers that say more than their colours.
    """

    name: str
    text: str
    drawing: Drawing
    figures: dict[str, float]
    pattern: bool = False

    @property
    def cut_mm(self) -> float:
        """How much of the drawing is cut."""
        cut = (BOUNDARY, CUT_OUT) if self.pattern else ("CUT_OUTER", "CUT_INNER")
        return sum(length(item.path) for item in self.drawing.items if item.layer in cut)


def bent() -> FlatPattern:
    """Return a strap with bend lines in both directions."""
    outer = contour(polygon_edges((0.0, 0.0), (90.0, 0.0), (90.0, 25.0), (0.0, 25.0)))
    up, down = (line_mark((x, 0.0), (x, 25.0)) for x in (30.0, 60.0))
    marks = Mark("bend 1", up.path, "BEND_UP"), Mark("bend 2", down.path, "BEND_DOWN")
    return pattern("strap", outer, (45.0, 12.0), marks=marks)


def panel() -> FlatPattern:
    """Return a plain rectangle, which shares cuts with its neighbours."""
    return pattern("panel", contour(polygon_edges((0.0, 0.0), (50.0, 0.0), (50.0, 30.0), (0.0, 30.0))), (25.0, 15.0))


def panels() -> Nesting:
    """Return four panels, two by two, a kerf apart."""
    step_x, step_y = 50.0 + COMMON_KERF_MM, 30.0 + COMMON_KERF_MM
    places = [Rigid2(10.0 + step_x * i, 10.0 + step_y * j) for j in range(2) for i in range(2)]
    copies = tuple(Placement("panel", number + 1, motion) for number, motion in enumerate(places))
    return Nesting((SheetLayout(Sheet("shared", 130.0, 90.0), 1, copies, 0.5),))


@cache
def samples(flavour: Flavour, version: Version) -> tuple[Sample, ...]:
    """Return every sample in one flavour and version."""
    if flavour == "aama":
        return _patterns()
    machine = Machine(flavour=flavour, version=version)
    first = Nesting(nesting().layouts[:1])
    common = replace(machine, common_kerf_mm=COMMON_KERF_MM)
    return (
        *_made([strip(), plate(), bent(), sector()], None, machine),
        *_made([plate(), sector()], first, machine)[2:],
        *_made([panel()], panels(), common)[1:],
    )


def _made(parts: list[FlatPattern], nest: Nesting | None, machine: Machine) -> list[Sample]:
    """Return the files that the write stage makes, each with its drawing and its figures."""
    drawn = [as_cut(one, machine) for one in parts]
    outcome = write(drawn, nest, machine)
    assert outcome.report.passed, outcome.report.findings
    drawings = [flat_drawing(one, machine) for one in drawn]
    drawings += cut_drawings(nest.layouts if nest else (), {one.part: one for one in drawn}, machine)
    figures = cast("dict[str, dict[str, float]]", outcome.report.detail["files"])
    pairs = zip(outcome.product, drawings, strict=True)
    return [Sample(_name(file.path), file.text, drawing, figures[file.path]) for file, drawing in pairs]


def _patterns() -> tuple[Sample, ...]:
    """Return pattern files: of each part, of all of them, and of a sheet."""
    machine = Machine(flavour="aama", version="R12", layers=PATTERN_LAYERS)
    parts = [as_cut(part, machine) for part in (strip(), plate(), bent(), sector(), flap())]
    first = nesting().layouts[:1]
    outcome = write(parts, Nesting(first), machine)
    assert outcome.report.passed, outcome.report.findings
    files = [flat_file(part, machine) for part in parts]
    files += [style_file(parts, machine), *sheet_files(first, {part.part: part for part in parts}, machine)]
    figures = cast("dict[str, dict[str, float]]", outcome.report.detail["files"])
    return tuple(
        Sample(_name(text.path), text.text, _said(file, machine), figures[text.path], pattern=True)
        for file, text in zip(files, outcome.product, strict=True)
    )


def _said(file: PatternFile, machine: Machine) -> Drawing:
    """Return the lines and texts of a pattern file as a drawing, on the layers that the file has."""
    items = [Item(machine.layers[line.layer].name, "", line.path) for line in file.stock]
    labels = [*file.style]
    for piece in file.pieces:
        labels += piece.texts
        for line in piece.lines:
            layer = machine.layers[line.layer].name
            items.append(Item(layer, piece.part, line.path, line.contour))
            if line.traced is not None:
                items.append(Item(VALIDATION[layer], piece.part, line.traced.finer))
    return Drawing(file.path, tuple(items), tuple(labels))


def _name(path: str) -> str:
    return path.split("/")[1].removesuffix(".dxf")
