"""What goes into each file, in the order it will be cut, before anyone speaks of formats.

Per part: its label and texts, its marks, its inner contours (small first), its outer contour; a sheet's outline and its
defects come before all parts.  A roll is drawn as long as it is used.  Zones are not drawn: nothing is cut along them,
and the pictures show them.  A nested part is the pattern's own path, moved: arcs stay arcs, marks, label and texts go
along.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stages.geometry.arrays import ArrayValue, Vector2
from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths.arcpath import ArcPath, distances, piece_count, split, transform
from stages.geometry.paths.manypaths import boxes
from stages.model.cutfile import Machine
from stages.model.helps import Helps
from stages.model.pattern import LETTER_WIDTH, Drill, FlatPattern, Purpose, Text
from stages.model.report import Finding
from stages.model.sheet import SheetLayout
from stages.model.strokes import seen_from_below, strokes, turned_over
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
UNMOVED = Rigid2()


@dataclass(frozen=True, slots=True)
class Item:
    """A path on a layer; `contour` numbers the contours of a part, the outer one 0, and is None for all else.

    name: of the mark or hole, if it has one.  copy: which copy of the part on a sheet; 0 where there is but one.
    begun: it counts where it begins.  nominal: the contour that it lies half a kerf beside, if it does.
    purpose: of a contour.  drill: of a round hole that is drilled or stitched through, where it lies.
    own: the path in the frame of its part, one and the same for all copies; motion: from there into the drawing.
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
    own: ArcPath | None = None
    motion: Rigid2 = UNMOVED


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
    part = _part(pattern, machine)
    items, labels = _items(part, UNMOVED, machine), _texts(part, UNMOVED, machine)
    return Drawing(f"flat/{pattern.part}.dxf", _written(items, machine), tuple(labels))


def sheet_drawing(layout: SheetLayout, patterns: Mapping[str, FlatPattern], machine: Machine) -> Drawing:
    """Return the drawing of one nested sheet."""
    parts = {name: _part(patterns[name], machine) for name in dict.fromkeys(one.part for one in layout.placements)}
    copies = [_items(parts[one.part], one.motion, machine, one.copy) for one in layout.placements]
    items, divided = _sharing(copies, machine.common_kerf_mm)
    items = [*stock_items(layout, patterns, machine), *items]
    labels = [label for one in layout.placements for label in _texts(parts[one.part], one.motion, machine)]
    path = machine.path(layout.sheet.id, layout.index)
    return Drawing(path, _written(items, machine), tuple(labels), machine.common_kerf_mm, divided)


def _written(items: Iterable[Item], machine: Machine) -> tuple[Item, ...]:
    """Return the items with the paths that the flavour holds."""
    paths = [(item, as_written(item.path, machine, outline=item.contour is not None)) for item in items]
    return tuple(item if path is item.path else replace(item, path=path) for item, path in paths)


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
    every = boxes(list(paths))
    (low_x, low_y), (high_x, high_y) = every[:, :2].min(axis=0), every[:, 2:].max(axis=0)
    return float(low_x), float(low_y), float(high_x), float(high_y)


@dataclass(frozen=True, slots=True)
class _Part:
    """What the copies of a part have in common: its paths in its own frame, in the order of cutting, and its label."""

    pattern: FlatPattern
    items: tuple[Item, ...]
    label: Label


def _part(pattern: FlatPattern, machine: Machine) -> _Part:
    """Return a part as it is before it lies anywhere."""
    contours = (pattern.outer, *pattern.inner)
    items = []
    for stroke in strokes(pattern):
        path = split(stroke.path, max_bulge=machine.max_bulge)
        item = Item(stroke.layer, pattern.part, path, stroke.contour, stroke.name, own=path)
        if stroke.contour is not None:
            contour = contours[stroke.contour]
            item = replace(item, nominal=contour.nominal, purpose=contour.purpose, drill=drill_of(contour))
        items.append(item)
    return _Part(pattern, tuple(items), _label(pattern))


def _items(part: _Part, motion: Rigid2, machine: Machine, copy: int = 0) -> list[Item]:
    """Return the paths of one copy of a part, in the order of cutting."""
    below = turned_over(part.pattern, motion)
    engraved = [Item("ENGRAVE", part.pattern.part, path, copy=copy) for path in _engraved(part, motion, machine)]
    return [*engraved, *(_lying(item, motion, copy, below=below) for item in part.items)]


def _lying(item: Item, motion: Rigid2, copy: int, *, below: bool) -> Item:
    """Return an item of a part where a copy lies; below: whether that shows its lower side."""
    return Item(
        seen_from_below(item.layer) if below else item.layer,
        item.part,
        transform(item.path, motion),
        item.contour,
        item.name,
        copy,
        nominal=None if item.nominal is None else transform(item.nominal, motion),
        purpose=item.purpose,
        drill=None if item.drill is None else item.drill.replace(at=apply(motion, item.drill.at[None, :])[0]),
        own=item.own,
        motion=motion,
    )


def _engraved(part: _Part, motion: Rigid2, machine: Machine) -> list[ArcPath]:
    """Return the part's name and texts as strokes if the machine wants that, and they are not among its marks.

    What of them does not lie on the part is left out (`stages.write.clipped` says so).
    """
    pattern = part.pattern
    if machine.text == "TEXT" or any(mark.layer == "ENGRAVE" for mark in pattern.marks):
        return []
    name = _moved_label(part.label, motion)
    fits = LABEL_FILL * room(pattern) / max(reach(name.text), LEAST_REACH)
    labels = [name.replace(height_mm=min(fits, LABEL_MOST_MM)), *(moved_text(text, motion) for text in pattern.texts)]
    region = region_of([transform(contour.path, motion) for contour in (pattern.outer, *pattern.inner)])
    strokes_of = (lettering(label.text, label.at, label.height_mm, label.angle_deg) for label in labels)
    return [path for some in strokes_of for path in on_part(some, region)]


def _texts(part: _Part, motion: Rigid2, machine: Machine) -> list[Label]:
    """Return the part's name and the texts on it, unless they are strokes."""
    if machine.text == "strokes":
        return []
    return [_moved_label(part.label, motion), *(moved_text(text, motion) for text in part.pattern.texts)]


def moved_text(text: Text, motion: Rigid2) -> Label:
    """Return a text moved with its part: on a mirrored part its line is mirrored, its letters are not."""
    angle = 180.0 - text.angle_deg if motion.mirrored else text.angle_deg
    at = apply(motion, text.at[None, :])[0]
    return Label("LABEL", text.text, at, text.height_mm, (angle + motion.angle_deg) % FULL_TURN)


def _label(pattern: FlatPattern) -> Label:
    """Return the part's name at its place."""
    return Label("LABEL", pattern.part, pattern.label_at, _label_height(pattern), 0.0)


def _moved_label(label: Label, motion: Rigid2) -> Label:
    """Return the name of a part on a copy: turned with it, never mirrored."""
    return label.replace(at=apply(motion, label.at[None, :])[0], angle_deg=motion.angle_deg)


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
