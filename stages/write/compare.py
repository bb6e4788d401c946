"""A file as read back against what should be in it.

Against the drawing that was written: the same layers in the same order, each path with the same length and area.
Against the exact development (files in `flat/`): two-sided distance, and the relative errors of length and area.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import dist, fsum, inf

import numpy as np

from stages.errors import NoSolutionError
from stages.geometry.arrays import norm
from stages.geometry.flat.sampling import Resolved, length_and_area, resolved
from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import ArcPath, area, backwards, bounds, length
from stages.geometry.paths.biarc import LEAST_PIECE_MM
from stages.geometry.paths.hausdorff import hausdorff
from stages.geometry.paths.outside import beyond
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding, Metric
from stages.write.alike import Pair, are_alike
from stages.write.chains import JOINT_MM, Entity
from stages.write.closing import MEET_MM, Closed, is_shared
from stages.write.drawing import Drawing, Item, Label
from stages.write.readback import ReadFile

ROUND_TRIP = 1e-9
"""Relative: what ten decimals of a mm leave of lengths and areas."""

ROUND_TRIP_MM = 1e-8
"""Absolute, for contours so small that ten decimals are more than that."""

GRID_SHARE = 0.01
"""How well the grid under an exact edge must know it, as a share of the contour's chord."""

QUADRATURE = 1e-9
CLOSURE_MM = 0.01
"""The gap at which a controller takes a contour for open."""

INSIDE_MM = JOINT_MM
"""What the ends of arcs of a file may be off by rounding is no matter of the side."""

SINGLE_PIECES = frozenset({"CHAIN", "ARC"})
"""Paths whose ends were computed from centres and angles."""

SHORTER = 1.0 - 1e-6


@dataclass(frozen=True, slots=True)
class ContourFigures:
    """How one contour of a file compares with its exact edges; lengths in mm, errors relative.

    inside_mm: how far it lies inside them, if it must not.
    """

    part: str
    contour: int
    deviation_mm: float
    chord_mm: float
    closure_mm: float
    length_error: float
    area_error: float
    inside_mm: float | None = None


@dataclass(frozen=True, slots=True)
class Comparison:
    """One file against its drawing and the exact development; `shortest_mm`: no piece may be shorter."""

    contours: tuple[ContourFigures, ...]
    findings: tuple[Finding, ...]
    shortest_mm: float


def compared(
    back: ReadFile, drawing: Drawing, patterns: Mapping[str, FlatPattern], closed: Closed | None = None
) -> Comparison:
    """Return the comparison of one file; with exact edges for the parts in `patterns`.

    closed: the outlines that share cuts, put together again from the file.
    """
    drawn = [item.path for item in drawing.items if item.contour is not None]
    shortest = float(manypaths.shortest(drawn).min(initial=inf))
    paths = [entity for entity in back.entities if entity.kind != "TEXT"]
    findings = tuple(
        Finding("readback-content", f"{drawing.path}: {text}", fatal=True, where={"file": drawing.path})
        for text in (
            *_differences(paths, drawing.items),
            *_unlike_labels(back, drawing.labels),
            *_unlike_outlines(closed or Closed((), ()), drawing.divided),
        )
    )
    figures = () if findings else tuple(_figures(paths, drawing.items, patterns))
    if shortest < LEAST_PIECE_MM:
        text = f"a piece of {shortest:.3g} mm; controllers want {LEAST_PIECE_MM} mm"
        findings += (Finding("short-piece", text, where={"file": drawing.path}),)
    return Comparison(figures, findings, min(shortest * SHORTER, LEAST_PIECE_MM))


def metrics(comparisons: Sequence[Comparison], entities: int) -> tuple[Metric, ...]:
    """Return the metrics of the stage, the worst contour of all files; None where no contour could be compared."""
    contours = [contour for comparison in comparisons for contour in comparison.contours]
    if not contours:
        names = ("max_deviation_mm", "closure_gap_mm", "area_error", "length_error")
        return (*(Metric(name, None) for name in names), Metric("entities", float(entities), evidence="proved"))
    furthest = max(contours, key=lambda contour: contour.deviation_mm / contour.chord_mm)
    gap = max(contours, key=lambda contour: contour.closure_mm)
    by_area = max(contours, key=lambda contour: contour.area_error)
    by_length = max(contours, key=lambda contour: contour.length_error)
    return (
        Metric("max_deviation_mm", furthest.deviation_mm, "mm", limit=furthest.chord_mm, where=_where(furthest)),
        Metric("closure_gap_mm", gap.closure_mm, "mm", "proved", CLOSURE_MM, _where(gap)),
        Metric("area_error", by_area.area_error, where=_where(by_area)),
        Metric("length_error", by_length.length_error, where=_where(by_length)),
        *_grown(contours),
        Metric("entities", float(entities), evidence="proved"),
    )


