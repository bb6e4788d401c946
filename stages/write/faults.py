"""What can be wrong with a cut file, each fault found from the file alone: one function per fault.

Limits follow the measures W6 to W10 of a cut file: one closed entity per contour, no vertex twice, no arc over a half
circle, no cut made twice, marks before holes before the outline around them, only simple entities, true units and
extents.  A check that depends on an earlier one (an order that is judged by contours that are not closed) stays silent
where that one has spoken.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from stages.geometry.arrays import Array, Values, norm
from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import ArcPath, area, chords, length
from stages.geometry.paths.overlap import overlaps
from stages.model.report import Finding
from stages.write.chains import Entity
from stages.write.closing import Closed, is_shared
from stages.write.drawing import extent
from stages.write.dxf import unit_variables
from stages.write.readback import ReadFile
from stages.write.sequence import order_faults, shared_order_faults

KINDS = frozenset({"LWPOLYLINE", "POLYLINE", "VERTEX", "SEQEND", "LINE", "ARC", "CIRCLE", "TEXT", "POINT", "CHAIN"})
CUT_LAYERS = ("CUT_INNER", "CUT_OUTER")
CLOSED_LAYERS = (*CUT_LAYERS, "SHEET", "SHEET_KEEPOUT")

EXTENT_MM = 0.01
OVERLAP_MM = 0.01
APART_MM = 1e-3
"""Two cuts closer than this are one cut: a hundredth of the narrowest kerf."""

SAME_VERTEX_MM = 1e-6
MOST_BULGE = 1.0 + 1e-9
BESIDE_MM = 0.05
"""How far a mark or hole may reach beyond its outline besides what lines and arcs are off their exact curves."""
TWO_CURVES = 2.0
"""A mark that ends on the exact outline and the outline itself are each within the chord of their exact curves."""
WHOLE = 0.999
"""Share of a contour that is cut twice from which on it is a copy, not a side shared with a neighbour."""


def faults(
    file: ReadFile, path: str, shortest_mm: float, chord_mm: float, closed: Closed | None = None
) -> list[Finding]:
    """Return the faults of one file.

    shortest_mm: the length below which a piece is too short.
    chord_mm: how far its paths may be off their exact curves.
    closed: the outlines that share cuts, put together again; None: none may, and every outline must be closed.
    """
    found: list[Finding] = [_fatal("readback-complaint", path, text) for text in file.complaints]
    if not file.entities:
        return found or [_fatal("readback-empty", path, "no entity")]
    for check in (_units, _extents, _colours, _kinds, _vertices, _bulges, _directions):
        found += [_fatal(code, path, text) for code, text in check(file)]
    found += [_fatal(code, path, text) for code, text in _open_contours(file, closed)]
    found += [_fatal("readback-short-piece", path, text) for text in _short_pieces(file, shortest_mm)]
    if not found:
        found += [_fatal("readback-order", path, text) for text in _order(file, closed, chord_mm)]
    return found + list(_overlaps(file.entities, path))


def _fatal(code: str, path: str, message: str) -> Finding:
    """Return a finding that stops the job."""
    return Finding(code, f"{path}: {message}", fatal=True, where={"file": path})


def _units(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield header variables that do not say millimetres."""
    for name, wanted in unit_variables(file.version).items():
        if file.header.get(name) != wanted:
            yield "readback-units", f"{name} is {file.header.get(name)}, must be {wanted:g} for millimetres"


