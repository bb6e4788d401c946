"""What can be wrong with a pattern file, each fault found from the file alone: one function per fault.

Layers and entities are those of the standard; every block is a piece with one closed outline, inserted once, where it
is; every vertex of a line that is cut, drawn or sewn has one turn or curve point, and no such point lies elsewhere;
each of these lines has its validation curve within the tolerance that the file states; a notch lies on a vertex of the
outline and points inward, a drill hole within it; the texts have their keys, and the units are metric.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from math import cos, isfinite, radians, sin

import numpy as np
from shapely import Point, Polygon

from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import ArcPath, area
from stages.geometry.paths.hausdorff import nearest
from stages.model.patternlayers import (
    BOUNDARY,
    CURVE,
    CUT_OUT,
    DRILL,
    FLAGGED,
    NOTCH_LAYERS,
    POINTS_ONLY,
    STANDARD,
    TURN,
    VALIDATION,
)
from stages.model.report import Finding
from stages.write.piecetext import PIECE_KEYS, STYLE_KEYS, UNITS
from stages.write.readpieces import Content, ReadPieces, ReadPoint

VERTEX_MM = 1e-8
"""A point as near to a vertex as this was written with it: both are rounded to 1e-10 mm."""

STEP_MM = 1e-3
"""How far along its direction a notch is followed to see whether that leads into the piece."""

FALLBACK_MM = 0.0
"""The tolerance of a file that states none, or no number: its validation curves must be its lines."""

TWO_CURVES = 2.0
"""A line and its validation curve are each within the tolerance of the exact curve."""

NOTCHES = frozenset(NOTCH_LAYERS.values())
Fault = tuple[str, str]


def piece_faults(file: ReadPieces, path: str) -> list[Finding]:
    """Return the faults of a pattern file."""
    found: list[Fault] = [("readback-complaint", text) for text in file.complaints]
    if not found:
        found += [*_layers(file), *_blocks(file), *_style(file)]
        tolerance = _tolerance(file)
        for block in file.blocks:
            every = (*_outline(block), *_piece_keys(block), *_chords(block), *_flags(block))
            every += (*_validation(block, tolerance), *_spots(block))
            found += [(code, f"{block.name}: {text}") for code, text in every]
    return [Finding(code, f"{path}: {text}", fatal=True, where={"file": path}) for code, text in found]


def _layers(file: ReadPieces) -> Iterator[Fault]:
    """Yield entities that are none of the standard's, or on a layer that is not for them."""
    for number in file.layers:
        if number != BOUNDARY:
            yield "pattern-layer", f"a block lies on the layer {number}"
    for content in (*file.blocks, file.space):
        yield from (("pattern-layer", text) for text in content.strangers)
        lines, points, texts = ([one.layer for one in some] for some in (content.lines, content.points, content.texts))
        wrong = Counter(f"a line on {number}" for number in lines if number in POINTS_ONLY or number not in STANDARD)
        wrong.update(f"a point on {number}" for number in points if number not in POINTS_ONLY)
        wrong.update(f"a text on {number}" for number in texts if number not in STANDARD)
        yield from (("pattern-layer", f"{text} ({count} times)") for text, count in wrong.items())


def _blocks(file: ReadPieces) -> Iterator[Fault]:
    """Yield blocks that are not inserted once, unturned, where they are, and points and outlines outside of blocks."""
    names = Counter(one.name for one in file.inserts)
    known = {block.name for block in file.blocks}
    if not known:
        yield "pattern-block", "no piece"
    for name in sorted(known | names.keys()):
        if name not in known or names[name] != 1:
            yield (
                "pattern-block",
                f"{name} is {'there' if name in known else 'no block and'} inserted {names[name]} times",
            )
    for one in file.inserts:
        if (one.layer, one.x, one.y, one.scale, one.angle_deg) != (BOUNDARY, 0.0, 0.0, (1.0, 1.0), 0.0):
            yield "pattern-block", f"{one.name} is moved, turned, scaled or on the layer {one.layer}"
    if file.space.points or any(line.layer == BOUNDARY for line in file.space.lines):
        yield "pattern-block", "an outline or a point lies outside of all pieces"


def _keys(content: Content) -> dict[str, str]:
    """Return the texts that have a key, by their keys."""
    pairs = [one.text.partition(":") for one in content.texts if one.layer == BOUNDARY and ":" in one.text]
    return {key.strip(): value.strip() for key, _, value in pairs}


def _style(file: ReadPieces) -> Iterator[Fault]:
    """Yield what the style lacks, units that are not metric, and names of pieces that are there twice."""
    said = _keys(file.space)
    yield from (("pattern-text", f"the style has no {key}") for key in STYLE_KEYS if not said.get(key))
    if said.get("Units", UNITS) != UNITS:
        yield "pattern-text", f"units are {said['Units']}, must be {UNITS}"
    names = Counter((_keys(block).get("Piece Name"), _keys(block).get("Size")) for block in file.blocks)
    yield from (
        ("pattern-text", f"{count} pieces are called {name}") for (name, _), count in names.items() if count > 1
    )