def _grown(contours: Sequence[ContourFigures]) -> tuple[Metric, ...]:
    """Return how far contours that must not lie inside the exact ones do so; nothing if all may."""
    held = [(contour.inside_mm, contour) for contour in contours if contour.inside_mm is not None]
    if not held:
        return ()
    furthest, contour = max(held, key=lambda pair: pair[0])
    return (Metric("inside_mm", furthest, "mm", limit=INSIDE_MM, where=_where(contour)),)


def common_lines(back: ReadFile, closed: Closed, path: str) -> Iterator[Finding]:
    """Yield, if outlines share cuts, how many common lines there are and what they save, from the file alone."""
    lines = [entity.path for entity in back.entities if is_shared(entity) and entity.kind == "LINE" and entity.path]
    if not lines:
        return
    cut = fsum(length(entity.path) for entity in back.entities if is_shared(entity) and entity.path)
    saved = fsum(length(outline.path) for outline in closed.outlines) - cut
    long = fsum(map(length, lines))
    text = f"{len(lines)} common lines of {long:.6g} mm in all serve two parts each and save {saved:.6g} mm of cut"
    remark = "they are the way of the beam: no kerf is added to them"
    where: dict[str, float | int | str] = {"file": path, "lines": len(lines), "length_mm": long, "saved_mm": saved}
    yield Finding("common-lines", f"{path}: {text}; {remark}", where=where)


def _where(contour: ContourFigures) -> dict[str, float | int | str]:
    """Return the place of a figure."""
    return {"part": contour.part, "contour": contour.contour}


def _differences(paths: Sequence[Entity], items: Sequence[Item]) -> Iterator[str]:
    """Yield where the file does not hold what was drawn."""
    layers, wanted = [entity.layer for entity in paths], [item.layer for item in items]
    if layers != wanted:
        yield f"holds {len(layers)} paths on other layers or in another order than the {len(wanted)} drawn"
        return
    pairs = [(entity.path or item.path, item.path) for entity, item in zip(paths, items, strict=True)]
    alike = are_alike(pairs, np.array([_near_mm(entity) for entity in paths])).tolist()
    sizes = iter(_sizes([pair for pair, is_alike in zip(pairs, alike, strict=True) if not is_alike]))
    for entity, (found, drawn), is_alike in zip(paths, pairs, alike, strict=True):
        both = None if is_alike else next(sizes)
        if entity.path is None or found.closed != drawn.closed:
            yield f"{entity.kind} on {entity.layer} is not the path that was drawn"
        elif both is not None:
            yield from _unlike_sizes(entity, both, drawn)


def _near_mm(entity: Entity) -> float:
    """Return how far a place may be off by rounding, mm."""
    return ROUND_TRIP_MM if entity.kind not in SINGLE_PIECES else JOINT_MM


def _unlike_outlines(closed: Closed, drawn: Sequence[ArcPath]) -> Iterator[str]:
    """Yield the outlines that share cuts and are not, put together from the file, what was to be divided."""
    found = [one.path for one in closed.outlines]
    if len(found) != len(drawn):
        yield f"holds {len(found)} outlines that share cuts, drawn were {len(drawn)}"
        return
    if not drawn:
        return
    from scipy.spatial import cKDTree

    near = cKDTree(manypaths.boxes(found)).query_ball_point(manypaths.boxes(drawn), MEET_MM, p=np.inf)
    for path, places in zip(drawn, near, strict=True):
        if not any(_is_same(found[place], path) for place in places):
            yield "an outline in x {:.6g} to {:.6g}, y {:.6g} to {:.6g} is not there with what it shares".format(
                *np.array(bounds(path))[[0, 2, 1, 3]]
            )


def _is_same(found: ArcPath, drawn: ArcPath) -> bool:
    """Return whether closed paths in one box agree, every vertex within what ends that meet may be apart."""
    long = length(drawn)
    return (
        abs(length(found) - long) <= 2.0 * MEET_MM * drawn.bulges.size
        and abs(area(found) - area(drawn)) <= MEET_MM * long
    )


