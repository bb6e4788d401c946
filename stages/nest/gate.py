"""The gate before any placement: what no engine could place, or would place wrongly, is refused by name.

`troubles` looks at each part and each stock by itself and at the options; whether a part is larger than every sheet is
asked later, when it is known in which angles it is tried.  Contours are judged as lines and arcs, not as polygons: a
contour that crosses itself by the area that it covers twice or inside out, one that runs back along itself by the
length, holes by the exact rules of the certifier.  A contour that merely runs the wrong way round is turned
(`oriented`), which is said.
"""

from collections import Counter
from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import replace
from math import isfinite

import numpy as np
from shapely import Polygon

from stages.geometry.paths.arcpath import ArcPath, area, backwards, joint_turns, length, lengths, polygon
from stages.geometry.paths.clearance import joined, nearest
from stages.geometry.paths.cover import doubled
from stages.geometry.paths.overlap import overlaps
from stages.geometry.paths.simple import certainly_simple
from stages.model.pattern import Contour, FlatPattern
from stages.model.report import Finding
from stages.model.sheet import NestOptions, Sheet
from stages.nest.legal.laid import fatal
from stages.nest.legal.region import Region, meeting, overlap_mm2, region, within
from stages.nest.turns import allowed

NO_AREA = 1e-9
"""A contour encloses nothing if its area is under this share of its length squared: 1 mm2 for a line of 30 m."""

APART_MM, BACK_MM = 1e-3, 0.01
"""A contour runs back along itself if it does so nearer than this, for longer than that: the limits for a cut file."""

CROSSED_MM = 1e-3
"""A contour may cover the square of this, or of its chord if that is more, twice: the rounding of joints."""

FINE_MM = 0.1
"""Chord error of the polygon on which it is asked whether an edge gap leaves room."""

CUSP = 2.8
"""A corner that turns by more, rad, is so sharp that its sides run within a chord error of each other for a while."""


def troubles(patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions) -> list[Finding]:
    """Return what is wrong with the parts, the stock and the options; what is not fatal was repaired or left out."""
    found = [*_options(options), *_stock(stock, any(pattern.quantity > 0 for pattern in patterns))]
    found += _twice("part", (pattern.part for pattern in patterns))
    simple = _simple(patterns)
    for pattern in patterns:
        found += _part(pattern, simple)
    if not any(finding.fatal for finding in found):
        found += [*_gap(stock, options), *_angles(patterns, stock, options)]
    return found


def oriented(pattern: FlatPattern) -> FlatPattern:
    """Return a part whose outer contour runs counter-clockwise and whose holes run clockwise."""
    if not any(_wrong_way(pattern)):
        return pattern
    outer, *inner = (
        replace(contour, path=backwards(contour.path)) if wrong else contour
        for contour, wrong in zip(_contours(pattern), _wrong_way(pattern), strict=True)
    )
    return pattern.replace(outer=outer, inner=tuple(inner))


def _contours(pattern: FlatPattern) -> list[Contour]:
    return [pattern.outer, *pattern.inner]


def _wrong_way(pattern: FlatPattern) -> list[bool]:
    """Return of each contour, the outer one first, whether it runs the wrong way round."""
    return [(area(contour.path) < 0.0) == (contour is pattern.outer) for contour in _contours(pattern)]


def _options(options: NestOptions) -> Iterator[Finding]:
    """Yield numbers that mean nothing, and an empty list of angles."""
    for name in ("gap_mm", "kerf_mm", "offcut_min_mm", "time_limit_s"):
        value = getattr(options, name)
        if not (isfinite(value) and value >= 0.0):
            yield fatal("option", f"{name} is {value:g}, it must be 0 or more", option=name)
    if options.rotations is not None and not all(map(isfinite, options.rotations)):
        yield fatal("option", f"an angle of the nest is not finite: {options.rotations}", option="rotations")
    if options.rotations == ():
        yield fatal("option", "no angle is allowed in the nest: list at least one, or allow any", option="rotations")


def _twice(what: str, names: Iterable[str]) -> Iterator[Finding]:
    """Yield names that several parts or sheets go by."""
    for name, count in Counter(names).items():
        if count > 1:
            yield fatal(f"{what}-duplicate", f"{count} {what}s go by the name '{name}'", **{what: name})