def _extents(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield extents in the header that are not the bounding box."""
    paths = [entity.path for entity in file.entities if entity.path is not None]
    if not paths:
        return
    box = extent(paths)
    for name, wanted in (("$EXTMIN", box[:2]), ("$EXTMAX", box[2:])):
        written: Array = np.array(file.header.get(name, (np.inf, np.inf, 0.0)), dtype=np.float64)[:2]
        if not np.abs(written - np.array(wanted)).max() <= EXTENT_MM:
            yield "readback-extents", f"{name} is {tuple(written.tolist())}, the drawing reaches {wanted}"


def _colours(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield layers that are not declared or mean nothing, and entities whose own colour is not their layer's."""
    for entity in file.entities:
        if entity.layer not in file.layers:
            yield "readback-layer", f"{entity.kind} on the layer {entity.layer!r}, which means nothing here"
        elif entity.colour != file.layers[entity.layer]:
            yield "readback-colour", f"{entity.kind} on {entity.layer} has the colour {entity.colour}"


def _kinds(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield entities that cutting software does not take."""
    for entity in file.entities:
        text_cut = entity.kind == "TEXT" and entity.layer in CUT_LAYERS
        if entity.kind not in KINDS or text_cut:
            yield "readback-entity", f"{entity.kind} on {entity.layer}"


def _open_contours(file: ReadFile, closed: Closed | None) -> Iterator[tuple[str, str]]:
    """Yield what lies on a cut or sheet layer and does not close, nor make up an outline with what others share."""
    for entity in file.entities:
        if entity.layer in CLOSED_LAYERS and not entity.closed and not (closed and is_shared(entity)):
            yield "readback-open-contour", f"{entity.kind} on {entity.layer} is not closed"
    for outline in closed.outlines if closed else ():
        if area(outline.path) <= 0.0:
            yield "readback-direction", "an outline that shares cuts runs the wrong way round"
    yield from (("readback-open-contour", text) for text in (closed.loose if closed else ()))


def _order(file: ReadFile, closed: Closed | None, chord_mm: float) -> Iterator[str]:
    """Return what comes in an order in which it may not be cut."""
    beside = TWO_CURVES * chord_mm + BESIDE_MM
    if closed and closed.outlines:
        return shared_order_faults(file.entities, closed, beside)
    return order_faults(file.entities, beside)


def _vertices(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield vertices that follow themselves on what is closed or cut, on what is closed the last one and the first."""
    some = [(entity, path) for entity, path in _paths(file.entities) if entity.closed or entity.layer in CUT_LAYERS]
    for (entity, path), least in _with(some, manypaths.shortest_chords):
        if least <= SAME_VERTEX_MM:
            start, end = chords(path)
            count = np.count_nonzero(norm(end - start) <= SAME_VERTEX_MM)
            yield "readback-repeated-vertex", f"{entity.kind} on {entity.layer} repeats {count} of its vertices"


def _short_pieces(file: ReadFile, shortest_mm: float) -> Iterator[str]:
    """Yield cut pieces that are too short for a controller."""
    for (entity, _), least in _with(_paths(_cut(file.entities)), manypaths.shortest):
        if SAME_VERTEX_MM < least < shortest_mm:
            yield f"{entity.kind} on {entity.layer} has a piece of {least:.3g} mm, under {shortest_mm:.3g} mm"


def _bulges(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield arcs of more than a half circle."""
    for (entity, _), most in _with(_paths(file.entities), manypaths.steepest):
        if most > MOST_BULGE:
            yield "readback-bulge", f"{entity.kind} on {entity.layer} has an arc of more than 180 degrees"


def _directions(file: ReadFile) -> Iterator[tuple[str, str]]:
    """Yield outer contours that run clockwise and inner ones that run counter-clockwise; circles have no direction."""
    closed = [(one, path) for one, path in _paths(_cut(file.entities)) if one.closed and one.kind != "CIRCLE"]
    for (entity, _), wide in _with(closed, manypaths.areas):
        if (wide > 0.0) != (entity.layer == "CUT_OUTER"):
            yield "readback-direction", f"{entity.kind} on {entity.layer} runs the wrong way round"


Followed = tuple[Entity, ArcPath]
"""An entity and its path."""


def _paths(entities: Iterable[Entity]) -> list[Followed]:
    """Return the entities that are paths."""
    return [(entity, entity.path) for entity in entities if entity.path is not None]


def _with(some: Sequence[Followed], figures: Callable[[Sequence[ArcPath]], Values]) -> Iterator[tuple[Followed, float]]:
    """Yield each of some entities with a figure of its path."""
    yield from zip(some, figures([path for _, path in some]).tolist(), strict=True)


def _cut(entities: Sequence[Entity]) -> list[Entity]:
    """Return what will be cut."""
    return [entity for entity in entities if entity.layer in CUT_LAYERS]


def _overlaps(entities: Sequence[Entity], path: str) -> Iterator[Finding]:
    """Yield cuts that would be made twice; sides that two parts share are said, but stop nothing."""
    ends = np.cumsum([entity.layer == "CUT_OUTER" for entity in entities])
    parts = [int(ends[i]) - (entities[i].layer == "CUT_OUTER") for i in range(len(entities))]
    known = [(entity.path, parts[i]) for i, entity in enumerate(entities) if entity.layer in CUT_LAYERS]
    paths = [(cut, part) for cut, part in known if cut is not None]
    for overlap in overlaps([cut for cut, _ in paths], apart=APART_MM, least=OVERLAP_MM) if paths else []:
        (first, part), (second, other) = paths[overlap.first], paths[overlap.second]
        whole = min(length(first), length(second))
        text = f"{path}: {overlap.length_mm:.3f} mm would be cut twice"
        if part != other and overlap.length_mm < WHOLE * whole:
            yield Finding("readback-common-cut", f"{text} (parts touch; ask for a gap)", where={"file": path})
        else:
            yield Finding("readback-duplicate", text, fatal=True, where={"file": path})
