"""Names and lengths beside the edges of a flat pattern.

Outside the middle of the edge and along it; inside where the edge is so hollow that the name would be far from it, or
where another name stands already.  Beside short edges the name is upright.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.report.pictures.canvas import Canvas, Fit, HAlign, VAlign, length_text
from pipeline.report.pictures.edges import corner_points, side_length, sides
from pipeline.report.pictures.surface import COLOURS
from stages.geometry.arrays import Points2, Vector2, norm, unit
from stages.geometry.curves.plane import PlaneCurve
from stages.model.pattern import FlatPattern

LONG_ENOUGH = 1.15
"""Inches that a line of dimension text takes: shorter edges have it beside them, upright."""

ROOM_PER_SIGN = 0.068
"""Inches that one sign of 7.5 point type takes."""

HALF_SIGN = 0.04
"""Half of what one sign of 9 point type takes, inches."""

TEXT_HEIGHT = 0.14
"""Of 9 point type, inches."""

LABEL_GAP, MOST_BULGE = 0.16, 0.3
"""From an edge to the middle of its name, and how far a hollow edge may push it away, inches."""

SPREAD = np.linspace(0.0, 1.0, 65)
ALONG_TEXT = np.linspace(-1.0, 1.0, 9)[:, None]

NO_LENGTH = 1e-9
"""An edge shorter than this share of the pattern is a point."""


@dataclass(frozen=True, slots=True)
class Name:
    """Words where they would stand: the middle of the line of type, along which it runs, and its alignment."""

    words: str
    at: Vector2
    along: Vector2
    align: tuple[HAlign, VAlign] = ("center", "center")

    @property
    def points(self) -> Points2:
        """Return points along the line of type, inches."""
        half = HALF_SIGN * len(self.words)
        shift = {"left": half, "center": 0.0, "right": -half}[self.align[0]]
        line: Points2 = self.at + (shift + half * ALONG_TEXT) * self.along
        return line


def write_edge_names(canvas: Canvas, pattern: FlatPattern, fit: Fit) -> None:
    """Write name and length of each edge of a strip; an edge of no length is an apex."""
    size = float(norm(np.diff(corner_points(pattern), axis=0)[0]))
    written: list[Points2] = []
    for name, edges in sides(pattern).items():
        mm = side_length(edges)
        chosen = first_free(
            _apex(pattern, fit, name, edges) if mm <= size * NO_LENGTH else _edge(fit, name, edges, mm), written
        )
        written.append(chosen.points)
        angle = upright(float(np.degrees(np.arctan2(chosen.along[1], chosen.along[0]))))
        canvas.text(
            chosen.at, chosen.words, 9.0, COLOURS[name], chosen.align, angle_deg=angle, bold=True, on_white=True
        )


def first_free(places: Sequence[Name], written: Sequence[Points2]) -> Name:
    """Return the first place that meets no other name, or the first of all."""
    free = (
        place
        for place in places
        if all(norm(place.points[:, None] - other[None]).min() > TEXT_HEIGHT for other in written)
    )
    return next(free, places[0])


def _edge(fit: Fit, name: str, edges: Sequence[PlaneCurve], mm: float) -> list[Name]:
    """Return where the name of an edge may stand, best first."""
    words = f"{name}  {length_text(mm)} mm"
    middle = edges[len(edges) // 2]
    t = np.array([0.5 if len(edges) % 2 else 0.0])
    place, along = fit.place(middle.at(t))[0], fit.turn(unit(middle.derivative(t))[0])
    outward = np.array([along[1], -along[0]])
    if mm * fit.scale < LONG_ENOUGH:
        return [_beside(place, way, words, half_edge=mm * fit.scale / 2.0) for way in (outward, -outward)]
    offsets = fit.place(middle.at(SPREAD)) - place
    found = []
    for way in (outward, -outward):
        bulge = _bulge(offsets, along, way, words)
        found.append((bulge > MOST_BULGE, Name(words, place + (LABEL_GAP + bulge) * way, along)))
    return [one for _, one in sorted(found, key=lambda pair: pair[0])]


def _apex(pattern: FlatPattern, fit: Fit, name: str, edges: Sequence[PlaneCurve]) -> list[Name]:
    apex = edges[len(edges) // 2].at(np.array([0.5]))[0]
    return [_beside(fit.place(apex), fit.turn(_clear_of(pattern, apex)), f"{name}: apex")]


def _clear_of(pattern: FlatPattern, apex: Vector2) -> Vector2:
    """Return a direction in which there is room for the name of an apex: outward, or inward from a blunt one."""
    first, last = (unit(corner - apex) for corner in _far_corners(pattern, apex))
    inward = np.mean(corner_points(pattern), axis=0) - apex
    return unit(inward if first @ last < BLUNT else -inward)


def _far_corners(pattern: FlatPattern, apex: Vector2) -> Points2:
    order = np.argsort(norm(pattern.corners - apex))
    return pattern.corners[np.sort(order[-2:])]


BLUNT = -0.5
"""Cosine of the angle at an apex beyond which the names of start and end take the room outside."""


def _beside(place: Vector2, outward: Vector2, words: str, half_edge: float = 0.0) -> Name:
    """Return upright words next to the middle of a short edge, clear of the edge where it leans."""
    x, y = outward
    level = abs(x) <= abs(y) / 2.0
    align: tuple[HAlign, VAlign] = ("center", "bottom" if y > 0.0 else "top")
    if not level:
        align = ("left" if x > 0.0 else "right", "center")
    reach = HALF_SIGN * len(words) if level else TEXT_HEIGHT / 2.0
    along, across = (abs(y), abs(x)) if level else (abs(x), abs(y))
    lean = across / along * min(reach, half_edge * along)
    off = np.array([0.0, np.copysign(lean, y)]) if level else np.array([np.copysign(lean, x), 0.0])
    return Name(words, place + 0.1 * outward + off, np.array([1.0, 0.0]), align)


def _bulge(offsets: Points2, along: Vector2, way: Vector2, words: str) -> float:
    """Return how far a hollow edge rises above its tangent along a text, inches."""
    beside = np.abs(offsets @ along) <= HALF_SIGN * len(words)
    return float((offsets[beside] @ way).max(initial=0.0))


HALF_TURN, QUARTER_TURN = 180.0, 90.0


def upright(angle_deg: float) -> float:
    """Return the angle, turned by half a turn where text would stand on its head, in (-90, 90] degrees."""
    turned = QUARTER_TURN - (QUARTER_TURN - angle_deg) % HALF_TURN
    return round(turned, 6)