def _stock(stock: Sequence[Sheet], wanted: bool) -> Iterator[Finding]:
    """Yield that there is no stock, or what is wrong with it; a sheet without room is fatal if none has any."""
    if wanted and not any(sheet.quantity != 0 for sheet in stock):
        yield fatal("no-stock", "there is no stock to place anything on")
    yield from _twice("stock", (sheet.id for sheet in stock))
    wrong = {sheet.id: findings for sheet in stock if (findings := list(_sheet(sheet)))}
    for findings in wrong.values():
        yield from findings
    cramped = [sheet for sheet in stock if sheet.id not in wrong and not _has_room(sheet)]
    for sheet in cramped:
        message = f"stock '{sheet.id}': an edge gap of {sheet.edge_gap_mm:g} mm leaves no room"
        yield Finding("stock-no-room", message, fatal=len(cramped) == len(stock), where={"stock": sheet.id})


def _sheet(sheet: Sheet) -> Iterator[Finding]:
    """Yield sizes and outlines that are no sheet."""

    def wrong(what: str) -> Finding:
        return fatal("stock-invalid", f"stock '{sheet.id}': {what}", stock=sheet.id)

    if not (sheet.width_mm > 0.0 and sheet.height_mm > 0.0 and isfinite(sheet.height_mm)):
        yield wrong(f"{sheet.width_mm:g} x {sheet.height_mm:g} mm is no size")
    elif not (isfinite(sheet.width_mm) or sheet.is_roll):
        yield wrong("only a roll has no end")
    if not (isfinite(sheet.edge_gap_mm) and sheet.edge_gap_mm >= 0.0):
        yield wrong(f"the edge gap is {sheet.edge_gap_mm:g} mm, it must be 0 or more")
    if sheet.quantity is not None and sheet.quantity < 0:
        yield wrong(f"the quantity is {sheet.quantity}")
    if sheet.grain_deg is not None and not isfinite(sheet.grain_deg):
        yield wrong(f"the grain is {sheet.grain_deg:g} deg")
    if sheet.price is not None and not (isfinite(sheet.price) and sheet.price >= 0.0):
        yield wrong(f"the price is {sheet.price:g}, it must be 0 or more")
    outlines = {
        "the outline": [sheet.outline] if sheet.outline else [],
        "defect": sheet.defects,
        "zone": [zone.outline for zone in sheet.zones],
    }
    for name, paths in outlines.items():
        for number, path in enumerate(paths, start=1):
            called = f"{name} {number}" if len(name.split()) == 1 else name
            yield from (wrong(f"{called} {reason}") for reason in _faults(path, 0.0))


def _has_room(sheet: Sheet) -> bool:
    """Return whether anything is left of a sheet within its edge gap."""
    if sheet.outline is None:
        return 2.0 * sheet.edge_gap_mm < min(sheet.width_mm, sheet.height_mm)
    return not Polygon(polygon(sheet.outline, accuracy=FINE_MM)).buffer(-sheet.edge_gap_mm).is_empty


def _simple(patterns: Sequence[FlatPattern]) -> frozenset[int]:
    """Return the identities of contours that need no closer look, since they certainly do not meet themselves."""
    contours = [contour for pattern in patterns for contour in _contours(pattern) if contour.path.closed]
    if not contours:
        return frozenset()
    simple = certainly_simple([contour.path for contour in contours], apart=APART_MM)
    return frozenset(id(contour) for contour, one in zip(contours, simple.tolist(), strict=True) if one)


def _part(pattern: FlatPattern, simple: Container[int]) -> Iterator[Finding]:
    """Yield what is wrong with one part; its holes are looked at if each contour by itself is right."""

    def wrong(code: str, what: str) -> Finding:
        return fatal(code, f"part '{pattern.part}': {what}", part=pattern.part)

    if pattern.quantity < 0:
        yield wrong("quantity", f"the quantity is {pattern.quantity}")
    angles = pattern.rotations if isinstance(pattern.rotations, tuple) else ()
    if not all(map(isfinite, (*angles, pattern.axis_deg or 0.0, pattern.axis_band_deg))):
        yield wrong("not-finite", "an angle is not finite")
    faults = [
        wrong("contour", f"{'the outline' if number == 0 else f'hole {number}'} {reason}")
        for number, contour in enumerate(_contours(pattern))
        if id(contour) not in simple
        for reason in _faults(contour.path, contour.chord_mm)
    ]
    yield from faults
    if not faults:
        yield from (wrong(code, what) for code, what in _holes(pattern))
        if any(_wrong_way(pattern)):
            message = f"part '{pattern.part}': a contour ran the wrong way round and was turned"
            yield Finding("contour-turned", message, where={"part": pattern.part})


