"""What goes into each file, in the order it will be cut, before anyone speaks of formats.

Per part: its label and texts, its marks, its inner contours (small first), its outer contour; a sheet's outline and its
defects come before all parts.  A roll is drawn as long as it is used.  Zones are not drawn: nothing is cut along them,
and the pictures show them.  A nested part is the pattern's own path, moved: arcs stay arcs, marks, label and texts go
along.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stages.geometry.arcpath import ArcPath, bounds, distances, piece_count, split, transform
from stages.geometry.arrays import ArrayValue, Vector2
from stages.geometry.rigid import Rigid2, apply
from stages.model.cutfile import Machine
from stages.model.helps import Helps
from stages.model.pattern import LETTER_WIDTH, Contour, Drill, FlatPattern, Purpose, Text
from stages.model.report import Finding
from stages.model.sheet import SheetLayout
from stages.model.strokes import Stroke, seen_from_below, strokes, turned_over
from stages.model.used import used_length_mm
from stages.write.commonlines import in_turn, shared_cuts
from stages.write.flavours import as_written
from stages.write.onpart import on_part, region_of
from stages.write.strokefont import lettering, reach
from stages.write.tracing import drill_of

LABEL_MOST_MM = 10.0
LABEL_LEAST_MM = 0.1
"""Smaller text cannot be read on any screen; where no text fits, it may cross the contour, as nobody cuts it."""

LABEL_FILL = 0.9
"""Share of the room around the label's place that its box may take."""

LEAST_REACH = 0.1
"""In heights of a text: less than any letter reaches from its middle."""

FULL_TURN = 360.0
QUARTER_BULGE = 0.41421356237309503


@dataclass(frozen=True, slots=True)
class Item:
    """A path on a layer; `contour` numbers the contours of a part, the outer one 0, and is None for all else.

    name: of the mark or hole, if it has one.  copy: which copy of the part on a sheet; 0 where there is but one.
    begun: it counts where it begins.  nominal: the contour that it lies half a kerf beside, if it does.
    purpose: of a contour.  drill: of a round hole that is drilled or stitched through, where it lies.
    """

    layer: str
    part: str
    path: ArcPath
    contour: int | None = None
    name: str = ""
    copy: int = 0
    begun: bool = False
    nominal: ArcPath | None = None
    purpose: Purpose | None = None
    drill: Drill | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Label(ArrayValue):
    """A text centred at a point, heights in mm."""

    layer: str
    text: str
    at: Vector2
    height_mm: float
    angle_deg: float

    def check(self) -> None:
        """Refuse what a DXF text cannot hold, and what is not finite."""
        if not (self.text.isascii() and self.text.isprintable()):
            raise ValueError(f"a label must be printable ASCII: {self.text!r}")
        if not (np.isfinite(self.at).all() and np.isfinite([self.height_mm, self.angle_deg]).all()):
            raise ValueError(f"the label {self.text!r} must be finite")


@dataclass(frozen=True, slots=True)
class Drawing:
    """One file to be: its place below the output folder, its paths in order, and its labels.

    kerf_mm: parts this far apart share cuts (`stages.write.commonlines`); None: every outline is drawn whole.
    divided: the outlines that are not.
    helps: what helps the process in it; told: the findings that say so.
    """

    path: str
    items: tuple[Item, ...]
    labels: tuple[Label, ...]
    kerf_mm: float | None = None
    divided: tuple[ArcPath, ...] = ()
    helps: Helps = field(default_factory=Helps)
    told: tuple[Finding, ...] = ()


def flat_drawing(pattern: FlatPattern, machine: Machine) -> Drawing:
    """Return the drawing of one part in its own flat frame."""
    items, labels = _items(pattern, Rigid2(), machine), _texts(pattern, Rigid2(), machine)
    return Drawing(f"flat/{pattern.part}.dxf", _written(items, machine), tuple(labels))


