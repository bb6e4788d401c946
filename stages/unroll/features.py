"""Holes, marks, texts and notches of a part in its flat pattern.

    on_strip(surface, development, outer) -> Features        on_plate(plate, outer, holes) -> Features

What construct placed in u and v goes through the flat map: a place becomes a point, a curve an exact edge that is
evaluated through the map (`geometry.flat.mapped`); a circle of the flat pattern is an exact circle, a drilled hole
the image of the curve in which the cylinder meets the surface (`geometry.ruled.drill`).  Of a part that was divided,
a blank takes what lies on it (`onblank`); what a cut would go through is refused.

Marks do not reach beyond the outline nor across holes (`onpart`); a text that does is told (`texts`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stages.geometry.arrays import Vector2, unit
from stages.geometry.curves import contours
from stages.geometry.curves.plane import CircularArc, PlaneCurve, stretch
from stages.geometry.flat.flatmap import Development
from stages.geometry.flat.mapped import FlatStrip, images
from stages.geometry.flat.tabled import tabled
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.ruled.drill import drilled
from stages.geometry.ruled.strip import Strip
from stages.model.features import (
    CircleHole,
    CurveHole,
    CurveMark,
    DrilledHole,
    NotchSpec,
    PointMark,
    RulingMarks,
    TextMark,
)
from stages.model.pattern import Contour, Mark, NotchPlace, Purpose, Text
from stages.model.report import Finding, Metric
from stages.model.surface import BranchedSurface, MeshSurface, Placed, Plate, RuledSurface, Surface
from stages.unroll import outline
from stages.unroll.marks import ruling_marks, traced
from stages.unroll.notches import Notch, Notched, notched
from stages.unroll.notches import on_outline as notch_on_outline
from stages.unroll.notches import on_strip as notch_on_strip
from stages.unroll.onblank import crosses_end, cut_through, share_of
from stages.unroll.onpart import left_off, on_part
from stages.unroll.texts import text_findings
from stages.unroll.webs import judged

Row = dict[str, object]


@dataclass(frozen=True, slots=True)
class Features:
    """What is cut into and drawn on a pattern, its outline with notches, and what was found; rows for the report."""

    outer: Contour
    inner: tuple[Contour, ...] = ()
    marks: tuple[Mark, ...] = ()
    texts: tuple[Text, ...] = ()
    metrics: tuple[Metric, ...] = ()
    findings: tuple[Finding, ...] = ()
    mark_rows: list[Row] = field(default_factory=list)
    hole_rows: list[Row] = field(default_factory=list)
    notches: tuple[NotchPlace, ...] = ()
    boundary: Contour | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Flat:
    """A feature in the plane: its edges, or the point that it is at and the direction of the ruling there (x)."""

    placed: Placed
    edges: tuple[PlaneCurve, ...] = ()
    at: Vector2 | None = None
    along: Vector2 | None = None


def on_strip(
    surface: RuledSurface, development: Development, outer: Contour, holes: tuple[Contour, ...] = ()
) -> Features:
    """Return the features of a strip, or of a blank of one, through its flat map.

    surface: the one that was developed (the neutral surface), with the part's v in its `spans`.
    outer, holes: its contours, those of its trim where it has one; notches are in `outer`.
    Raises NoSolutionError where a curve is not resolved or its arcs do not keep the chord.
    """
    knots = np.array([*(float(low) for low, _ in surface.spans), float(surface.spans[-1][1])])
    flat, strip = FlatStrip(development.pieces, knots), Strip(surface.patches, knots)
    found: list[Flat] = []
    findings: list[Finding] = []
    notches: list[Notch] = []
    for one in surface.features:
        if isinstance(one.spec, NotchSpec) and (surface.trim is not None or one.spec.edge == "outline"):
            on_trim = _notch_on_trim(one, one.spec, outer)
            findings += [on_trim] if isinstance(on_trim, Finding) else []
            notches += [on_trim] if isinstance(on_trim, Notch) else []
            continue
        here = share_of(one, knots)
        if here == "cut":
            findings.append(cut_through(one))
        elif here == "on" and isinstance(one.spec, NotchSpec):
            notches.append(notch_on_strip(one, one.spec, knots))
        elif here == "on":
            made = image(one, flat, strip)
            if surface.divided and _crosses_cut(made, development):
                findings.append(cut_through(one))
            elif isinstance(made, Finding):
                findings.append(made)
            else:
                found.append(made)
    rulings = [spec for spec in surface.part.spec.mark if isinstance(spec, RulingMarks)]
    lines = tuple(mark for spec in rulings for mark in ruling_marks(development, spec, chord_mm=outer.chord_mm))
    made_outer = notched(surface.part, outer, notches)
    return assembled(surface, made_outer, found, findings, lines=lines, holes=holes)


def _notch_on_trim(one: Placed, spec: NotchSpec, outer: Contour) -> Notch | Finding:
    """Return a notch by its distance along the outline; a trimmed part has no other edge."""
    if spec.edge == "outline":
        return notch_on_outline(one, spec, outer.edges)
    message = f'{one.name}: a trimmed part has no edge {spec.edge!r}; give edge = "outline" and a distance along it'
    return Finding("no-such-edge", message, fatal=True, where={"feature": one.name})


def on_plate(plate: Plate, outer: Contour, holes: tuple[Contour, ...]) -> Features:
    """Return the features of a plate beside the holes of its surface."""
    return on_outline(plate, outer, holes, lambda one: _circle_hole(Flat(one, one.curve, one.at, np.array([1.0, 0.0]))))


def on_outline(
    surface: Plate | MeshSurface | BranchedSurface,
    outer: Contour,
    holes: tuple[Contour, ...],
    drawn: Callable[[Placed], Flat | Finding],
) -> Features:
    """Return the features of a part whose outline has no named edges.

    Notches go by their distance along it, everything else is laid flat by `drawn`, which may refuse it.
    """
    notches = [notch_on_outline(one, one.spec, outer.edges) for one in surface.features
               if isinstance(one.spec, NotchSpec)]  # fmt: skip
    found = [drawn(one) for one in surface.features if not isinstance(one.spec, NotchSpec)]
    fatal = [one for one in (*notches, *found) if isinstance(one, Finding)]
    made_outer = notched(surface.part, outer, [one for one in notches if isinstance(one, Notch)])
    return assembled(surface, made_outer, [one for one in found if isinstance(one, Flat)], fatal, holes=holes)


def _crosses_cut(made: Flat | Finding, development: Development) -> bool:
    """Return whether a hole about a place crosses an end ruling of a blank; a drill that found no way round does."""
    if isinstance(made, Finding):
        return True
    return made.at is not None and bool(made.edges) and crosses_end(made.edges, development)


def image(one: Placed, flat: FlatStrip, strip: Strip) -> Flat | Finding:
    """Return a feature through the flat map."""
    if one.at is None:
        return Flat(one, images(flat, one.curve))
    u, v = one.at[:1], one.at[1:]
    point, (along, _) = flat.positions(u, v)[0], flat.slopes(u, v)
    if isinstance(one.spec, DrilledHole):
        hole = drilled(strip, one.at, float(one.spec.diameter) / 2.0)
        if hole is None:
            message = f"{one.name}: the drill leaves the surface before it has come round"
            return Finding("hole-outside", message, fatal=True, where={"feature": one.name})
        return Flat(one, images(flat, (tabled(hole, strip),)), point, unit(along)[0])
    return _circle_hole(Flat(one, (), point, unit(along)[0]))


def _circle_hole(made: Flat) -> Flat:
    """Return the feature, with its circle if it is a hole that is round in the pattern; on a plate a drilled one is."""
    spec, at = made.placed.spec, made.at
    if at is None or not isinstance(spec, CircleHole | DrilledHole):
        return made
    circle = CircularArc(at, float(spec.diameter) / 2.0, 0.0, -2.0 * np.pi)
    return Flat(made.placed, (circle,), at, made.along)


def assembled(
    surface: Surface,
    made_outer: Notched,
    found: Sequence[Flat],
    findings: Sequence[Finding],
    *,
    lines: tuple[Mark, ...] = (),
    holes: tuple[Contour, ...] = (),
) -> Features:
    """Return holes, marks and texts with what is to be said of them."""
    outer = made_outer.outer
    cut = [
        (made, contours.area_and_centroid(made.edges))
        for made in found
        if isinstance(made.placed.spec, CircleHole | DrilledHole | CurveHole)
    ]
    empty = tuple(_empty(made) for made, (area, *_) in cut if abs(area) <= NO_AREA * outer.chord_mm**2)
    fatal = (*findings, *made_outer.findings, *empty)
    if any(finding.fatal for finding in fatal):
        return Features(outer, findings=fatal)
    inner = (*holes, *(_hole(made, area, outer.chord_mm) for made, (area, *_) in cut))
    said = judged(outer, inner, surface.part.process)
    given = [mark for made in found for mark in _marks(made, outer.chord_mm)]
    marks, rulings = on_part(given, outer, inner), on_part(lines, outer, inner)
    texts = tuple(_text(made) for made in found if isinstance(made.placed.spec, TextMark))
    rows = [*filter(None, map(_mark_row, found)), *(_row(place.name, place.at, None) for place in made_outer.places)]
    hole_rows = [_hole_row(hole.name, contours.area_and_centroid(hole.edges), None) for hole in holes]
    hole_rows += [_hole_row(made.placed.name, figures, made.placed.distance_mm) for made, figures in cut]
    return Features(
        outer,
        inner,
        (*rulings, *marks, *made_outer.lines),
        texts,
        said.metrics,
        (*fatal, *said.findings, *left_off(given, marks), *text_findings(texts, outer, inner)),
        rows,
        hole_rows,
        made_outer.places,
        made_outer.boundary,
    )


NO_AREA = 1e-6
"""A hole below this share of the square of the chord encloses nothing."""


def _empty(made: Flat) -> Finding:
    name = made.placed.name
    return Finding("no-area", f"{name} encloses no area", fatal=True, where={"feature": name})


def _hole(made: Flat, area: float, chord_mm: float) -> Contour:
    """Return a hole, clockwise; `area` with the sign of its sense."""
    edges = made.edges
    if area > 0.0:
        edges = tuple(stretch(edge, 1.0, 0.0) for edge in edges[::-1])
    purpose: Purpose = "drill" if isinstance(made.placed.spec, DrilledHole) else "cut"
    return replace(outline.contour(edges, chord_mm, made.placed.name), purpose=purpose)


def _marks(made: Flat, chord_mm: float) -> list[Mark]:
    """Return the lines of a mark, whether on the part or not."""
    name, spec = made.placed.name, made.placed.spec
    if isinstance(spec, CurveMark):
        return [Mark(name, traced(made.edges, chord_mm))]
    if isinstance(spec, PointMark) and made.at is not None and made.along is not None:
        x, y = made.along
        arms = (float(spec.size) / 2.0 * np.array([x, y]), float(spec.size) / 2.0 * np.array([-y, x]))
        ends = (np.stack([made.at - arm, made.at + arm]) for arm in arms)
        return [Mark(name, ArcPath(line, np.zeros(2), closed=False)) for line in ends]
    return []


def _text(made: Flat) -> Text:
    """Return a text in the frame of its ruling."""
    spec, at, along = made.placed.spec, made.at, made.along
    if not isinstance(spec, TextMark) or at is None or along is None:
        raise ValueError(f"{made.placed.name} is no text with a place")
    angle = float(np.degrees(np.arctan2(along[1], along[0]))) + float(spec.angle)
    return Text(made.placed.name, spec.text, at, float(spec.height), angle)


def _mark_row(made: Flat) -> Row | None:
    """Return what the report says of a mark: its point, or where its curve begins."""
    if not isinstance(made.placed.spec, PointMark | TextMark | CurveMark):
        return None
    at = made.at if made.at is not None else made.edges[0].at(np.array([0.0]))[0]
    row = _row(made.placed.name, at, made.placed.distance_mm)
    return row | {"length": contours.length(made.edges)} if made.edges else row


def _row(name: str, at: Vector2, distance: float | None) -> Row:
    return {"name": name, "x": float(at[0]), "y": float(at[1]), "distance": distance or 0.0}


def _hole_row(name: str, figures: tuple[float, float, float], distance: float | None) -> Row:
    """Return name, exact area and centroid of a hole, and how far from the surface it was given."""
    area, x, y = figures
    return {"name": name, "area": abs(area), "x": x, "y": y, "distance": distance or 0.0}
