"""Whether a pattern can be cut: its holes inside the outline, clear of each other, wide enough, and no web too narrow.

Distances are exact, between the lines and arcs that will be cut (`geometry.paths.clearance`); webs are those between
two contours and of a contour with itself, told with the places on both sides (`geometry.paths.bridges`).  The width of
a hole is the diameter of the largest circle in it: exact for a circle, within a hundredth of the chord for any other.
Where contours are to be offset for the kerf, one that is narrower than it somewhere refuses the part.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Mask
from stages.geometry.curves.contours import area_and_centroid
from stages.geometry.curves.plane import CircularArc
from stages.geometry.paths import arcpath, bridges, clearance, enclosed
from stages.geometry.paths.beside import ROUND
from stages.geometry.paths.bridges import Bridge
from stages.geometry.paths.clearance import Pieces
from stages.geometry.paths.compensation import TooNarrow, compensated
from stages.geometry.paths.cover import doubled
from stages.model.pattern import Contour
from stages.model.process import Process
from stages.model.report import Evidence, Finding, Metric, Where
from stages.unroll.tipping import tipping

FIRST_LOOK_MM = 1.0
"""The narrowest web is sought within this distance first, then within twice that, and so on."""

WIDTH_SHARE = 0.01
"""How well the width of a hole that is no circle is known, as a share of the chord."""

ROUNDING = 1e-9
"""A width or web that falls short of its least value by this share is that value."""

Paths = list[Pieces]


@dataclass(frozen=True, slots=True)
class Judgement:
    """What is to be said of the holes of a pattern."""

    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()


def judged(outer: Contour, holes: Sequence[Contour], process: Process) -> Judgement:
    """Return the narrowest hole and web, and what forbids or endangers cutting them."""
    paths = [clearance.pieces(contour.path) for contour in (outer, *holes)]
    misplaced = tuple(_not_simple(holes)) or tuple(_crossings(paths, holes)) or tuple(_not_inside(paths, holes))
    if misplaced:
        return Judgement((), misplaced)
    close = [] if process.min_web_mm is None else _close(outer, holes, process.min_web_mm)
    found = (
        *_small(holes, process),
        *(_narrow(bridge, holes, process) for bridge in close),
        *_too_narrow(outer, holes, process),
        *tipping(outer, process),
    )
    return Judgement(_metrics(paths, outer, holes, close), found)


def _metrics(paths: Paths, outer: Contour, holes: Sequence[Contour], close: Sequence[Bridge]) -> tuple[Metric, ...]:
    """Return the narrowest hole, if there is one, and web: of an outline with itself if that was found too narrow."""
    webs = [_narrowest_web(paths, outer, holes)] if holes else []
    least = min(close, key=lambda bridge: bridge.width_mm, default=None)
    if least is not None and not (webs and isinstance(webs[0].value, float) and webs[0].value <= least.width_mm):
        webs = [Metric("min_web_mm", least.width_mm, "mm", "proved", where=_places(least, holes))]
    return (*((_narrowest(holes),) if holes else ()), *webs)


def _not_simple(holes: Sequence[Contour]) -> Iterator[Finding]:
    """Yield the holes that cross themselves."""
    for hole in (hole for hole in holes if not _is_circle(hole)):
        covered = doubled(hole.path)
        if covered > hole.chord_mm**2:
            message = f"{hole.name} crosses itself: {covered:.4g} mm2 lie inside it twice or inside out"
            yield Finding("contour-crosses-itself", message, fatal=True, where=_where(hole))


def _crossings(paths: Paths, holes: Sequence[Contour]) -> Iterator[Finding]:
    """Yield the holes that meet the outline or each other."""
    for one, other in _within(paths, 0.0):
        hole = holes[other - 1]
        if one == 0:
            yield Finding("hole-outside", f"{hole.name} crosses the edge of the part", fatal=True, where=_where(hole))
        else:
            message = f"{holes[one - 1].name} and {hole.name} overlap"
            yield Finding("holes-cross", message, fatal=True, where=_where(hole))


def _not_inside(paths: Paths, holes: Sequence[Contour]) -> Iterator[Finding]:
    """Yield the holes beside the part, and those within another hole."""
    boxes = np.array([arcpath.bounds(hole.path) for hole in holes])
    for i, hole in enumerate(holes, 1):
        if not _holds(paths[0], hole):
            yield Finding("hole-outside", f"{hole.name} is not inside the outline", fatal=True, where=_where(hole))
        for j in _around(boxes, i - 1):
            if _holds(paths[j + 1], hole):
                message = f"{hole.name} lies inside {holes[j].name}: what is left of that falls out"
                yield Finding("hole-nested", message, fatal=True, where=_where(hole))


def _around(boxes: Array, i: int) -> list[int]:
    """Return the other boxes (x and y least, x and y most) that hold a box."""
    held = (boxes[:, :2] < boxes[i, :2]).all(axis=1) & (boxes[:, 2:] > boxes[i, 2:]).all(axis=1)
    return [int(j) for j in np.flatnonzero(held)]


def _holds(around: Pieces, hole: Contour) -> bool:
    """Return whether a contour that crosses nothing is inside, by most of its points: some might lie on a chord."""
    count = arcpath.piece_count(hole.path)
    piece, share = np.repeat(np.arange(count), len(SOMEWHERE)), np.tile(SOMEWHERE, count)
    held: Mask = enclosed.inside(arcpath.along(hole.path, piece, share), around)
    return bool(2 * np.count_nonzero(held) > held.size)


SOMEWHERE = (0.1464, 0.4142, 0.6180)
"""Shares of a piece: not its ends nor its middle, where a symmetrical neighbour might have its chords."""


def _within(paths: Paths, reach_mm: float) -> dict[tuple[int, int], float]:
    """Return the distances, mm, of the contours that come within reach of each other; 0 is the outline."""
    owner = np.repeat(np.arange(len(paths)), [path.bulge.size for path in paths])
    return clearance.clearances(clearance.joined(paths), owner, within=reach_mm)


def _narrowest_web(paths: Paths, outer: Contour, holes: Sequence[Contour]) -> Metric:
    """Return the least distance between two contours."""
    low_x, low_y, high_x, high_y = arcpath.bounds(outer.path)
    reach, most = FIRST_LOOK_MM, high_x - low_x + high_y - low_y
    while not (found := _within(paths, reach)) and reach < most:
        reach *= 2.0
    (one, other), distance = min(found.items(), key=lambda item: item[1])
    return Metric("min_web_mm", distance, "mm", "proved", where=_where(holes[other - 1]) | {"to": _name(holes, one)})


def _close(outer: Contour, holes: Sequence[Contour], least: float) -> list[Bridge]:
    """Return the webs that are narrower than the process can leave."""
    found = bridges.webs([contour.path for contour in (outer, *holes)], within=least)
    return [bridge for bridge in found if bridge.width_mm < least * (1.0 - ROUNDING)]


def _narrow(bridge: Bridge, holes: Sequence[Contour], process: Process) -> Finding:
    """Return the finding on a web that is too narrow."""
    one, other = (_name(holes, number) for number in (bridge.second, bridge.first))
    between = f"between {one} and {'itself' if one == other else other}"
    message = f"{bridge.width_mm:.4g} mm {between}, the process wants {process.min_web_mm:.4g} mm"
    return Finding("narrow-web", message, process.refuses_narrow, _places(bridge, holes))


def _places(bridge: Bridge, holes: Sequence[Contour]) -> Where:
    """Return the places on both sides of a web: first on the hole, or the outline, then on what it is next to."""
    (x, y), (to_x, to_y) = bridge.to, bridge.at
    names: Where = {"hole": _name(holes, bridge.second), "to": _name(holes, bridge.first)}
    return names | {"x": x, "y": y, "to_x": to_x, "to_y": to_y}


def _too_narrow(outer: Contour, holes: Sequence[Contour], process: Process) -> Iterator[Finding]:
    """Yield the contours that the beam does not fit into, where its way is to be written."""
    if not (process.compensated and process.kerf_mm):
        return
    for number, contour in enumerate((outer, *holes)):
        way = compensated(contour.path, process.kerf_mm / 2.0, ROUND)
        if isinstance(way, TooNarrow):
            x, y = way.at.tolist()
            message = (
                f"{_name(holes, number)} is narrower than the kerf of {process.kerf_mm:.4g} mm at ({x:.6g}, {y:.6g})"
            )
            remedy = "widen it, take a finer cut, or leave process.kerf_compensation out"
            yield Finding("narrower-than-kerf", f"{message}: {remedy}", fatal=True, where={"x": x, "y": y})


def _name(holes: Sequence[Contour], number: int) -> str:
    return "the outline" if number == 0 else holes[number - 1].name


def _narrowest(holes: Sequence[Contour]) -> Metric:
    """Return the width of the narrowest hole."""
    widths = [(*_width(hole), hole) for hole in holes]
    width, evidence, hole = min(widths, key=lambda item: item[0])
    return Metric("min_hole_mm", width, "mm", evidence, where=_where(hole))


def _small(holes: Sequence[Contour], process: Process) -> Iterator[Finding]:
    """Yield the holes that are narrower than the process can cut."""
    least = process.min_hole_mm or 0.0
    for hole in holes:
        width, _ = _width(hole)
        if width < least * (1.0 - ROUNDING):
            message = f"{hole.name} is {width:.4g} mm wide, the process wants {least:.4g} mm"
            yield Finding("small-hole", message, process.refuses_narrow, _where(hole))


def _width(hole: Contour) -> tuple[float, Evidence]:
    """Return the diameter of the largest circle in a hole, mm."""
    import shapely

    first = hole.edges[0]
    if _is_circle(hole) and isinstance(first, CircularArc):
        return 2.0 * first.radius, "proved"
    accuracy = WIDTH_SHARE * hole.chord_mm
    region = shapely.Polygon(arcpath.polygon(hole.path, accuracy=accuracy))
    return 2.0 * float(shapely.maximum_inscribed_circle(region, tolerance=accuracy).length), "sampled"


def _is_circle(hole: Contour) -> bool:
    return len(hole.edges) == 1 and isinstance(hole.edges[0], CircularArc)


def _where(hole: Contour) -> Where:
    """Return where a hole is, in the flat."""
    _, x, y = area_and_centroid(hole.edges)
    return {"hole": hole.name, "x": x, "y": y}
