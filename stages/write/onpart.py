"""Strokes of a text cut off where they leave the part: nothing is engraved into its neighbour or into a hole.

The part is a polygon within `POLYGON_MM` of its contours; what is left of a stroke and too short to engrave goes too.
"""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from shapely import LineString, Polygon, get_parts, prepare
from shapely.geometry.base import BaseGeometry

from stages.geometry.arrays import Points2
from stages.geometry.paths.arcpath import ArcPath, polygon
from stages.geometry.paths.biarc import LEAST_PIECE_MM

POLYGON_MM = 0.01


def region_of(contours: Sequence[ArcPath]) -> BaseGeometry:
    """Return the region of a part, of its outline first and of its holes."""
    outer, *inner = (Polygon(polygon(path, accuracy=POLYGON_MM)) for path in contours)
    region: BaseGeometry = outer.buffer(0.0)
    for hole in inner:
        region = region.difference(hole.buffer(0.0))
    prepare(region)
    return region


def on_part(strokes: Iterable[ArcPath], region: BaseGeometry) -> list[ArcPath]:
    """Return the strokes that lie on a part as they are, and of the others what does."""
    return [left for stroke in strokes for left in _on_part(stroke, region)]


def _on_part(stroke: ArcPath, region: BaseGeometry) -> Iterator[ArcPath]:
    line = LineString(np.vstack([stroke.vertices, stroke.vertices[:1]]) if stroke.closed else stroke.vertices)
    if region.covers(line):
        yield stroke
        return
    for part in get_parts(line.intersection(region)):
        if isinstance(part, LineString) and part.length >= LEAST_PIECE_MM:
            corners: Points2 = np.array(part.coords)
            yield ArcPath(corners, np.zeros(corners.shape[0]), closed=False)
