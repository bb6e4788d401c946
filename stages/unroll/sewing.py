"""A pattern made ready to be sewn: what is cut lies outside the sew line by the allowances, with notches and holes.

    sewn(pattern, part, known, work, tol) -> Sewn

The outline that was laid flat becomes the sew line, drawn on SEW along every seam that has an allowance; the outer
contour is that outline widened (`geometry.paths.allowance`).  Notches are cut into the widened contour across from
their places on the sew line, and may not be deeper than the allowance there.  Stitch holes lie along the seams.
How far the contour that is cut is from where it belongs is measured at `LOOKS` points of each edge, not proved.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import fsum

import numpy as np

from stages.geometry.arrays import Array, Points2, Vector2
from stages.geometry.curves import contours
from stages.geometry.curves.parallel import normals
from stages.geometry.curves.plane import CircularArc
from stages.geometry.paths import arcpath
from stages.geometry.paths.allowance import Fault, Strip, Widened, widened
from stages.geometry.paths.arcpath import ArcPath, piece_count
from stages.geometry.paths.cover import doubled
from stages.model.features import NotchSpec
from stages.model.material import Part
from stages.model.pattern import Contour, FlatPattern, Mark, Spot
from stages.model.report import Finding, Metric
from stages.model.tolerances import Tolerances
from stages.unroll import outline
from stages.unroll.marks import traced
from stages.unroll.notches import Notch, Notched, cut_into
from stages.unroll.seams import Line, Seams
from stages.unroll.stitches import Stitches, pricked
from stages.unroll.webs import judged

LOOKS = 17
"""Points of each edge, its ends among them: an edge widened wrongly is wrong over more than a sixteenth of it."""
ROUNDING_MM = 1e-9
"""Of a depth and an allowance that were typed alike."""


@dataclass(frozen=True, slots=True)
class SeamNotch:
    """A notch in a seam, at a fraction of its length."""

    name: str
    seam: str
    spec: NotchSpec
    fraction: float


@dataclass(frozen=True, slots=True)
class Work:
    """What is cut along the seams of one part, besides its allowances."""

    notches: tuple[SeamNotch, ...] = ()
    stitches: tuple[Stitches, ...] = ()


Hole = tuple[str, Vector2, float]
"""A round hole by its name, its middle and its area, mm2."""


@dataclass(frozen=True, slots=True)
class Sewn:
    """The pattern that is cut; None where a finding forbids it.

    cut: its figures.  counts: of stitches, by the seam.  holes: name, place and area of each round one.
    """

    pattern: FlatPattern | None
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    cut: dict[str, float] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    holes: tuple[Hole, ...] = ()


def sewn(pattern: FlatPattern, part: Part, known: Seams, work: Work, tol: Tolerances) -> Sewn:
    """Return a pattern with its allowances, notches and stitch holes.

    Raises NoSolutionError where a direction is not resolved or lines and arcs do not keep the chord.
    """
    lines = [known.of_edge(number) for number in range(len(known.outline))]
    allowances = [0.0 if line is None else line.spec.allowance_mm for line in lines]
    wide = widened(known.outline, allowances, accuracy=tol.chord_mm)
    if isinstance(wide, Fault):
        return Sewn(None, findings=(_too_narrow(wide, lines[wide.edge], allowances),))
    bare = outline.contour(wide.edges, tol.chord_mm, pattern.outer.name)
    crossed = _crossing(bare)
    asked = [*_edge_notches(pattern, known, part), *_seam_notches(known, work.notches)]
    notched = _notched(asked, known, wide, bare)
    rows = {row.seam: pricked(known, row, tol.chord_mm) for row in work.stitches}
    findings = (*crossed, *notched.findings)
    if any(finding.fatal for finding in findings):
        return Sewn(None, findings=findings)
    inner = (*pattern.inner, *(hole for row in rows.values() for hole in row.holes))
    slits = [slit for row in rows.values() for slit in row.slits]
    marks = (*pattern.marks, *_sew_lines(known, tol), *notched.lines, *slits)
    said = judged(notched.outer, inner, part.process)
    findings = (*findings, *_beyond(notched.outer, marks, tol), *said.findings)
    metrics = (_allowance_error(known, wide, bare, tol), *said.metrics)
    if any(finding.fatal for finding in findings):
        return Sewn(None, metrics, findings)
    made = pattern.replace(
        outer=notched.outer,
        inner=inner,
        marks=marks,
        label_at=outline.label_place(notched.outer.path, tuple(hole.path for hole in inner), tol.chord_mm),
        notches=notched.places,
        boundary=bare if notched.outer is not bare else None,
    )
    counts = {seam: len(row.holes) + len(row.slits) for seam, row in rows.items()}
    round_ones = tuple(_hole(hole) for row in rows.values() for hole in row.holes)
    return Sewn(made, metrics, findings, _figures(made, round_ones), counts, round_ones)


def _hole(hole: Contour) -> Hole:
    """Return name, middle and area of a round hole, in closed form: there are many of them."""
    (circle,) = hole.edges
    if not isinstance(circle, CircularArc):
        raise ValueError(f"the stitch hole {hole.name} is not round")
    return hole.name, circle.centre, np.pi * circle.radius**2


def _too_narrow(fault: Fault, line: Line | None, allowances: Sequence[float]) -> Finding:
    """Say where an outline has no room for its allowance, and what would do."""
    x, y = fault.at
    name = "the outline" if line is None else line.spec.called
    wide = max(allowances) if line is None else line.spec.allowance_mm
    if fault.radius_mm is not None:
        message = f"{name} is hollow at ({x:.5g}, {y:.5g}) with a radius of {fault.radius_mm:.4g} mm: an allowance of "
        message += f"{wide:g} mm turns back on itself there; give less than that radius, or a seam of its own"
    else:
        message = f"at ({x:.5g}, {y:.5g}) {name} is too narrow for an allowance of {wide:g} mm: it is filled up; "
        message += "give less there with a seam of its own, or none (kind = 'cut')"
    where: dict[str, float | int | str] = {"seam": name, "x": float(x), "y": float(y), "allowance_mm": wide}
    return Finding("allowance-too-wide", message, fatal=True, where=where)


def _crossing(bare: Contour) -> tuple[Finding, ...]:
    """Say that allowances from far sides of the outline meet, and where."""
    covered = doubled(bare.path)
    if covered <= bare.chord_mm**2:
        return ()
    x, y = _crossing_place(bare)
    message = f"with its allowances the outline crosses itself at ({x:.5g}, {y:.5g}): {covered:.4g} mm2 are covered "
    message += "twice or inside out; give less allowance on both sides of that place"
    return (Finding("contour-crosses-itself", message, fatal=True, where={"x": x, "y": y}),)


def _crossing_place(bare: Contour) -> tuple[float, float]:
    """Return the middle of what a contour covers twice, or a point of it where polygons do not show that."""
    import shapely

    ring = shapely.LinearRing(arcpath.polygon(bare.path, accuracy=bare.chord_mm))
    simple = shapely.get_parts(shapely.node(ring))
    met: Array = np.array([line.coords[0] for line in simple]) if len(simple) > 1 else bare.path.vertices
    return float(met[-1, 0]), float(met[-1, 1])


Asked = tuple[str, NotchSpec, Spot]
"""A notch by its name, and its spot on the divided outline."""


def _edge_notches(pattern: FlatPattern, known: Seams, part: Part) -> Iterator[Asked]:
    """Yield the notches that are given by an edge; the pattern has them in the order of the job."""
    specs = [spec for spec in part.spec.notch if spec.edge is not None]
    for one, spec in zip(pattern.notches, specs, strict=True):
        yield one.name, spec, known.spot(one.spot)


def _seam_notches(known: Seams, notches: Sequence[SeamNotch]) -> Iterator[Asked]:
    """Yield the notches that are given by a seam."""
    for notch in notches:
        numbers, t = known.lines[notch.seam].places(np.array([notch.fraction]))
        yield notch.name, notch.spec, (int(numbers[0]), float(t[0]))


def _notched(asked: Sequence[Asked], known: Seams, wide: Widened, bare: Contour) -> Notched:
    """Return the widened contour with its notches."""
    placed = [_placed(one, known, wide) for one in asked]
    off = tuple(one for one in placed if isinstance(one, Finding))
    if off:
        return Notched(bare, findings=off)
    return cut_into(bare, [one for one in placed if isinstance(one, Notch)])


def _placed(asked: Asked, known: Seams, wide: Widened) -> Notch | Finding:
    """Return a notch where the contour that is cut lies across from its place on the sew line."""
    name, spec, spot = asked
    line = known.of_edge(spot[0])
    point = known.outline[spot[0]].at(np.array([spot[1]]))[0]
    where: dict[str, float | int | str] = {"feature": name, "x": float(point[0]), "y": float(point[1])}
    if line is not None and float(spec.depth) > line.spec.allowance_mm + ROUNDING_MM:
        room = line.spec.allowance_mm
        message = (
            f"{name}: {float(spec.depth):g} mm deep, the allowance of {line.spec.called} is {room:g} mm: it would "
        )
        message += "cut the seam; make it no deeper than the allowance, or the allowance wider"
        return Finding("notch-too-deep", message, fatal=True, where=where)
    for i, strip in enumerate(wide.strips):
        if strip is not None and strip.edge == spot[0] and strip.low <= spot[1] <= strip.high:
            t = (spot[1] - strip.low) / (strip.high - strip.low)
            return Notch(name, spec, (i, t), _side(i, line, wide.strips))
    message = f"{name}: the allowances of a corner leave nothing of the edge at ({point[0]:.5g}, {point[1]:.5g})"
    return Finding("notch-off-edge", f"{message}; move it away from the corner", fatal=True, where=where)


def _side(i: int, line: Line | None, strips: Sequence[Strip | None]) -> tuple[int, int]:
    """Return the run of contour edges about one that are strips of the same seam, across the beginning too."""

    def same(k: int) -> bool:
        strip = strips[k]
        return strip is not None and (k == i or (line is not None and strip.edge in line.numbers))

    count = len(strips)
    first = next((k + 1 for k in range(i, i - count, -1) if not same(k % count)), i + 1 - count)
    last = next((k for k in range(i, i + count) if not same(k % count)), i + count)
    return first, last


def _sew_lines(known: Seams, tol: Tolerances) -> list[Mark]:
    """Return the sew line of every seam that has an allowance."""
    sewn_at = [line for line in known.lines.values() if line.spec.allowance_mm > 0.0]
    return [
        Mark(line.spec.called, traced([known.outline[i] for i in line.numbers], tol.chord_mm), "SEW")
        for line in sewn_at
    ]


def _allowance_error(known: Seams, wide: Widened, bare: Contour, tol: Tolerances) -> Metric:
    """Return how far lines and arcs that are cut are from the places across the sew line where they belong."""
    worst, place = 0.0, np.zeros(2)
    for strip in wide.strips:
        if strip is None:
            continue
        t = np.linspace(max(strip.low, 0.0), min(strip.high, 1.0), LOOKS)
        edge = known.outline[strip.edge]
        points = edge.at(t) + strip.distance_mm * normals(edge, t)
        away = _distances(points, bare.path)
        if away.max() > worst:
            worst, place = float(away.max()), points[int(np.argmax(away))]
    where: dict[str, float | int | str] = {"x": float(place[0]), "y": float(place[1])}
    return Metric("allowance_error_mm", worst, "mm", "sampled", tol.chord_mm, where)


def _distances(points: Points2, path: ArcPath) -> Array:
    """Return the distance of each point to the nearest piece of a path, mm."""
    count = piece_count(path)
    piece = np.tile(np.arange(count), len(points))
    every = arcpath.distances(np.repeat(points, count, axis=0), path, piece)
    return np.asarray(every.reshape(len(points), count).min(axis=1))


def _beyond(outer: Contour, marks: Sequence[Mark], tol: Tolerances) -> Iterator[Finding]:
    """Yield the slits that leave the part: a blade would cut its edge."""
    import shapely

    region = shapely.Polygon(arcpath.polygon(outer.path, accuracy=tol.chord_mm)).buffer(2.0 * tol.chord_mm)
    for mark in marks:
        if mark.layer == "CUT_SLIT" and not region.covers(shapely.LineString(mark.path.vertices)):
            message = f"{mark.name} leaves the part; move the seam's stitches farther in, or make the slit shorter"
            yield Finding("slit-outside", message, fatal=True, where={"feature": mark.name})


def _figures(made: FlatPattern, stitches: Sequence[Hole]) -> dict[str, float]:
    """Return area and lengths of what is cut, from the exact edges of its contours."""
    low_x, low_y, high_x, high_y = arcpath.bounds(made.outer.path)
    others = (made.outer, *(hole for hole in made.inner if hole.purpose != "stitch"))
    return {
        "area": sum(contours.area(contour.edges) for contour in others) - fsum(area for *_, area in stitches),
        "outline_length": contours.length(made.outer.edges),
        "width": high_x - low_x,
        "height": high_y - low_y,
    }