def _tolerance(file: ReadPieces) -> float:
    """Return the tolerance of curves that the style states, mm."""
    try:
        stated = float(_keys(file.space).get("Curve Tolerance", FALLBACK_MM))
    except ValueError:
        return FALLBACK_MM
    return stated if isfinite(stated) else FALLBACK_MM


def _piece_keys(block: Content) -> Iterator[Fault]:
    said = _keys(block)
    yield from (("pattern-text", f"has no {key}") for key in PIECE_KEYS if not said.get(key))


def _outline(block: Content) -> Iterator[Fault]:
    """Yield outlines that are not one, closed and counter-clockwise, and closed cut-outs that are not clockwise."""
    outlines = _on(block, BOUNDARY)
    if len(outlines) != 1:
        yield "pattern-outline", f"has {len(outlines)} outlines"
    for path in outlines:
        if not path.closed:
            yield "pattern-open", "the outline is not closed"
        elif area(path) <= 0.0:
            yield "pattern-direction", "the outline runs clockwise"
    for path in _on(block, CUT_OUT):
        if path.closed and area(path) >= 0.0:
            yield "pattern-direction", "a cut-out runs counter-clockwise"


def _on(block: Content, layer: str) -> list[ArcPath]:
    return [line.path for line in block.lines if line.layer == layer and line.path is not None]


def _chords(block: Content) -> Iterator[Fault]:
    """Yield lines without points or with arcs."""
    for line in block.lines:
        if line.path is None:
            yield "pattern-line", f"a line on {line.layer} has no two points"
        elif line.path.bulges.any():
            yield "pattern-bulge", f"a line on {line.layer} has arcs"


def _places(points: Sequence[ReadPoint]) -> Points2:
    return np.array([(one.x, one.y) for one in points], dtype=np.float64).reshape(-1, 2)


def _flags(block: Content) -> Iterator[Fault]:
    """Yield vertices that have not one turn or curve point each, and such points that are on no vertex."""
    paths = [line.path.vertices for line in block.lines if line.layer in FLAGGED and line.path is not None]
    vertices = np.concatenate([*paths, np.zeros((0, 2))])
    points = _places([one for one in block.points if one.layer in (TURN, CURVE)])
    told, wanted = (
        Counter(map(tuple, np.round(some / VERTEX_MM).astype(np.int64).tolist())) for some in (points, vertices)
    )
    bare, stray = (wanted - told).total(), (told - wanted).total()
    if bare:
        yield "pattern-vertex", f"{bare} vertices have no turn or curve point"
    if stray:
        yield "pattern-vertex", f"{stray} turn or curve points are on no vertex, or one too many"


def _validation(block: Content, tolerance: float) -> Iterator[Fault]:
    """Yield lines without their validation curve, or with one that is too far away."""
    for layer, other in VALIDATION.items():
        lines, curves = _on(block, layer), _on(block, other)
        if len(lines) != len(curves):
            yield "pattern-validation", f"{len(lines)} lines on {layer}, {len(curves)} curves on {other}"
            continue
        for line, curve in zip(lines, curves, strict=True):
            away = _apart(line, curve, tolerance)
            if away > TWO_CURVES * tolerance + VERTEX_MM:
                yield "pattern-validation", f"a line on {layer} is {away:.3g} mm from its curve on {other}"


def _apart(line: ArcPath, curve: ArcPath, tolerance: float) -> float:
    """Return how far the vertices of either are from the other, mm."""
    accuracy = max(tolerance, VERTEX_MM)
    ways = ((line, curve), (curve, line))
    return max(float(nearest(one.vertices, other, accuracy=accuracy).max()) for one, other in ways)


def _spots(block: Content) -> Iterator[Fault]:
    """Yield notches that are not in the outline or do not lead into the piece, and drill holes that are not in it."""
    outlines = [path for path in _on(block, BOUNDARY) if path.closed and path.bulges.size > 2]  # noqa: PLR2004
    if not outlines:
        return
    vertices, region = outlines[0].vertices, Polygon(outlines[0].vertices)
    for one in block.points:
        if one.layer in NOTCHES:
            off = float(np.hypot(*(vertices - [one.x, one.y]).T).min())
            ahead = one.x + STEP_MM * cos(radians(one.angle_deg)), one.y + STEP_MM * sin(radians(one.angle_deg))
            if off > VERTEX_MM:
                yield "pattern-notch", f"a notch on {one.layer} is {off:.3g} mm from the vertices of the outline"
            elif not one.depth_mm > 0.0 or one.width_mm < 0.0 or not region.contains(Point(ahead)):
                yield "pattern-notch", f"a notch on {one.layer} does not lead into the piece"
        elif one.layer == DRILL and not (one.width_mm > 0.0 and region.contains(Point(one.x, one.y))):
            yield "pattern-drill", f"a drill hole of {one.width_mm:g} mm is not within the piece"
