"""Whether the paths of a file come in an order in which they may be cut: of each part marks, then holes, then outline.

Where every outline is one closed path, a part ends with its outline.  Where outlines share cuts, their pieces are
scattered: there a mark or hole belongs to the smallest outline around it and comes before its first piece, and what
lies in a hole comes before that hole.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from shapely import Polygon, STRtree, buffer, contains, linearrings, polygons, prepare

from stages.geometry.arrays import Mask
from stages.geometry.paths import manypaths
from stages.geometry.paths.arcpath import ArcPath, polygon
from stages.write.chains import Entity
from stages.write.closing import Closed, Outline

RANK = {"ENGRAVE": 0, "MARK": 0, "CUT_SLIT": 0, "CUT_INNER": 1, "CUT_OUTER": 2}

POLYGON_MM = 0.0125
"""How near the polygons come to the arcs that they stand for: a quarter of what a mark may reach beyond its outline."""

MARKS_FIRST = "marks must come before holes"


def order_faults(entities: Sequence[Entity], beside_mm: float) -> Iterator[str]:
    """Yield what is not followed by its own outline: of each part marks, then holes, then the outline around them.

    beside_mm: how far a mark or hole may reach beyond its outline and still belong to it.
    """
    ranked = [entity for entity in entities if entity.layer in RANK]
    group: list[tuple[Entity, bool]] = []
    for entity, is_held in zip(ranked, _held(ranked, beside_mm).tolist(), strict=True):
        group.append((entity, is_held))
        if entity.layer == "CUT_OUTER":
            yield from _group_order(group)
            group = []
    if group:
        yield f"{len(group)} marks or holes come after the last outline"


def _group_order(group: Sequence[tuple[Entity, bool]]) -> Iterator[str]:
    """Yield what is out of order among the paths that end with one outline, each with whether that holds it."""
    ranks = [RANK[entity.layer] for entity, _ in group]
    if ranks != sorted(ranks):
        yield MARKS_FIRST
    for entity, is_held in group[:-1]:
        if not is_held:
            yield f"{entity.kind} on {entity.layer} comes before an outline that does not hold it"


def _held(entities: Sequence[Entity], beside_mm: float) -> Mask:
    """Return which paths the next outline in their order holds; what is no path counts as held."""
    outlines = np.flatnonzero([entity.layer == "CUT_OUTER" for entity in entities])
    known = np.array([entity.path is not None for entity in entities], dtype=bool)
    held = np.ones(len(entities), dtype=bool)
    if not outlines.size or not known.any():
        return held
    shapes = np.full(len(entities), None, dtype=object)
    shapes[known] = _shapes([entity.path for entity in entities if entity.path is not None])
    inner = np.setdiff1d(np.arange(int(outlines[-1])), outlines)
    owner = outlines[np.searchsorted(outlines, inner)]
    both = known[inner] & known[owner]
    inner, around = inner[both], shapes[owner[both]]
    prepare(around)
    held[inner] = contains(around, shapes[inner])
    # few reach beyond their outlines
    beyond = ~held[inner]
    held[inner[beyond]] = contains(buffer(around[beyond], beside_mm), shapes[inner[beyond]])
    return held


def _shapes(paths: Sequence[ArcPath]) -> NDArray[np.object_]:
    """Return polygons that stand for paths; an open one runs there and back."""
    points, owner = manypaths.polygons(paths, POLYGON_MM)
    count = np.bincount(owner, minlength=len(paths))
    closed = np.array([path.closed for path in paths]) & (count > 2)  # noqa: PLR2004  two points enclose nothing
    longer = np.where(closed, count, 2 * count)
    ring = np.repeat(np.arange(count.size), longer)
    within = np.arange(ring.size) - np.repeat(np.cumsum(longer) - longer, longer)
    back = np.where(within < count[ring], within, 2 * count[ring] - 1 - within)
    made: NDArray[np.object_] = polygons(linearrings(points[(np.cumsum(count) - count)[ring] + back], indices=ring))
    return made


def shared_order_faults(entities: Sequence[Entity], closed: Closed, beside_mm: float) -> Iterator[str]:
    """Yield what is out of order in a file whose outlines share cuts."""
    outlines = [*_whole(entities), *closed.outlines]
    regions = [_region(outline.path) for outline in outlines]
    exact, grown = STRtree(regions), STRtree([region.buffer(beside_mm) for region in regions])
    rank = [0] * len(outlines)
    for place, entity in enumerate(entities):
        if entity.layer not in RANK or entity.layer == "CUT_OUTER" or entity.path is None:
            continue
        (shape,) = _shapes([entity.path])
        around = grown.query(shape, predicate="covered_by").tolist()
        owner = min(around, key=lambda one: regions[one].area, default=None)
        if owner is None or min(outlines[owner].entities) < place:
            yield f"{entity.kind} on {entity.layer} does not come before an outline that holds it"
            continue
        if RANK[entity.layer] < rank[owner]:
            yield MARKS_FIRST
        rank[owner] = RANK[entity.layer]
        within = exact.query(_region(entity.path), predicate="contains") if entity.layer == "CUT_INNER" else ()
        if any(max(outlines[one].entities) > place for one in within):
            yield f"{entity.kind} on {entity.layer} comes before an outline that lies in it"


def _whole(entities: Sequence[Entity]) -> list[Outline]:
    """Return the outlines that are one closed path."""
    return [
        Outline(entity.path, (place,))
        for place, entity in enumerate(entities)
        if entity.layer == "CUT_OUTER" and entity.closed and entity.path is not None
    ]


def _region(path: ArcPath) -> Polygon:
    """Return the region inside a path."""
    return Polygon(polygon(path, accuracy=POLYGON_MM))
