"""Which pages of a usual size show a drawing that is larger than they are.

Pages lie in rows and columns about the middle of the drawing, upright or across, whichever takes fewer; neighbours
share a strip of `OVERLAP_MM`.  In the middle of that strip, at a quarter and at three quarters of its length, both of
them show the same two crosses: laid on each other, the pages lie right.  Pages on which there is nothing are left out.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import ceil

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

LEAST_CORNERS = 3
MIDDLE = 0.5
Extent = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Tile:
    """A page by its row (from the top) and column, and the lower left corner of what it shows of the drawing, mm."""

    row: int
    column: int
    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Tiling:
    """Pages of one size: that of the paper, what each shows (mm), how many rows and columns, and those in use."""

    paper_mm: tuple[float, float]
    window_mm: tuple[float, float]
    rows: int
    columns: int
    tiles: tuple[Tile, ...]
    crosses: tuple[tuple[float, float], ...]


def tiling(extent: Extent, paths: Sequence[ArcPath], paper: Paper) -> Tiling:
    """Return the pages that show some paths of that extent, from the top left on, row by row."""
    width, height = PAPERS[paper]
    upright, across = (_grid(extent, size) for size in ((width, height), (height, width)))
    grid = across if across.rows * across.columns < upright.rows * upright.columns else upright
    seen = STRtree([_seen(path) for path in paths])
    tiles = tuple(tile for tile in grid.tiles if seen.query(_window(tile, grid), predicate="intersects").size)
    return Tiling(grid.paper_mm, grid.window_mm, grid.rows, grid.columns, tiles, tuple(_crosses(grid)))


def _grid(extent: Extent, paper_mm: tuple[float, float]) -> Tiling:
    """Return all pages of a size over a drawing, its middle in theirs."""
    window = paper_mm[0] - 2.0 * BORDER_MM, paper_mm[1] - 2.0 * BORDER_MM
    step = window[0] - OVERLAP_MM, window[1] - OVERLAP_MM
    counts, first = list[int](), list[float]()
    for axis in (0, 1):
        long = extent[axis + 2] - extent[axis]
        count = max(ceil((long - OVERLAP_MM) / step[axis]), 1)
        counts.append(count)
        first.append(extent[axis] + MIDDLE * (long - (count * step[axis] + OVERLAP_MM)))
    columns, rows = counts
    tiles = tuple(
        Tile(row + 1, column + 1, first[0] + column * step[0], first[1] + (rows - 1 - row) * step[1])
        for row in range(rows)
        for column in range(columns)
    )
    return Tiling(paper_mm, window, rows, columns, tiles, ())


def _crosses(grid: Tiling) -> Iterator[tuple[float, float]]:
    """Yield the points that two neighbouring pages both show."""
    width, height = grid.window_mm
    for tile in grid.tiles:
        for share in SHARES:
            if tile.column > 1:
                yield tile.x + MIDDLE * OVERLAP_MM, tile.y + share * height
            if tile.row < grid.rows:
                yield tile.x + share * width, tile.y + MIDDLE * OVERLAP_MM


def _window(tile: Tile, grid: Tiling) -> Polygon:
    return box(tile.x, tile.y, tile.x + grid.window_mm[0], tile.y + grid.window_mm[1])


def _seen(path: ArcPath) -> LineString | Polygon | MultiPolygon:
    """Return what a path covers: its inside if it is closed, itself if not."""
    points = polygon(path, accuracy=LOOK_MM)
    return Polygon(points).buffer(0.0) if path.closed and len(points) >= LEAST_CORNERS else LineString(points)