def sheet_drawing(layout: SheetLayout, patterns: Mapping[str, FlatPattern], machine: Machine) -> Drawing:
    """Return the drawing of one nested sheet."""
    parts = [
        [replace(item, copy=placed.copy) for item in _items(patterns[placed.part], placed.motion, machine)]
        for placed in layout.placements
    ]
    items, divided = _sharing(parts, machine.common_kerf_mm)
    items = [*stock_items(layout, patterns, machine), *items]
    labels = [label for placed in layout.placements for label in _texts(patterns[placed.part], placed.motion, machine)]
    path = machine.path(layout.sheet.id, layout.index)
    return Drawing(path, _written(items, machine), tuple(labels), machine.common_kerf_mm, divided)


def _written(items: Iterable[Item], machine: Machine) -> tuple[Item, ...]:
    """Return the items with the paths that the flavour holds."""
    return tuple(replace(item, path=as_written(item.path, machine, outline=item.contour is not None)) for item in items)


def _sharing(parts: Sequence[Sequence[Item]], kerf_mm: float | None) -> tuple[list[Item], tuple[ArcPath, ...]]:
    """Return the paths of some parts with common lines instead of shared edges, and the outlines that share any.

    A common line comes right after the later one of its parts.
    """
    if kerf_mm is None:
        return [item for part in parts for item in part], ()
    shared = shared_cuts([part[-1].path for part in parts], kerf_mm)
    made: list[Item] = []
    for number, (*before, outer) in enumerate(parts):
        rests = [replace(outer, path=rest) for rest in shared.rests[number]]
        lines = [line for line in shared.lines if line.outlines[-1] == number]
        begin = (*before, outer, *rests)[-1].path.vertices[-1]
        made += [*before, *rests, *(Item("CUT_OUTER", "", line) for line in in_turn(lines, begin))]
    sharing = {number for line in shared.lines for number in line.outlines}
    return made, tuple(part[-1].path for number, part in enumerate(parts) if number in sharing)


def stock_items(layout: SheetLayout, patterns: Mapping[str, FlatPattern], machine: Machine) -> list[Item]:
    """Return the outline of a sheet, of a roll as far as it is used, that of what is left over, and the defects."""
    edges = [stock_outline(layout, patterns)]
    if layout.offcut is not None:
        piece = layout.offcut
        edges.append(rectangle(piece.width_mm, piece.height_mm, piece.x, piece.y))
    drawn = [*(("SHEET", path) for path in edges), *(("SHEET_KEEPOUT", path) for path in layout.sheet.defects)]
    return [Item(layer, "", split(path, max_bulge=machine.max_bulge)) for layer, path in drawn]


