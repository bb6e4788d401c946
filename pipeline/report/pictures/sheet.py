"""A nested sheet as it will be cut: parts with their names, the stock under them, utilisation, and what is left over.

Each part name has a colour; a label is written along the direction in which the part has most room, and left out
where it could not be read (the table on the right names every colour).  A copy that was turned over has a sign beside
its number.  The stock itself is drawn by `stock`.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from pipeline.report.pictures.canvas import (
    GREY,
    INK,
    LEFT,
    PALE,
    POINTS_PER_INCH,
    PURPLE,
    TINY_MM,
    Box,
    Canvas,
    Fit,
    fitted,
    length_text,
    own_settings,
    scale_bar,
    shortened,
)
from pipeline.report.pictures.edges import corner_points
from pipeline.report.pictures.flat import closed_polygon, compound
from pipeline.report.pictures.flat_names import upright
from pipeline.report.pictures.marks import mark_points
from pipeline.report.pictures.stock import draw_edges, draw_grain, draw_ground, draw_legend, frame_of
from stages.geometry.arrays import Array, Points2, Vector2, cross2
from stages.geometry.curves.rigid import Rigid2, apply, matrix
from stages.model.pattern import FlatPattern
from stages.model.sheet import Placement, Rectangle, SheetLayout

FILLS = (
    "#BBD9EC", "#F6D7A8", "#BFE3D6", "#EBCFE0", "#F7F0A6", "#F3C2A5", "#D3D3D3", "#D2E9F8",
    "#CFE6A9", "#D8CCF0", "#E6D3B8", "#F5BFC8",
)  # fmt: skip
"""Okabe-Ito's colours, lightened, and four between them, in the order in which part names appear; they cycle."""

WIDTH, LEAST_HEIGHT, MOST_HEIGHT = 12.0, 5.4, 9.0
MARGIN, HEAD, TABLE = 0.3, 0.85, 2.9
AROUND = (0.75, 0.95, 0.2, 0.15)
"""Around the sheet for dimensions and scale, inches: left, bottom, right, top."""

LEAST_TYPE, MOST_TYPE = 4.5, 11.0
"""Points: smaller labels are left out."""

SIGN_WIDTH, SIGN_HEIGHT = 0.62, 1.3
"""Of type, as a share of its size."""

LABEL_SIGNS, TABLE_SIGNS, TABLE_ROW = 24, 26, 0.34
DIRECTIONS_DEG = tuple(range(0, 180, 15))
UPRIGHT_BONUS = 1.2
"""What a label that lies level on the sheet is worth beside the size of its type."""

FREE_FILL = "#F4F4F4"
MIRRORED = "\u21c4"
"""Two arrows, there and back: a copy that was turned over."""


