"""What goes into each file, in the order it will be cut, before anyone speaks of formats.

Per part: its label and texts, its marks, its inner contours (small first), its outer contour; a sheet's outline comes
before all parts.  A nested part is the pattern's own path, moved: arcs stay arcs, marks, label and texts go along.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from stages.geometry.arcpath import ArcPath, area, bounds, distances, piece_count, split, transform
from stages.geometry.arrays import ArrayValue, Vector2
from stages.geometry.rigid import Rigid2, apply
from stages.model.cutfile import Machine
from stages.model.pattern import LETTER_WIDTH, FlatPattern, Text
from stages.model.sheet import SheetLayout

LABEL_MOST_MM = 10.0
LABEL_LEAST_MM = 0.1
"""Smaller text cannot be read on any screen; where no text fits, it may cross the contour, as nobody cuts it."""

LABEL_FILL = 0.9
"""Share of the room around the label's place that its box may take."""

FULL_TURN = 360.0
QUARTER_BULGE = 0.41421356237309503


@dataclass(frozen=True, slots=True)
class Item:
    """A path on a layer; `contour` numbers the contours of a part, the outer one 0, and is None for all else."""

    layer: str
    part: str
    path: ArcPath
    contour: int | None = None


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
    """One file to be: its place below the output folder, its paths in order, and its labels."""

    path: str
    items: tuple[Item, ...]
    labels: tuple[Label, ...]


def flat_drawing(pattern: FlatPattern, machine: Machine) -> Drawing:
    """Return the drawing of one part in its own flat frame."""
    items, labels = _items(pattern, Rigid2(), machine), _labels(pattern, Rigid2())
    return Drawing(f"flat/{pattern.part}.dxf", tuple(items), tuple(labels))


def sheet_drawing(layout: SheetLayout, patterns: Mapping[str, FlatPattern], machine: Machine) -> Drawing:
    """Return the drawing of one nested sheet."""
    width, height = layout.sheet.width_mm, layout.sheet.height_mm
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    items = [Item("SHEET", "", ArcPath(corners, np.zeros(4), closed=True))]
    for placement in layout.placements:
        items += _items(patterns[placement.part], placement.motion, machine)
    labels = [label for placed in layout.placements for label in _labels(patterns[placed.part], placed.motion)]
    return Drawing(f"cut/{layout.sheet.id}-{layout.index}.dxf", tuple(items), tuple(labels))


def extent(paths: Iterable[ArcPath]) -> tuple[float, float, float, float]:
    """Return the exact extent of all paths (x least, y least, x most, y most) in mm."""
    every = np.array([bounds(path) for path in paths])
    low, high = every[:, :2].min(axis=0), every[:, 2:].max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _items(pattern: FlatPattern, motion: Rigid2, machine: Machine) -> list[Item]:
    """Return the paths of one copy of a part, in the order of cutting."""
    inner = sorted(range(len(pattern.inner)), key=lambda i: abs(area(pattern.inner[i].path)))

    def moved(layer: str, path: ArcPath, contour: int | None = None) -> Item:
        return Item(layer, pattern.part, transform(split(path, max_bulge=machine.max_bulge), motion), contour)

    marks = [moved(mark.layer, mark.path) for mark in pattern.marks]
    holes = [moved("CUT_INNER", pattern.inner[i].path, i + 1) for i in inner]
    return [*marks, *holes, moved("CUT_OUTER", pattern.outer.path, 0)]


def _labels(pattern: FlatPattern, motion: Rigid2) -> list[Label]:
    """Return the part's name and the texts on it."""
    return [_label(pattern, motion), *(_moved(text, motion) for text in pattern.texts)]


def _moved(text: Text, motion: Rigid2) -> Label:
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
    paths = [contour.path for contour in (pattern.outer, *pattern.inner)]
    room = min(_distance(pattern.label_at, split(path, max_bulge=QUARTER_BULGE)) for path in paths)
    diagonal = float(np.hypot(LETTER_WIDTH * len(pattern.part), 1.0))
    return float(np.clip(2.0 * LABEL_FILL * room / diagonal, LABEL_LEAST_MM, LABEL_MOST_MM))


def _distance(point: Vector2, path: ArcPath) -> float:
    """Return the distance of a point to a path in mm."""
    count = piece_count(path)
    return float(distances(np.broadcast_to(point, (count, 2)), path, np.arange(count)).min())
