"""How far written drawings are from the exact development, without the program's own reader and its own distances.

A drawing is read by ezdxf, entity by entity: nothing is put together to contours again, no bulge is reckoned here.  Its
lines and arcs, and the exact edges, become polygons whose corners are on them; the distance of every corner to the
nearest segment of the other polygon is found by shapely, in both directions.  A polygon of arcs is off them by at most
`HEIGHT` of the tolerance, so the true distance is at most `HEIGHTS` of that larger than the one found, to second order
of the spacing.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from io import StringIO
from typing import NamedTuple

import ezdxf
import numpy as np
from ezdxf.entities.arc import Arc
from ezdxf.entities.circle import Circle
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.entities.insert import Insert
from ezdxf.entities.line import Line
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.entities.polyline import Polyline
from shapely import LineString, STRtree, points

from stages.geometry.arrays import Array, Points2, Vector2
from stages.geometry.curves.plane import PlaneCurve
from stages.model.cutfile import Layer
from stages.model.pattern import FlatPattern

HEIGHT = 0.005
"""Of an arc over its chord, as a share of the tolerance."""

HEIGHTS = 3.0
"""Between two corners of a polygon the distance rises by no more than so many of them: that of either, and of both."""

STEPS = 24
"""Into which every straight line is cut: along it the distance to another curve changes too."""

FIRST, MOST = 64, 1 << 17
"""Chords of an edge that are tried, doubled until they are near enough."""

FOLLOWED = ("CUT_OUTER", "CUT_INNER")


class Apart(NamedTuple):
    """How far a drawing and the development are apart at most, mm, and what is allowed."""

    part: str
    distance_mm: float
    tolerance_mm: float


def furthest(found: Iterable[Apart]) -> Apart:
    """Return the one that uses up most of its tolerance."""
    return max(found, key=lambda one: one.distance_mm / one.tolerance_mm)


def apart(text: str, layers: Mapping[str, Layer], pattern: FlatPattern) -> Apart:
    """Return how far the drawing of a pattern is from its exact edges, outer contour and inner ones apart."""
    tolerance = pattern.outer.chord_mm
    drawn = drawn_lines(text, layers, HEIGHT * tolerance)
    exact = ((pattern.outer,), pattern.inner)
    distances = [
        two_sided(drawn[layer], [exact_line(edge, HEIGHT * tolerance) for one in contours for edge in one.edges])
        for layer, contours in zip(FOLLOWED, exact, strict=True)
    ]
    return Apart(pattern.part, max(distances) + HEIGHTS * HEIGHT * tolerance, tolerance)


def two_sided(one: Sequence[Points2], other: Sequence[Points2]) -> float:
    """Return the larger of both distances, mm; infinite where only one is there."""
    if not one or not other:
        return 0.0 if bool(one) == bool(other) else float("inf")
    return max(_one_sided(one, other), _one_sided(other, one))


def _one_sided(one: Sequence[Points2], other: Sequence[Points2]) -> float:
    """Return how far from the other lines a corner of the ones is at most."""
    chords = [LineString(line[k : k + 2]) for line in other for k in range(len(line) - 1)]
    _, distance = STRtree(chords).query_nearest(points(np.concatenate(one)), return_distance=True, all_matches=False)
    return float(distance.max())


def exact_line(edge: PlaneCurve, height: float) -> Points2:
    """Return points of an edge whose polygon is within a height of it where that is asked half-way."""
    count = FIRST
    while True:
        line = edge.at(np.linspace(0.0, 1.0, 2 * count + 1))
        ends, middles = line[::2], line[1::2]
        rise = np.abs(_offset(middles, ends[:-1], ends[1:]))
        if rise.max() <= height or count > MOST:
            return line
        count *= 2


def _offset(places: Points2, start: Points2, end: Points2) -> Array:
    """Return how far places are from the chords between the points before and after them."""
    chord = end - start
    along = np.hypot(chord[:, 0], chord[:, 1])
    away = places - start
    across: Array = (chord[:, 0] * away[:, 1] - chord[:, 1] * away[:, 0]) / np.where(along > 0.0, along, np.inf)
    return across


def drawn_lines(text: str, layers: Mapping[str, Layer], height: float) -> dict[str, list[Points2]]:
    """Return the lines of a drawing by the meaning of their layers, those of arcs within a height of them."""
    names = {(layers[meaning].name, layers[meaning].colour): meaning for meaning in FOLLOWED}
    lines: dict[str, list[Points2]] = {meaning: [] for meaning in FOLLOWED}
    for entity in _entities(ezdxf.read(StringIO(text)).modelspace()):
        meaning = names.get((entity.dxf.layer, entity.dxf.color))
        if meaning is not None:
            lines[meaning] += _line(entity, height)
    return lines


def box(text: str, height: float) -> tuple[Vector2, Vector2]:
    """Return the least and the largest x and y of what is drawn, up to a height of arcs; texts are not looked at."""
    lines = [line for entity in _entities(ezdxf.read(StringIO(text)).modelspace()) for line in _line(entity, height)]
    every = np.concatenate(lines)
    return every.min(axis=0), every.max(axis=0)


def _entities(space: Iterable[DXFGraphic]) -> Iterator[DXFGraphic]:
    """Yield lines, arcs and circles: those of blocks and polylines too."""
    for entity in space:
        if isinstance(entity, Insert | LWPolyline | Polyline):
            yield from _entities(entity.virtual_entities())
        else:
            yield entity


def _line(entity: DXFGraphic, height: float) -> Iterator[Points2]:
    """Yield points of what is drawn by a line, an arc or a circle, nothing for texts and points."""
    if isinstance(entity, Line):
        ends = np.array([(place.x, place.y) for place in (entity.dxf.start, entity.dxf.end)])
        yield ends[0] + np.linspace(0.0, 1.0, STEPS + 1)[:, None] * (ends[1] - ends[0])
    elif isinstance(entity, Arc | Circle):
        yield np.array([(place.x, place.y) for place in entity.flattening(height)])