def _unlike_labels(back: ReadFile, labels: Sequence[Label]) -> Iterator[str]:
    """Yield the texts that are not there, not where they were put, or not as high or turned."""
    texts = [entity for entity in back.entities if entity.writing is not None]
    if len(texts) != len(labels):
        yield f"holds {len(texts)} texts, drawn were {len(labels)}"
        return
    for entity, label in zip(texts, labels, strict=True):
        found = entity.writing
        if found is None or (entity.layer, found.text) != (label.layer, label.text):
            yield f"the text {label.text!r} is not there in its place"
            continue
        numbers = (found.x, found.y, found.height_mm, found.angle_deg)
        wanted = (*label.at, label.height_mm, label.angle_deg)
        if max(abs(a - b) for a, b in zip(numbers, wanted, strict=True)) > ROUND_TRIP_MM:
            yield f"the text {label.text!r} is not where, as high or turned as it was drawn"


@dataclass(frozen=True, slots=True)
class Sizes:
    """How far a path lies from where it was drawn, mm; lengths in mm and areas in mm2, as found and as drawn."""

    moved_mm: float
    lengths_mm: tuple[float, float]
    areas_mm2: tuple[float, float]


def _sizes(pairs: Sequence[Pair]) -> list[Sizes]:
    """Return how paths as found compare with what was drawn."""
    both = [[pair[k] for pair in pairs] for k in (0, 1)]
    boxes, long, wide = (
        [figure(some) for some in both] for figure in (manypaths.boxes, manypaths.lengths, manypaths.areas)
    )
    moved = np.abs(boxes[0] - boxes[1]).max(axis=1).tolist()
    rows = zip(moved, *(one.tolist() for one in (*long, *wide)), strict=True)
    return [Sizes(off, (found, drawn), (held, asked)) for off, found, drawn, held, asked in rows]


def _unlike_sizes(entity: Entity, both: Sizes, drawn: ArcPath) -> Iterator[str]:
    """Yield a place, a length or an area that did not survive; a circle's direction does not."""
    near, (found, long), (held, wide) = _near_mm(entity), both.lengths_mm, both.areas_mm2
    if both.moved_mm > near:
        yield f"{entity.kind} on {entity.layer} lies {both.moved_mm:.3g} mm from where it was drawn"
    if abs(found - long) > ROUND_TRIP * long + near * entity.count:
        yield f"{entity.kind} on {entity.layer} has the length {found:.9g} mm, drawn were {long:.9g} mm"
    if not drawn.closed:
        return
    wide = abs(wide) if entity.kind == "CIRCLE" else wide
    if abs(held - wide) > ROUND_TRIP * abs(wide) + near * long:
        yield f"{entity.kind} on {entity.layer} has the area {held:.9g} mm2, drawn were {wide:.9g} mm2"


def _figures(
    paths: Sequence[Entity], items: Sequence[Item], patterns: Mapping[str, FlatPattern]
) -> Iterator[ContourFigures]:
    """Yield the figures of the contours whose exact edges are known."""
    for entity, item in zip(paths, items, strict=True):
        pattern = patterns.get(item.part)
        if pattern is None or item.contour is None or entity.path is None:
            continue
        contour = (pattern.outer, *pattern.inner)[item.contour]
        try:
            yield contour_figures(entity.path, entity.gap_mm, contour, item.part, item.contour)
        except NoSolutionError as error:
            error.add_note(f"part {item.part!r}, stage write")
            raise


def contour_figures(path: ArcPath, gap_mm: float, contour: Contour, part: str, number: int) -> ContourFigures:
    """Return how one contour as read compares with its exact edges; gap_mm: the widest between its entities."""
    edges = [resolved(edge, accuracy=GRID_SHARE * contour.chord_mm) for edge in contour.edges]
    deviation = hausdorff(edges, path, accuracy=contour.chord_mm)
    exact_length, exact_area = length_and_area(edges, accuracy=QUADRATURE)
    return ContourFigures(
        part,
        number,
        deviation.bound_mm,
        contour.chord_mm,
        max(_closure(path, edges), gap_mm),
        abs(length(path) - exact_length) / exact_length,
        abs(abs(area(path)) - abs(exact_area)) / abs(exact_area),
        _inside(path, contour, edges) if contour.side == "outside" else None,
    )


def _inside(path: ArcPath, contour: Contour, edges: Sequence[Resolved]) -> float:
    """Return how far the exact edges reach beyond a path, mm; a full circle is read counter-clockwise in any case."""
    turned = backwards(path) if area(path) * area(contour.path) < 0.0 else path
    return beyond(edges, turned, accuracy=contour.chord_mm)


def _closure(path: ArcPath, edges: Sequence[Resolved]) -> float:
    """Return the largest gap, in mm: between the exact edges, and in the path if it does not close."""
    starts = np.array([edge.points[0] for edge in edges])
    ends = np.array([edge.points[-1] for edge in edges])
    gap = float(norm(starts - np.roll(ends, 1, axis=0)).max())
    return gap if path.closed else max(gap, dist(path.vertices[0], path.vertices[-1]))