def stock_outline(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> ArcPath:
    """Return the outline of a sheet, of a roll as far as it is used."""
    sheet = layout.sheet
    return sheet.outline or rectangle(used_length_mm(layout, patterns), sheet.height_mm)


def rectangle(width_mm: float, height_mm: float, x: float = 0.0, y: float = 0.0) -> ArcPath:
    """Return an upright rectangle from its lower left corner."""
    corners = np.array([[0.0, 0.0], [width_mm, 0.0], [width_mm, height_mm], [0.0, height_mm]]) + np.array([x, y])
    return ArcPath(corners, np.zeros(4), closed=True)


def extent(paths: Iterable[ArcPath]) -> tuple[float, float, float, float]:
    """Return the exact extent of all paths (x least, y least, x most, y most) in mm."""
    every = list(paths)
    corners = np.concatenate([path.vertices for path in every])
    low, high = corners.min(axis=0), corners.max(axis=0)
    boxes = [np.reshape(bounds(path), (2, 2)) for path in every if path.bulges.any() and _swells(path, low, high)]
    reached = np.concatenate([np.stack([low, high]), *boxes])
    (low_x, low_y), (high_x, high_y) = reached.min(axis=0), reached.max(axis=0)
    return float(low_x), float(low_y), float(high_x), float(high_y)


def _swells(path: ArcPath, low: Vector2, high: Vector2) -> bool:
    """Return whether the arcs of a path may reach out of a box: an arc rises over its chord by bulge times half of it.

    One of more than half a circle may in any case.
    """
    least, most = path.vertices.min(axis=0), path.vertices.max(axis=0)
    steepest = float(np.abs(path.bulges).max())
    rise = steepest * float(np.hypot(*(most - least))) / 2.0
    return steepest > 1.0 or bool((least - rise < low).any() or (most + rise > high).any())


def _items(pattern: FlatPattern, motion: Rigid2, machine: Machine) -> list[Item]:
    """Return the paths of one copy of a part, in the order of cutting."""
    contours = (pattern.outer, *pattern.inner)

    def moved(stroke: Stroke) -> Item:
        path = transform(split(stroke.path, max_bulge=machine.max_bulge), motion)
        layer = seen_from_below(stroke.layer) if turned_over(pattern, motion) else stroke.layer
        item = Item(layer, pattern.part, path, stroke.contour, stroke.name)
        return item if stroke.contour is None else _of_contour(item, contours[stroke.contour], motion)

    return [*_engraved(pattern, motion, machine), *(moved(stroke) for stroke in strokes(pattern))]


def _of_contour(item: Item, contour: Contour, motion: Rigid2) -> Item:
    """Return the item of a contour with what the contour is for."""
    beside = None if contour.nominal is None else transform(contour.nominal, motion)
    drill = drill_of(contour)
    there = None if drill is None else drill.replace(at=apply(motion, drill.at[None, :])[0])
    return replace(item, nominal=beside, purpose=contour.purpose, drill=there)


def _engraved(pattern: FlatPattern, motion: Rigid2, machine: Machine) -> list[Item]:
    """Return the part's name and texts as strokes if the machine wants that, and they are not among its marks.

    What of them does not lie on the part is left out (`stages.write.clipped` says so).
    """
    if machine.text == "TEXT" or any(mark.layer == "ENGRAVE" for mark in pattern.marks):
        return []
    name = _label(pattern, motion)
    fits = LABEL_FILL * room(pattern) / max(reach(name.text), LEAST_REACH)
    labels = [name.replace(height_mm=min(fits, LABEL_MOST_MM)), *(moved_text(text, motion) for text in pattern.texts)]
    region = region_of([transform(contour.path, motion) for contour in (pattern.outer, *pattern.inner)])
    return [
        Item("ENGRAVE", pattern.part, path)
        for label in labels
        for path in on_part(lettering(label.text, label.at, label.height_mm, label.angle_deg), region)
    ]


def _texts(pattern: FlatPattern, motion: Rigid2, machine: Machine) -> list[Label]:
    """Return the part's name and the texts on it, unless they are strokes."""
    if machine.text == "strokes":
        return []
    return [_label(pattern, motion), *(moved_text(text, motion) for text in pattern.texts)]


def moved_text(text: Text, motion: Rigid2) -> Label:
    """Return a text moved with its part: on a mirrored part its line is mirrored, its letters are not."""
    angle = 180.0 - text.angle_deg if motion.mirrored else text.angle_deg
    at = apply(motion, text.at[None, :])[0]
    return Label("LABEL", text.text, at, text.height_mm, (angle + motion.angle_deg) % FULL_TURN)


def _label(pattern: FlatPattern, motion: Rigid2) -> Label:
    """Return the part's name at its place; turned with the part, never mirrored."""
    at = apply(motion, pattern.label_at[None, :])[0]
    return Label("LABEL", pattern.part, at, _label_height(pattern), motion.angle_deg)


def _label_height(pattern: FlatPattern) -> float:
    """Return the height in mm at which the name's box fits into the free circle around its place."""
    diagonal = float(np.hypot(LETTER_WIDTH * len(pattern.part), 1.0))
    return float(np.clip(2.0 * LABEL_FILL * room(pattern) / diagonal, LABEL_LEAST_MM, LABEL_MOST_MM))


def room(pattern: FlatPattern) -> float:
    """Return how far the label's place is from all contours, mm."""
    return clear_mm(pattern.label_at, [contour.path for contour in (pattern.outer, *pattern.inner)])


def clear_mm(point: Vector2, paths: Iterable[ArcPath]) -> float:
    """Return how far a point is from the nearest of some paths, mm."""
    return min(_distance(point, split(path, max_bulge=QUARTER_BULGE)) for path in paths)


def _distance(point: Vector2, path: ArcPath) -> float:
    """Return the distance of a point to a path in mm."""
    count = piece_count(path)
    return float(distances(np.broadcast_to(point, (count, 2)), path, np.arange(count)).min())
