"""The drawings in `cut/`: one for each sheet, for each part by itself, or one with all sheets beside each other.

Beside each other sheets lie along x in their order, `SHEETS_APART_MM` between their outlines, none of them turned, the
first where it is in a drawing of its own: a machine cuts them one after the other, a person sees all of a material.
Parts by themselves lie as in `flat/`, and no sheet is drawn: whoever cuts them nests them.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stages.geometry.curves.rigid import Rigid2
from stages.geometry.paths.arcpath import ArcPath, bounds, transform
from stages.model.cutfile import Machine
from stages.model.pattern import FlatPattern
from stages.model.sheet import SheetLayout
from stages.write.chains import Entity
from stages.write.drawing import Drawing, Item, flat_drawing, sheet_drawing, stock_outline

SHEETS_APART_MM = 50.0
"""Between sheets in one drawing: wide enough to see, and for whatever a machine adds around a sheet."""


@dataclass(frozen=True, slots=True)
class Window:
    """Where a sheet lies in a drawing of several: from and to along x, and how far it was moved, in mm."""

    low: float
    high: float
    shift: float


def cut_drawings(
    layouts: Sequence[SheetLayout], patterns: Mapping[str, FlatPattern], machine: Machine
) -> list[Drawing]:
    """Return the drawings of nested sheets, as the machine wants them divided into files."""
    if machine.file_per == "part":
        names = dict.fromkeys(placed.part for layout in layouts for placed in layout.placements)
        return [replace(flat_drawing(patterns[name], machine), path=machine.part_path(name)) for name in names]
    drawings = [sheet_drawing(layout, patterns, machine) for layout in layouts]
    if machine.file_per == "sheet" or not drawings:
        return drawings
    places = windows(layouts, patterns)
    return [_united([_moved(one, place.shift) for one, place in zip(drawings, places, strict=True)])]


def windows(layouts: Sequence[SheetLayout], patterns: Mapping[str, FlatPattern]) -> list[Window]:
    """Return where each of some sheets lies in a drawing of all of them."""
    found: list[Window] = []
    for layout in layouts:
        low, _, high, _ = bounds(stock_outline(layout, patterns))
        shift = found[-1].high + SHEETS_APART_MM - low if found else 0.0
        found.append(Window(low + shift, high + shift, shift))
    return found


def seen(entities: Sequence[Entity], window: Window) -> Iterator[Entity]:
    """Yield the paths of a drawing that lie on one of its sheets, as if that were the only one."""
    for entity in entities:
        if entity.path is None:
            continue
        low, _, high, _ = bounds(entity.path)
        if window.low <= (low + high) / 2.0 <= window.high:
            yield replace(entity, path=_shifted(entity.path, -window.shift))


def _shifted(path: ArcPath, shift: float) -> ArcPath:
    return transform(path, Rigid2(shift, 0.0))


def _moved(drawing: Drawing, shift: float) -> Drawing:
    """Return a drawing moved along x."""
    return replace(
        drawing,
        items=tuple(_item_moved(item, shift) for item in drawing.items),
        labels=tuple(label.replace(at=label.at + np.array([shift, 0.0])) for label in drawing.labels),
        divided=tuple(_shifted(path, shift) for path in drawing.divided),
    )


def _item_moved(item: Item, shift: float) -> Item:
    nominal = None if item.nominal is None else _shifted(item.nominal, shift)
    motion = item.motion.replace(x=item.motion.x + shift)
    return replace(item, path=_shifted(item.path, shift), nominal=nominal, motion=motion)


def _united(drawings: Sequence[Drawing]) -> Drawing:
    """Return one drawing of several, each as it is."""
    return replace(
        drawings[0],
        items=tuple(item for drawing in drawings for item in drawing.items),
        labels=tuple(label for drawing in drawings for label in drawing.labels),
        divided=tuple(path for drawing in drawings for path in drawing.divided),
    )
