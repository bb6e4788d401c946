"""A flat pattern as it is cut: lines and arcs with their joints, holes, marks, rulings, and its dimensions.

The four edges of a strip have the colours that they have on the formed surface; their lengths are those of the exact
edges, and the overall dimensions those of the path that is cut.  A pattern much higher than wide may be shown turned by
-90 degrees; the axes of the flat frame are drawn beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pipeline.report.pictures.canvas import (
    GREY,
    HEAD,
    INK,
    PALE,
    PURPLE,
    Box,
    Canvas,
    Fit,
    arrow,
    caption,
    fitted,
    length_text,
    scale_bar,
)
from pipeline.report.pictures.edges import corner_points, hole_text, rulings, side_length, sides
from pipeline.report.pictures.flat_names import LONG_ENOUGH, ROOM_PER_SIGN, upright, write_edge_names
from pipeline.report.pictures.marks import draw_marks, has_bends, marks_legend
from pipeline.report.pictures.net import ruling_places
from pipeline.report.pictures.surface import COLOURS, EDGE_WIDTH, RULING_WIDTH, WORST_WIDTH
from stages.geometry.arrays import Points2, Vector2, norm, unit
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.model.pattern import Contour, FlatPattern

if TYPE_CHECKING:
    from matplotlib.path import Path

PART_FILL = "#E3EEF6"
SAMPLES = 65
"""Points of an exact edge, for its coloured band."""

MANY_JOINTS = 600
"""Beyond so many joints of lines and arcs they would hide the line; they are left out."""

DIMENSION_GAP = 0.42
BESIDE_GAP = 1.45
MANY_HOLES = 24


@dataclass(frozen=True, slots=True)
class Room:
    """What a pattern needs: its box in mm, and the shortest line (edge or height) whose text stands left or right."""

    corners: Points2
    shortest_mm: float
    turned: bool

    def fit(self, box: Box) -> Fit:
        """Return how the pattern is laid into a box so that its dimensions find room."""
        close = fitted(self.corners, box.inset(*MARGINS), turned=self.turned)
        if self.shortest_mm * close.scale >= LONG_ENOUGH:
            return close
        return fitted(self.corners, box.inset(*WIDE_MARGINS), turned=self.turned)

    def shown_in(self, box: Box) -> float:
        """Return how long the longer side is shown in a box, inches; nothing in one that is too small."""
        roomy = box.inset(*WIDE_MARGINS)
        if min(roomy.width, roomy.height) <= 0.0:
            return 0.0
        return float((self.corners[1] - self.corners[0]).max()) * self.fit(box).scale


MARGINS = (DIMENSION_GAP + 0.4, 1.0, 0.75, 0.7)
WIDE_MARGINS = (BESIDE_GAP + 1.4, 1.0, BESIDE_GAP, 0.7)
"""Around a pattern, inches (left, bottom, right, top); the wide ones where text stands beside short lines."""


def pattern_room(pattern: FlatPattern, *, turned: bool) -> Room:
    """Return the room that a pattern needs."""
    corners = corner_points(pattern)
    extent = corners[1] - corners[0]
    lines = [float(extent[0] if turned else extent[1])]
    for edges in sides(pattern).values():
        way = np.abs(edges[len(edges) // 2].derivative(np.array([0.5]))[0])
        across, along = (way[1], way[0]) if turned else (way[0], way[1])
        if along > across / 2.0:
            lines.append(side_length(edges))
    return Room(corners, min(lines), turned)


def draw_pattern(canvas: Canvas, box: Box, pattern: FlatPattern, room: Room, worst_v: float | None = None) -> None:
    """Draw the pattern with rulings, marks, edges, joints and dimensions."""
    fit = room.fit(box)
    contours_drawn = (pattern.outer, *pattern.inner)
    lines = [fit.place(closed_polygon(contour.path, fit)) for contour in contours_drawn]
    canvas.areas([compound(lines)], PART_FILL)
    pieces = len(sides(pattern).get("c1", ()))
    if not has_bends(pattern):
        canvas.lines([fit.place(line) for line in rulings(pattern, ruling_places(pieces))], GREY, RULING_WIDTH)
    if worst_v is not None:
        canvas.lines([fit.place(line) for line in rulings(pattern, [worst_v])], PURPLE, WORST_WIDTH)
    draw_marks(canvas, pattern, fit)
    canvas.areas([compound([ring[::-1]]) for ring in lines[1:]], "white")
    _bands(canvas, pattern, fit)
    canvas.lines(lines, INK, 0.8)
    _joints(canvas, [contour for contour in contours_drawn if contour.purpose != "stitch"], fit)
    _overall(canvas, pattern, fit)
    write_edge_names(canvas, pattern, fit)
    _hole_names(canvas, [hole for hole in pattern.inner if hole.purpose != "stitch"], fit)
    _flat_axes(canvas, box, fit)
    scale_bar(canvas, box.right - 0.3, box.bottom + 0.28, fit.scale, min(1.4, box.width / 4.0))
    caption(
        canvas, box, "Flat pattern, seen on its blue side" if pieces else "Flat pattern", _legend(pattern, room.turned)
    )


def _legend(pattern: FlatPattern, turned: bool) -> str:
    count = sum(contour.path.bulges.size for contour in (pattern.outer, *pattern.inner))
    words = [f"cut: {count} lines and arcs"]
    words += marks_legend(pattern)
    if sides(pattern) and not has_bends(pattern):
        words.append("grey: rulings")
    return "   ".join(words + ["shown turned by \u221290\u00b0"] * turned)


def closed_polygon(path: ArcPath, fit: Fit) -> Points2:
    """Return a closed path as points in mm, the first repeated; finer than can be seen."""
    points = arcpath.polygon(path, accuracy=fit.fine_mm)
    return np.vstack([points, points[:1]])


def compound(rings: Sequence[Points2]) -> "Path":
    """Return one area from closed rings; those that run clockwise are holes."""
    from matplotlib.path import Path

    codes = [np.full(len(ring), Path.LINETO, dtype=np.uint8) for ring in rings]
    for code in codes:
        code[0], code[-1] = Path.MOVETO, Path.CLOSEPOLY
    return Path(np.concatenate(rings), np.concatenate(codes))


def _bands(canvas: Canvas, pattern: FlatPattern, fit: Fit) -> None:
    """Draw the four edges of a strip in their colours, under the line that is cut."""
    t = np.linspace(0.0, 1.0, SAMPLES)
    for name, edges in sides(pattern).items():
        canvas.lines([fit.place(edge.at(t)) for edge in edges], COLOURS[name], EDGE_WIDTH + 1.2)


def _joints(canvas: Canvas, drawn: Sequence[Contour], fit: Fit) -> None:
    points = np.concatenate([contour.path.vertices for contour in drawn])
    if len(points) <= MANY_JOINTS:
        canvas.dots(fit.place(points))


def _hole_names(canvas: Canvas, holes: Sequence[Contour], fit: Fit) -> None:
    """Write the size of each hole into it if there is room, else beside it."""
    for hole in holes[:MANY_HOLES]:
        low_x, low_y, high_x, high_y = arcpath.bounds(hole.path)
        corners = fit.place(np.array([[low_x, low_y], [high_x, high_y]]))
        width = float(np.abs(corners[1] - corners[0])[0])
        words = hole_text(hole.path)
        room = ROOM_PER_SIGN * len(words)
        drop = 0.0 if width > room else float(np.abs(corners[1] - corners[0])[1]) / 2.0 + 0.1
        canvas.text(corners.mean(axis=0) - np.array([0.0, drop]), words, 7.5, on_white=drop > 0.0)


def _overall(canvas: Canvas, pattern: FlatPattern, fit: Fit) -> None:
    """Draw overall width and height, below and to the left."""
    corners = corner_points(pattern)
    wide, high = (corners[1] - corners[0]).tolist()
    names = (("height", high), ("width", wide)) if fit.turned else (("width", wide), ("height", high))
    placed = fit.place(corners)
    low, top = placed.min(axis=0), placed.max(axis=0)
    across, upward = (f"{name} {length_text(mm)} mm" for name, mm in names)
    short = float(top[1] - low[1]) < LONG_ENOUGH
    y = float(low[1]) - DIMENSION_GAP
    dimension(canvas, np.array([low[0], y]), np.array([top[0], y]), np.array([0.0, DIMENSION_GAP]), across)
    gap = BESIDE_GAP if short else DIMENSION_GAP
    x = float(low[0]) - gap
    dimension(canvas, np.array([x, low[1]]), np.array([x, top[1]]), np.array([gap, 0.0]), upward)


def dimension(canvas: Canvas, start: Vector2, end: Vector2, part: Vector2, words: str) -> None:
    """Draw a dimension from start to end with its text; `part` leads from it to what is measured, inches."""
    back = -0.06 * unit(part)
    canvas.lines([np.stack([end_ + back, end_ + part - back]) for end_ in (start, end)], PALE, 0.6)
    length = float(norm(end - start))
    along = unit(end - start)
    middle = (start + end) / 2.0
    if length > 4.0 * HEAD:
        arrow(canvas, middle, end, 0.6)
        arrow(canvas, middle, start, 0.6)
    else:
        arrow(canvas, end + 0.2 * along, end, 0.6)
        arrow(canvas, start - 0.2 * along, start, 0.6)
    if length > LONG_ENOUGH:
        canvas.text(middle, words, 9.0, angle_deg=upright(np.degrees(np.arctan2(along[1], along[0]))), on_white=True)
    elif abs(along[0]) > abs(along[1]):
        canvas.text(middle - np.array([0.0, 0.1]), words, 9.0, align=("center", "top"))
    else:
        canvas.text(middle - np.array([0.1, 0.0]), words, 9.0, align=("right", "center"))


def _flat_axes(canvas: Canvas, box: Box, fit: Fit) -> None:
    """Draw x and y of the flat frame."""
    origin = np.array([box.left + 0.35, box.bottom + (0.55 if fit.turned else 0.2)])
    for name, axis in (("x", np.array([1.0, 0.0])), ("y", np.array([0.0, 1.0]))):
        shown = fit.turn(axis)
        arrow(canvas, origin, origin + 0.36 * shown)
        canvas.text(origin + 0.46 * shown, name, 8.5)
