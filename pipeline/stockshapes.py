"""Closed curves of the job file -> paths of lines and arcs on the safe side, with what had to be put right.

Lines and arcs stay as they are.  Any other curve is approximated: an outline is at most `CHORD_MM` smaller than drawn,
a defect or a zone at most that larger.
"""

from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from stages.construct.stockoutline import NoContourError, closed_edges
from stages.errors import NoSolutionError
from stages.geometry.paths.arcpath import ArcPath
from stages.geometry.paths.usable import Blocked, Kept, NoAreaError, inside, outside, touch, within
from stages.model.curves import CurveSpec, Trouble, is_whole
from stages.model.tolerances import Tolerances

if TYPE_CHECKING:
    from pipeline.stocktables import StockTable

CHORD_MM = 0.2
"""By so much stock that is drawn with splines is taken too small at most: what a knife cutter is off."""

JOIN_MM = Tolerances().join_mm
REMEMBERED = 1024
"""Curves whose shapes are kept from the check of the job file to its run."""

T = TypeVar("T")


@lru_cache(maxsize=REMEMBERED)
def kept(spec: CurveSpec) -> Kept:
    """Return an outline from inside; `NoContourError` for what is none."""
    return _shaped(lambda: inside(closed_edges(spec, join_mm=JOIN_MM), accuracy=CHORD_MM))


@lru_cache(maxsize=REMEMBERED)
def blocked(spec: CurveSpec) -> Blocked:
    """Return a defect or a zone from outside; `NoContourError` for what is none."""
    return _shaped(lambda: outside(closed_edges(spec, join_mm=JOIN_MM), accuracy=CHORD_MM))


def _shaped(make: Callable[[], T]) -> T:
    try:
        return make()
    except NoAreaError:
        raise NoContourError("the curve encloses no area", "give a contour that goes round something") from None
    except NoSolutionError as error:
        raise NoContourError(f"the curve is too fine to be followed: {error}", "simplify it") from None


def edge_of(row: "StockTable") -> ArcPath | None:
    """Return the edge of a stock as a path; None for a roll, whose edge does not close, and where no size is known."""
    if row.outline is not None:
        return kept(row.outline).path
    if row.width is None or row.height is None:
        return None
    width, height = float(row.width), float(row.height)
    return ArcPath(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]), np.zeros(4), closed=True)


def shape_troubles(row: "StockTable") -> Iterator[Trouble]:
    """Yield the outlines of a stock that are no closed contours round an area, and what lies beside the stock.

    A curve that is wrong in itself is passed over: it has been complained about.
    """
    known = row.outline is None or is_whole(row.outline)
    wrong = None if row.outline is None or not known else _wrong(kept, row.outline)
    if wrong is not None:
        yield Trouble("outline", wrong.message, wrong.hint)
    edge = None if wrong is not None or not known else edge_of(row)
    covering = [(f"defects[{i}]", defect) for i, defect in enumerate(row.defects)]
    covering += [(f"zones[{i}].outline", zone.outline) for i, zone in enumerate(row.zones)]
    for key, spec in ((key, spec) for key, spec in covering if is_whole(spec)):
        error = _wrong(blocked, spec)
        if error is not None:
            yield Trouble(key, error.message, error.hint)
        elif edge is not None and not any(touch(edge, path, accuracy=CHORD_MM) for path in blocked(spec).paths):
            yield Trouble(key, "it lies beside the stock", "give it in the frame of the outline, or leave it out")


def _wrong(shape: Callable[[CurveSpec], object], spec: CurveSpec) -> NoContourError | None:
    try:
        shape(spec)
    except NoContourError as error:
        return error
    return None


def reaching(row: "StockTable") -> list[int]:
    """Return the numbers of the defects that touch or cross the edge of the stock."""
    edge = edge_of(row)
    if edge is None:
        return []
    return [
        i
        for i, spec in enumerate(row.defects)
        if not all(within(path, edge, accuracy=CHORD_MM) for path in blocked(spec).paths)
    ]
