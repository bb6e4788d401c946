"""Which pages of a usual size show a drawing that is larger than they are.

Pages lie in rows and columns about the middle of the drawing, upright or across, whichever takes fewer; neighbours
share a strip of `OVERLAP_MM`.  In the middle of that strip, at a quarter and at three quarters of its length, both of
them show the same two crosses: laid on each other, the pages lie right.  Pages on which there is nothing are left out.

Not for a drawing of more than `MOST_PAGES`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from shapely import LineString, MultiPolygon, Polygon, STRtree, box

from stages.geometry.paths.arcpath import ArcPath, polygon
from stages.model.cutfile import Paper

PAPERS: dict[Paper, tuple[float, float]] = {"A4": (210.0, 297.0), "A3": (297.0, 420.0)}
"""Width and height in mm (ISO 216)."""

BORDER_MM = 12.0
"""Around what a page shows: what printers leave white, and room for the check line."""

OVERLAP_MM = 10.0
SHARES = 0.25, 0.75
LOOK_MM = 0.05
"""How near the polygons come to the paths by which it is seen whether a page shows anything."""

MOST_PAGES = 500
"""A ream, which is 23 m2 of A4: whoever draws more prints it from a roll."""

LEAST_CORNERS = 3
MIDDLE = 0.5
Extent = tuple[float, float, float, float]
Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Grid:
    """All pages of a size over a drawing: that of the paper, what each shows, how many, the lower left corner; mm."""

    paper_mm: tuple[float, float]
    window_mm: tuple[float, float]
    rows: int
    columns: int
    first: Place

    def corner(self, row: int, column: int) -> Place:
        """Return the lower left corner of what a page shows of the drawing, mm; rows count from the top."""
        width, height = self.window_mm
        across, up = column - 1, self.rows - row
        return self.first[0] + across * (width - OVERLAP_MM), self.first[1] + up * (height - OVERLAP_MM)


@dataclass(frozen=True, slots=True)
class Tile:
    """A page by its row (from the top) and column, and the lower left corner of what it shows of the drawing, mm."""

    row: int
    column: int
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Tiling:
    """The pages of a grid that are in use."""

    grid: Grid
    tiles: tuple[Tile, ...]


def tiling(extent: Extent, paths: Sequence[ArcPath], paper: Paper) -> Tiling | None:
    """Return the pages that show some paths of that extent, from the top left on, row by row.

    None if they are more than `MOST_PAGES`.  What is in one piece and spans r rows and c columns shows on r + c - 1 of
    them or more: neighbours overlap, so that one step leads to a row or a column.  Beyond that it is not looked at.
    """
    grid = grid_of(extent, paper)
    if grid.rows + grid.columns - 1 > MOST_PAGES:
        return None
    places = [(row, column) for row in range(1, grid.rows + 1) for column in range(1, grid.columns + 1)]
    low = np.array([grid.corner(*place) for place in places])
    windows = STRtree(box(*low.T, *(low + grid.window_mm).T))
    seen = np.unique(windows.query([_seen(path) for path in paths], predicate="intersects")[1]).tolist()
    if len(seen) > MOST_PAGES:
        return None
    shown = ((*places[i], *grid.corner(*places[i])) for i in seen)
    return Tiling(grid, tuple(Tile(row, column, x, y) for row, column, x, y in shown))


def grid_of(extent: Extent, paper: Paper) -> Grid:
    """Return the pages over a drawing, upright or across, whichever are fewer."""
    width, height = PAPERS[paper]
    upright, across = (_grid(extent, size) for size in ((width, height), (height, width)))
    return across if across.rows * across.columns < upright.rows * upright.columns else upright


def _grid(extent: Extent, paper_mm: tuple[float, float]) -> Grid:
    """Return all pages of a size over a drawing, its middle in theirs."""
    window = paper_mm[0] - 2.0 * BORDER_MM, paper_mm[1] - 2.0 * BORDER_MM
    counts, first = list[int](), list[float]()
    for axis in (0, 1):
        long, step = extent[axis + 2] - extent[axis], window[axis] - OVERLAP_MM
        count = max(ceil((long - OVERLAP_MM) / step), 1)
        counts.append(count)
        first.append(extent[axis] + MIDDLE * (long - (count * step + OVERLAP_MM)))
    columns, rows = counts
    return Grid(paper_mm, window, rows, columns, (first[0], first[1]))


def crosses(tile: Tile, grid: Grid) -> Iterator[Place]:
    """Yield the points that a page and its neighbours in the grid both show."""
    width, height = grid.window_mm
    for column in (tile.column, tile.column + 1):
        if 1 < column <= grid.columns:
            x, y = grid.corner(tile.row, column)
            yield from ((x + MIDDLE * OVERLAP_MM, y + share * height) for share in SHARES)
    for row in (tile.row, tile.row - 1):
        if 1 <= row < grid.rows:
            x, y = grid.corner(row, tile.column)
            yield from ((x + share * width, y + MIDDLE * OVERLAP_MM) for share in SHARES)


def _seen(path: ArcPath) -> LineString | Polygon | MultiPolygon:
    """Return what a path covers: its inside if it is closed, itself if not."""
    points = polygon(path, accuracy=LOOK_MM)
    return Polygon(points).buffer(0.0) if path.closed and len(points) >= LEAST_CORNERS else LineString(points)
