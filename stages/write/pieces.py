"""What goes into a pattern file: a piece for each part or copy, with its lines, points and texts, before any format.

    flat_file    one part, in its own flat frame
    style_file   all parts of a job beside each other: what a pattern program takes in as one style
    sheet_file   the copies on one sheet, each where it lies; sheets of one material beside each other

A nested copy is a piece of its own, moved: most readers do not turn what they insert, so nothing is inserted turned.
The stock is drawn beside the pieces.  A grain line is drawn where the part has a direction, across the piece through
the place of its name; where it has none, none is invented.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np
from shapely import LineString, Point, Polygon, get_parts

from stages.geometry.arrays import ArrayValue, Points2, Vector2
from stages.geometry.curves.rigid import Rigid2, apply, matrix
from stages.geometry.paths.arcpath import ArcPath, bounds, transform
from stages.model.cutfile import Machine
from stages.model.pattern import Contour, FlatPattern, NotchPlace, Purpose, Traced
from stages.model.patternlayers import DRILL, NOTCH_LAYERS
from stages.model.sheet import SheetLayout
from stages.model.strokes import Stroke, strokes
from stages.write.drawing import Drawing, Item, Label, moved_text, stock_items
from stages.write.piecetext import piece_text, style_text
from stages.write.sheets import Window, windows
from stages.write.tracing import chorded_line

GAP_MM = 20.0
"""Between pieces that lie beside each other."""

GRAIN_SHARE = 0.8
"""Of the way across the piece: the rest is left free, so that nobody takes the line for one that ends on the edge."""

NAME_MOST = 31
"""Letters of a name in R12."""

UNNAMED = re.compile(r"[^A-Z0-9_$-]")
"""What it is not made of."""

FULL_TURN = 360.0


@dataclass(frozen=True, slots=True)
class Line:
    """A path of chords; `traced` where its vertices are turn and curve points.

    layer: what it means.  contour: the number of a contour of its part, the outer one 0; None for all else.
    name: of the mark or hole, if it has one.  purpose: of a contour.
    """

    layer: str
    path: ArcPath
    traced: Traced | None = None
    contour: int | None = None
    name: str = ""
    purpose: Purpose | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Spot(ArrayValue):
    """A notch or a drill hole: the number of its layer, its place, depth and width (diameter) in mm, and direction."""

    layer: str
    at: Vector2
    depth_mm: float = 0.0
    width_mm: float = 0.0
    angle_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Piece:
    """A block: its name in the file, the part that it shows, its lines in the order of cutting, points and texts.

    copy: which copy of the part on a sheet; 0 where there is but one.
    """

    name: str
    part: str
    lines: tuple[Line, ...]
    spots: tuple[Spot, ...]
    texts: tuple[Label, ...]
    copy: int = 0


@dataclass(frozen=True, slots=True)
class PatternFile:
    """A pattern file to be: its place below the output folder, its pieces, the stock, and what is said of all pieces.

    exact: whether the pieces lie in the flat frames of their parts, where their exact edges are known.
    """

    path: str
    pieces: tuple[Piece, ...]
    stock: tuple[Line, ...]
    style: tuple[Label, ...]
    exact: bool = False


@dataclass(frozen=True, slots=True)
class Copy:
    """A part where it lies: what its piece is called, and how many of it are wanted, mirror images apart."""

    pattern: FlatPattern
    motion: Rigid2
    name: str
    quantity: str
    number: int = 0


def as_drawing(file: PatternFile) -> Drawing:
    """Return the paths and texts of a pattern file as a drawing, the pieces before the stock."""
    items = [
        Item(line.layer, piece.part, line.path, line.contour, line.name, piece.copy, purpose=line.purpose)
        for piece in file.pieces
        for line in piece.lines
    ]
    items += [Item(line.layer, "", line.path) for line in file.stock]
    labels = (*(label for piece in file.pieces for label in piece.texts), *file.style)
    return Drawing(file.path, tuple(items), labels)


def flat_file(pattern: FlatPattern, machine: Machine, path: str = "") -> PatternFile:
    """Return the file of one part by itself."""
    copy = Copy(pattern, Rigid2(), pattern.part, quantity(pattern))
    return _file(path or f"flat/{pattern.part}.dxf", [copy], (), machine, exact=True)


def style_file(patterns: Sequence[FlatPattern], machine: Machine) -> PatternFile:
    """Return the file of all parts, from left to right in their order, on one base line."""
    copies, at = list[Copy](), 0.0
    for pattern in patterns:
        low_x, low_y, high_x, _ = bounds(pattern.outer.path)
        copies.append(Copy(pattern, Rigid2(at - low_x, -low_y), pattern.part, quantity(pattern)))
        at += high_x - low_x + GAP_MM
    return _file(f"pieces/{machine.style.name}.dxf", copies, (), machine)


def sheet_files(
    layouts: Sequence[SheetLayout], patterns: Mapping[str, FlatPattern], machine: Machine
) -> list[PatternFile]:
    """Return the files of nested sheets, as the machine wants them divided."""
    if machine.file_per == "part":
        names = dict.fromkeys(placed.part for layout in layouts for placed in layout.placements)
        return [flat_file(patterns[name], machine, machine.part_path(name)) for name in names]
    places = windows(layouts, patterns) if machine.file_per == "material" else [Window(0.0, 0.0, 0.0)] * len(layouts)
    laid = [
        (machine.path(layout.sheet.id, layout.index), *_sheet(layout, patterns, place.shift, machine))
        for layout, place in zip(layouts, places, strict=True)
    ]
    if machine.file_per == "sheet" or not laid:
        return [_file(path, copies, stock, machine) for path, copies, stock in laid]
    copies = [copy for _, some, _ in laid for copy in some]
    return [_file(laid[0][0], copies, [line for _, _, some in laid for line in some], machine)]


def _sheet(
    layout: SheetLayout, patterns: Mapping[str, FlatPattern], shift: float, machine: Machine
) -> tuple[list[Copy], list[Line]]:
    """Return the copies on a sheet and its own outlines, moved along x."""
    copies = [
        Copy(patterns[one.part], one.motion.replace(x=one.motion.x + shift), f"{one.part}-{one.copy}", "1", one.copy)
        for one in layout.placements
    ]
    aside = Rigid2(shift, 0.0)
    stock = [Line(item.layer, transform(item.path, aside)) for item in stock_items(layout, patterns, machine)]
    return copies, [replace(line, path=chorded_line(line.path, STOCK_CHORD_MM)[0]) for line in stock]


STOCK_CHORD_MM = 0.02
"""How far the chords of the stock may be off its arcs: nothing is cut along them."""


def quantity(pattern: FlatPattern) -> str:
    """Return how many copies are wanted; of a pair, how many as drawn and how many mirrored."""
    mirrored = pattern.quantity // 2
    return f"{pattern.quantity - mirrored},{mirrored}" if pattern.pair else str(pattern.quantity)


def _file(
    path: str, copies: Sequence[Copy], stock: Iterable[Line], machine: Machine, *, exact: bool = False
) -> PatternFile:
    names = block_names([f"{copy.name}_{machine.style.size}" for copy in copies])
    pieces = tuple(_piece(copy, name, machine) for copy, name in zip(copies, names, strict=True))
    drawn = tuple(stock)
    chord = max(copy.pattern.outer.chord_mm for copy in copies)
    paths = [line.path for line in (*drawn, *(line for piece in pieces for line in piece.lines))]
    low_x, low_y = (min(bounds(one)[k] for one in paths) for k in (0, 1))
    return PatternFile(path, pieces, drawn, style_text(machine.style, chord, (low_x, low_y)), exact)


def block_names(wishes: Sequence[str]) -> list[str]:
    """Return names that R12 allows, no two the same: capitals, digits, dash, dollar and underscore, at most 31."""
    taken: list[str] = []
    for wish in wishes:
        plain = UNNAMED.sub("_", wish.upper())
        name, count = plain[:NAME_MOST], 1
        while name in taken:
            count += 1
            name = f"{plain[: NAME_MOST - len(str(count)) - 1]}-{count}"
        taken.append(name)
    return taken


def _piece(copy: Copy, name: str, machine: Machine) -> Piece:
    """Return one part where it lies."""
    pattern, motion = copy.pattern, copy.motion
    texts = piece_text(pattern, motion, copy.name, copy.quantity, machine.style)
    grain = _grain(pattern)
    lines = [*_lines(pattern), *([Line("GRAIN", grain)] if grain is not None else [])]
    return Piece(
        name,
        pattern.part,
        tuple(_moved(line, motion) for line in sorted(lines, key=lambda line: line.layer.startswith("CUT_"))),
        tuple(_spots(pattern, motion)),
        (*texts, *(moved_text(text, motion) for text in pattern.texts)),
        copy.number,
    )


def _lines(pattern: FlatPattern) -> Iterator[Line]:
    """Yield the marks and contours of a part in the order of cutting."""
    contours: tuple[Contour, ...] = (pattern.outer, *pattern.inner)
    for stroke in strokes(pattern):
        if stroke.contour is None:
            yield _mark(stroke, pattern.outer.chord_mm)
        else:
            made = contours[stroke.contour]
            yield Line(stroke.layer, stroke.path, made.traced, stroke.contour, stroke.name, made.purpose)


def _mark(stroke: Stroke, chord_mm: float) -> Line:
    return Line(stroke.layer, *chorded_line(stroke.path, chord_mm), name=stroke.name)


def _moved(line: Line, motion: Rigid2) -> Line:
    """Return a moved line; on a mirrored part it runs the other way, and so do its turn points."""
    if line.traced is None:
        return replace(line, path=transform(line.path, motion))
    turns = line.traced.turns[::-1] if motion.mirrored else line.traced.turns
    return replace(line, path=transform(line.path, motion), traced=Traced(turns, transform(line.traced.finer, motion)))


def _spots(pattern: FlatPattern, motion: Rigid2) -> Iterator[Spot]:
    """Yield the notches and drill holes of a part where it lies."""
    for notch in pattern.notches:
        x, y = matrix(motion) @ notch.inward
        angle = float(np.degrees(np.arctan2(y, x)) % FULL_TURN)
        at = apply(motion, notch.at[None, :])[0]
        yield Spot(NOTCH_LAYERS[notch.kind], at, notch.depth_mm, _width(notch), angle)
    for drill in pattern.drills:
        yield Spot(DRILL, apply(motion, drill.at[None, :])[0], width_mm=drill.diameter_mm)


def _width(notch: NotchPlace) -> float:
    """Return the width of a notch at the edge; a slit has none."""
    return 0.0 if notch.kind == "slit" else notch.width_mm


def _grain(pattern: FlatPattern) -> ArcPath | None:
    """Return the grain line through the place of the name, or None where the part may lie in any direction."""
    if pattern.axis_deg is None:
        return None
    angle = radians(pattern.axis_deg)
    along = np.array([cos(angle), sin(angle)])
    region = Polygon(pattern.outer.path.vertices, [hole.path.vertices for hole in pattern.inner])
    reach = region.length
    across = region.intersection(LineString([pattern.label_at - reach * along, pattern.label_at + reach * along]))
    ways = [way for way in get_parts(across) if isinstance(way, LineString)]
    ends = np.array(min(ways, key=lambda way: way.distance(Point(pattern.label_at))).coords)[[0, -1]]
    return ArcPath(_shortened(ends), np.zeros(2), closed=False)


def _shortened(ends: Points2) -> Points2:
    middle = ends.mean(axis=0)
    points: Points2 = middle + GRAIN_SHARE * (ends - middle)
    return points