def sheet_picture(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> bytes:
    """Return the picture of a nested sheet as PNG; `patterns` by the names of the parts."""
    with own_settings():
        return _drawn(layout, patterns).png()


def page_height(wide: float, tall: float) -> float:
    """Return the height of the page on which a sheet of that size has the full width, within limits, inches."""
    room = WIDTH - 2.0 * MARGIN - TABLE - AROUND[0] - AROUND[2]
    wanted = room * tall / max(wide, TINY_MM) + HEAD + MARGIN + AROUND[1] + AROUND[3]
    return round(float(np.clip(wanted, LEAST_HEIGHT, MOST_HEIGHT)), 1)


def _drawn(layout: SheetLayout, patterns: Mapping[str, FlatPattern]) -> Canvas:
    frame = frame_of(layout, patterns)
    height = page_height(*(frame[1] - frame[0]).tolist())
    canvas = Canvas(WIDTH, height)
    box = Box(MARGIN, MARGIN / 2.0, WIDTH - MARGIN - TABLE, height - HEAD)
    fit = fitted(frame, box.inset(*AROUND))
    names = list(dict.fromkeys(placed.part for placed in layout.placements))
    fills = {name: FILLS[i % len(FILLS)] for i, name in enumerate(names)}
    _title(canvas, layout, frame, height)
    draw_ground(canvas, layout.sheet, frame, fit)
    if layout.offcut is not None:
        _free(canvas, layout.offcut, fit)
    for name, fill in fills.items():
        copies = [placed for placed in layout.placements if placed.part == name]
        _copies(canvas, copies, patterns[name], fill, fit)
    draw_edges(canvas, layout.sheet, frame, fit)
    rest = draw_legend(canvas, layout.sheet, Box(box.right + 0.1, box.bottom, WIDTH - MARGIN, box.top))
    _table(canvas, layout, patterns, fills, rest)
    draw_grain(canvas, layout.sheet, box.left + AROUND[0], box.bottom)
    scale_bar(canvas, box.right - AROUND[2], box.bottom + 0.1, fit.scale, 1.6)
    return canvas


def _title(canvas: Canvas, layout: SheetLayout, frame: Points2, height: float) -> None:
    sheet, copies = layout.sheet, len(layout.placements)
    words = f"{shortened(sheet.id, 60)}   {sheet.kind} {layout.index}"
    canvas.text((MARGIN, height - 0.33), words, 15.0, INK, LEFT, bold=True)
    wide, tall = (frame[1] - frame[0]).tolist()
    facts = [
        f"{length_text(wide)} \u00d7 {length_text(tall)} mm{' used' if sheet.is_roll else ''}",
        f"{copies} piece{'s' * (copies != 1)}",
        f"utilisation {100.0 * layout.utilisation:.1f} %",
        f"edge gap {sheet.edge_gap_mm:g} mm",
    ]
    canvas.text((MARGIN, height - 0.62), "   |   ".join(facts), 10.0, INK, LEFT)


def rectangle(low_x: float, low_y: float, high_x: float, high_y: float, fit: Fit) -> Points2:
    """Return a rectangle of the sheet on the page, its first corner repeated."""
    corners = [[low_x, low_y], [high_x, low_y], [high_x, high_y], [low_x, high_y], [low_x, low_y]]
    return fit.place(np.array(corners))


def _free(canvas: Canvas, free: Rectangle, fit: Fit) -> None:
    """Draw what is left over."""
    wide, tall = free.width_mm, free.height_mm
    corners = rectangle(free.x, free.y, free.x + wide, free.y + tall, fit)
    canvas.polygons([corners[:-1]], FREE_FILL)
    canvas.lines([corners], PALE, 0.8, (1.5, 2.0))
    words = f"free  {length_text(wide)} \u00d7 {length_text(tall)} mm"
    span = np.abs(corners[2] - corners[0])
    level = span[0] >= min(span[1], FREE_TEXT)
    size = min(9.5, float(min(span)) * POINTS_PER_INCH / SIGN_HEIGHT)
    if size >= LEAST_TYPE:
        canvas.text((corners[0] + corners[2]) / 2.0, words, size, GREY, angle_deg=0.0 if level else 90.0)


FREE_TEXT = 2.0
"""Inches that the note on the offcut takes."""


def _copies(canvas: Canvas, copies: Sequence[Placement], pattern: FlatPattern, fill: str, fit: Fit) -> None:
    """Draw all copies of one part, holes left white, with their labels."""
    rings = [closed_polygon(contour.path, fit) for contour in (pattern.outer, *pattern.inner)]
    moved = [[fit.place(apply(placed.motion, ring)) for ring in rings] for placed in copies]
    canvas.areas([compound(one) for one in moved], fill, INK, 0.7)
    _marks(canvas, copies, pattern, fit)
    rooms = {angle: _room(rings, pattern.label_at, angle) for angle in DIRECTIONS_DEG}
    for placed in copies:
        _label(canvas, placed, pattern, rooms, fit)


def _marks(canvas: Canvas, copies: Sequence[Placement], pattern: FlatPattern, fit: Fit) -> None:
    """Draw marks and bend lines thinly, as far as they are not too many to be told apart."""
    if not 0 < len(copies) * len(pattern.marks) <= MANY_MARKS:
        return
    for bends, colour in ((False, INK), (True, PURPLE)):
        lines = [mark_points(mark.path, fit) for mark in pattern.marks if mark.layer.startswith("BEND") == bends]
        canvas.lines([fit.place(apply(placed.motion, line)) for placed in copies for line in lines], colour, 0.35)


MANY_MARKS = 2000
"""Lines of one part on one sheet: so many take half a second."""


def _label(
    canvas: Canvas, placed: Placement, pattern: FlatPattern, rooms: Mapping[int, tuple[float, float]], fit: Fit
) -> None:
    """Write name and number of the copy, or the number alone, where it can be read."""
    at = fit.place(apply(placed.motion, np.array([pattern.label_at])))[0]
    number = f"{placed.copy}{MIRRORED if placed.motion.mirrored else ''}"
    for words in (f"{shortened(placed.part, LABEL_SIGNS)} #{number}", number):
        found = [
            (_type_size(words, room, fit.scale), _shown_angle(placed.motion, angle)) for angle, room in rooms.items()
        ]
        enough = max(size for size, _ in found) / UPRIGHT_BONUS
        size, angle = min((pair for pair in found if pair[0] >= enough), key=lambda pair: (abs(pair[1]), -pair[1]))
        if size >= LEAST_TYPE:
            canvas.text(at, words, size, angle_deg=angle)
            return


def _type_size(words: str, room: tuple[float, float], scale: float) -> float:
    """Return the largest type, points, at which the words fit into a length and a height given in mm."""
    length, height = room[0] * scale * POINTS_PER_INCH, room[1] * scale * POINTS_PER_INCH
    return min(MOST_TYPE, length / (SIGN_WIDTH * (len(words) + 1)), height / SIGN_HEIGHT)


def _shown_angle(motion: Rigid2, angle_deg: float) -> float:
    """Return how a direction of the part lies on the sheet, upright for reading, degrees."""
    a = np.radians(angle_deg)
    x, y = matrix(motion) @ np.array([np.cos(a), np.sin(a)])
    return upright(float(np.degrees(np.arctan2(y, x))))


def _room(rings: Sequence[Points2], at: Vector2, angle_deg: float) -> tuple[float, float]:
    """Return length and height of the room for a label, mm: centred at a point, along a direction and across it."""
    a = np.radians(angle_deg)
    along = np.array([np.cos(a), np.sin(a)])
    across = np.array([-along[1], along[0]])
    tall = 2.0 * _free_way(rings, at, across)
    return min(2.0 * _free_way(rings, at + s * tall * across, along) for s in (-0.2, 0.0, 0.2)), tall


def _free_way(rings: Sequence[Points2], at: Vector2, along: Vector2) -> float:
    """Return how far one can go from a point both ways along a direction before meeting a contour, mm."""
    ways: list[Array] = []
    for ring in rings:
        height = cross2(along, ring - at)
        way = (ring - at) @ along
        crossing = np.flatnonzero((height[1:] > 0.0) != (height[:-1] > 0.0))
        share = height[crossing] / (height[crossing] - height[crossing + 1])
        ways.append(way[crossing] + share * (way[crossing + 1] - way[crossing]))
    met = np.abs(np.concatenate(ways))
    return float(met.min()) if met.size else 0.0


def _table(
    canvas: Canvas, layout: SheetLayout, patterns: Mapping[str, FlatPattern], fills: Mapping[str, str], box: Box
) -> None:
    """List the parts: colour, copies, name, size."""
    top = box.top - 0.1
    rows = int((top - box.bottom) / TABLE_ROW) - 1
    shown = list(fills.items()) if len(fills) <= rows else list(fills.items())[: rows - 1]
    for i, (name, fill) in enumerate(shown):
        y = top - (i + 0.5) * TABLE_ROW
        swatch = np.array([[0.0, -0.1], [0.22, -0.1], [0.22, 0.1], [0.0, 0.1]]) + np.array([box.left, y])
        canvas.polygons([swatch], fill, INK, 0.6)
        count, mirrored = _counts(layout, name)
        wide, tall = np.diff(corner_points(patterns[name]), axis=0)[0].tolist()
        words = f"{count} \u00d7 {shortened(name, TABLE_SIGNS)}{mirrored}"
        canvas.text((box.left + 0.32, y + 0.075), words, 8.5, INK, LEFT)
        size = f"{length_text(wide)} \u00d7 {length_text(tall)} mm"
        canvas.text((box.left + 0.32, y - 0.075), size, 7.5, GREY, LEFT)
    if len(shown) < len(fills):
        y = top - (len(shown) + 0.5) * TABLE_ROW
        canvas.text((box.left, y), f"and {len(fills) - len(shown)} more parts", 8.5, GREY, LEFT)


def _counts(layout: SheetLayout, name: str) -> tuple[int, str]:
    """Return how many copies of a part lie on the sheet, and how many of them are turned over, in signs."""
    copies = [placed for placed in layout.placements if placed.part == name]
    over = sum(placed.motion.mirrored for placed in copies)
    return len(copies), f"  ({over} {MIRRORED})" if over else ""
