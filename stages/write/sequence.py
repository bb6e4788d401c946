"""Whether the paths of a file come in an order in which they may be cut: of each part marks, then holes, then outline.

Where every outline is one closed path, a part ends with its outline.  Where outlines share cuts, their pieces are
scattered: there a mark or hole belongs to the smallest outline around it and comes before its first piece, and what
lies in a hole comes before that hole.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from shapely import Polygon, STRtree, prepare

from stages.geometry.arcpath import ArcPath, polygon
from stages.geometry.arrays import Array
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
    group: list[Entity] = []
    for entity in entities:
        if entity.layer in RANK:
            group.append(entity)
        if entity.layer == "CUT_OUTER":
            yield from _group_order(group, beside_mm)
            group = []
    if group:
        yield f"{len(group)} marks or holes come after the last outline"


def _group_order(group: Sequence[Entity], beside_mm: float) -> Iterator[str]:
    """Yield what is out of order among the paths that end with one outline."""
    ranks = [RANK[entity.layer] for entity in group]
    if ranks != sorted(ranks):
        yield MARKS_FIRST
    path = group[-1].path
    if path is None:
        return
    outline = _region(path).buffer(beside_mm)
    prepare(outline)
    for entity in group[:-1]:
        if entity.path is not None and not outline.contains(Polygon(_ring(entity.path))):
            yield f"{entity.kind} on {entity.layer} comes before an outline that does not hold it"


def shared_order_faults(entities: Sequence[Entity], closed: Closed, beside_mm: float) -> Iterator[str]:
    """Yield what is out of order in a file whose outlines share cuts."""
    outlines = [*_whole(entities), *closed.outlines]
    regions = [_region(outline.path) for outline in outlines]
    exact, grown = STRtree(regions), STRtree([region.buffer(beside_mm) for region in regions])
    rank = [0] * len(outlines)
    for place, entity in enumerate(entities):
        if entity.layer not in RANK or entity.layer == "CUT_OUTER" or entity.path is None:
            continue
        around = grown.query(Polygon(_ring(entity.path)), predicate="covered_by").tolist()
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


def _ring(path: ArcPath) -> Array:
    """Return a ring of points that stands for the path; an open one runs there and back."""
    points = polygon(path, accuracy=POLYGON_MM)
    return points if path.closed and points.shape[0] > 2 else np.concatenate([points, points[::-1]])  # noqa: PLR2004