def _faults(path: ArcPath, chord_mm: float) -> Iterator[str]:
    """Yield what is wrong with one contour, the first thing that is."""
    if not path.closed:
        yield "is not closed"
    elif abs(area(path)) <= NO_AREA * length(path) ** 2 and not doubled(path) > NO_AREA * length(path) ** 2:
        yield "encloses no area"
    elif (covered := doubled(path)) > CROSSED_MM**2 and covered > _excused(path, chord_mm):
        yield f"crosses itself: {covered:.4g} mm2 lie inside it twice or inside out"
    else:
        back = sum(one.length_mm for one in overlaps([path], apart=APART_MM, least=BACK_MM))
        if back > 0.0:
            yield f"runs back along itself over {back:.4g} mm"


def _excused(path: ArcPath, chord_mm: float) -> float:
    """Return how much area, mm2, a contour may cover twice because it is only within a chord error of the true one.

    In a sharp corner its two sides may cross: over two chord errors times the shorter of them.
    """
    length, sharp = lengths(path), np.abs(joint_turns(path)) > CUSP
    sides = np.minimum(length, np.roll(length, 1))[sharp]
    return chord_mm * (chord_mm + 2.0 * float(sides.sum()))


def _holes(pattern: FlatPattern) -> Iterator[tuple[str, str]]:
    """Yield holes that leave the outline or run into each other; one that merely touches is not in the way here."""
    outline = region(pattern.outer.path)
    holes = [region(contour.path) for contour in pattern.inner]
    for number, (hole, gap) in enumerate(zip(holes, _gaps(holes, outline), strict=True), start=1):
        if not within(hole, outline, gap):
            yield "hole-outside", f"hole {number} is not within the outline"
    for number, other in sorted((j, i) for i, j in meeting(holes)):
        hole, before = holes[number], holes[other]
        if overlap_mm2(hole, before, *_gaps([hole], before)) > 0.0:
            yield "hole-overlap", f"holes {other + 1} and {number + 1} run into each other"


def _gaps(some: Sequence[Region], other: Region) -> list[float]:
    """Return how far the contours of regions are from those of another, mm, as far as it matters."""
    if not some:
        return []
    outlines = [one.outline for one in some]
    owner = np.repeat(np.arange(len(some)), [outline.bulge.size for outline in outlines])
    found = nearest(joined(outlines), owner, other.outline, within=APART_MM)
    return [found.get(number, APART_MM) for number in range(len(some))]


def _gap(stock: Sequence[Sheet], options: NestOptions) -> Iterator[Finding]:
    """Yield a gap that no two parts on any sheet can keep."""
    longest = max((float(np.hypot(sheet.width_mm, sheet.height_mm)) for sheet in stock), default=np.inf)
    if options.gap_mm >= longest:
        message = f"a gap of {options.gap_mm:g} mm is wider than the largest sheet, {longest:.6g} mm across"
        yield fatal("option", message, option="gap_mm")


def _angles(patterns: Sequence[FlatPattern], stock: Sequence[Sheet], options: NestOptions) -> Iterator[Finding]:
    """Yield parts that may lie on no sheet in any angle: no angle listed, or none of them along the grain."""
    for pattern in patterns:
        hands = (False, True) if options.mirror or pattern.pair else (False,)
        turns = [allowed(pattern, sheet, options, mirrored=hand) for sheet in stock for hand in hands]
        if pattern.quantity > 0 and all(one.spans == () for one in turns):
            listed = pattern.rotations if isinstance(pattern.rotations, tuple) else options.rotations or ()
            grain = ", ".join(sorted({f"{sheet.grain_deg:g}" for sheet in stock if sheet.grain_deg is not None}))
            message = f"part '{pattern.part}' may be turned by {', '.join(f'{a:g}' for a in listed) or 'no angle'}"
            against = f", none of which lays its axis along the grain ({grain} deg)" if grain and listed else ""
            yield fatal("no-angle", message + against, part=pattern.part)
