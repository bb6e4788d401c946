"""Fill a sheet with true shapes: every place on a grid at once by a fast Fourier transform, then pushed to rest.

Sheet and parts are covered by square cells, every touched cell counted, so that parts without a common cell do not
overlap.  The correlation of both pictures counts the common cells at every place.  Of all the free places the leftmost
is taken, in the angle where the right end comes out least; then the part is pushed down and left until it touches, on
polygons, so that the grid leaves no gaps behind.  Holes of parts are free space.  No clock, no random numbers: counts
are whole numbers, told apart at 1/2, so the rounding of the transform does not matter.

Limits: what needs a place exact to the last micron is found by `boxes` only; one pass, no part is moved again.

Source: the correlation picture is the discrete form of the no-fit polygon; J. A. Bennell, J. F. Oliveira, "The geometry
of nesting problems: a tutorial", European Journal of Operational Research 184 (2008) 397-415, section 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from shapely import STRtree

from stages.geometry.arrays import Array, Points2, Values
from stages.nest.blank import Bed, Placed, Turned, core_at, edges, polygon_at
from stages.nest.slide import NOTHING, Outline, moved, together, way_down, way_left

Numbers = NDArray[np.int64]
Cells = NDArray[np.bool_]
Picture = NDArray[np.complex64]

FEWEST_CELLS, MOST_CELLS = 20_000, 160_000
"""Cells of a sheet: fewer lose narrow gaps, more cost time without gain once the parts are pushed to rest."""

WORK = 12_000_000
"""Copies times cells that a fill may cost: about 1 s."""

FREE = 0.5
"""Fewer common cells than this are none: counts are whole numbers, single precision errs by some 1e-2."""

INWARD = 1e-6
"""Edges on a grid line count for the cell inside; in cells."""

PUSHES = 3
"""Down and left, this often: parts seldom move after the second time."""

PUSH_CELLS = 3.0
"""How far a part is pushed: the grid costs up to two cells, beyond lies free space that the search has refused."""


@dataclass(slots=True)
class Board:
    """A sheet while it is filled: what lies on it, its cells, and the left end known to be the least for each shape."""

    bed: Bed
    cell_mm: float
    cells: Cells
    placed: list[Placed] = field(default_factory=list)
    outlines: list[Outline] = field(default_factory=list)
    pictures: dict[int, Picture] = field(default_factory=dict)
    least: dict[int, int] = field(default_factory=dict)


def fill_raster(
    bed: Bed, queue: Sequence[tuple[int, tuple[Turned, ...]]], already: Sequence[Placed] = ()
) -> list[Placed]:
    """Return what lay on the bed already and the copies of the queue (how many, in which angles) that find room."""
    board = empty_board(bed, sum(count for count, _ in queue))
    for placed in already:
        _lay(board, placed)
    for count, turns in queue:
        for _ in range(count):
            if not _place_one(board, turns):
                break
    return board.placed


def empty_board(bed: Bed, copies: int) -> Board:
    """Return a board with nothing on it, its grid the finer the fewer copies there are."""
    wanted = int(np.clip(WORK / max(copies, 1), FEWEST_CELLS, MOST_CELLS))
    cell = np.sqrt(bed.width_mm * bed.height_mm / wanted)
    rows, columns = int(np.ceil(bed.height_mm / cell)), int(np.ceil(bed.width_mm / cell))
    size = (fft.next_fast_len(rows, real=True), fft.next_fast_len(columns, real=True))
    return Board(bed, float(cell), np.zeros(size, dtype=np.bool_))


def _place_one(board: Board, turns: Sequence[Turned]) -> bool:
    """Lay one copy in its best angle; whether there was room."""
    sheet: Picture = fft.rfft2(board.cells.astype(np.float32))
    best: tuple[float, float, float, int] | None = None
    for number, one in enumerate(turns):
        bound = board.least.get(id(one), 0) * board.cell_mm + one.width_mm
        if best is not None and bound > best[0]:
            continue
        spot = _leftmost(board, sheet, one)
        if spot is not None:
            row, column = spot
            found = (column * board.cell_mm + one.width_mm, row * board.cell_mm, column * board.cell_mm, number)
            best = found if best is None else min(best, found)
    if best is None:
        return False
    _lay(board, _at_rest(board, Placed(turns[best[3]], best[2], best[1])))
    return True


def _leftmost(board: Board, sheet: Picture, one: Turned) -> tuple[int, int] | None:
    """Return row and column of the leftmost free place of a shape, the lowest there; None if there is none."""
    rows = int((board.bed.height_mm - one.height_mm) / board.cell_mm) + 1
    columns = int((board.bed.width_mm - one.width_mm) / board.cell_mm) + 1
    first = board.least.get(id(one), 0)
    if first >= columns:
        return None
    picture = _picture(board, one)
    common = fft.irfft2(sheet * picture, s=board.cells.shape)[:rows, first:columns]
    free = common < FREE
    column = int(free.any(axis=0).argmax())
    if not free[:, column].any():
        board.least[id(one)] = columns
        return None
    board.least[id(one)] = first + column
    return int(free[:, column].argmax()), first + column


def _picture(board: Board, one: Turned) -> Picture:
    """Return the transform of a shape, conjugated for the correlation."""
    if id(one) not in board.pictures:
        rows, columns = board.cells.shape
        covered = cover(one.outline, board.cell_mm)[:rows, :columns]
        cells = np.zeros((rows, columns), dtype=np.float32)
        cells[: len(covered), : covered.shape[1]] = covered
        board.pictures[id(one)] = np.conj(fft.rfft2(cells))
    return board.pictures[id(one)]


def _at_rest(board: Board, placed: Placed) -> Placed:
    """Return the part pushed down and left until it touches, or as it was if that would overlap."""
    outline = Outline(*placed.turned.outline)
    fixed = _near(board, placed)
    x, y = placed.x, placed.y
    reach = PUSH_CELLS * board.cell_mm
    for _ in range(PUSHES):
        down = way_down(moved(outline, x, y), fixed, min(reach, y))
        left = way_left(moved(outline, x, y - down), fixed, min(reach, x))
        x, y = x - left, y - down
    return Placed(placed.turned, x, y) if free_at(board.placed, placed.turned, x, y) else placed


def _near(board: Board, placed: Placed) -> Outline:
    """Return the edges of what lies within two pushes of a part."""
    reach = 2.0 * PUSH_CELLS * board.cell_mm
    near = NOTHING
    for other, outline in zip(board.placed, board.outlines, strict=True):
        if _boxes_near(placed, other, reach):
            near = together(near, outline)
    return near


def _boxes_near(a: Placed, b: Placed, reach_mm: float) -> bool:
    return (
        a.x < b.right_mm + reach_mm
        and b.x < a.right_mm + reach_mm
        and a.y < b.y + b.turned.height_mm + reach_mm
        and b.y < a.y + a.turned.height_mm + reach_mm
    )


def free_at(placed: Sequence[Placed], one: Turned, x: float, y: float) -> bool:
    """Return whether a shape at (x, y) overlaps none of those placed."""
    near = [polygon_at(other) for other in placed if _boxes_near(Placed(one, x, y), other, 0.0)]
    return not near or STRtree(near).query(core_at(one, x, y), predicate="intersects").size == 0


def _lay(board: Board, placed: Placed) -> None:
    """Put a part on the board: its polygon, its edges, its cells."""
    start, end = edges(polygon_at(placed))
    board.placed.append(placed)
    board.outlines.append(Outline(start, end))
    covered = cover((start, end), board.cell_mm)
    covered = covered[: board.cells.shape[0], : board.cells.shape[1]]
    board.cells[: len(covered), : covered.shape[1]] |= covered


def cover(outline: tuple[Points2, Points2], cell_mm: float) -> Cells:
    """Return the cells, counted from the origin, that a polygon with its inside to the left touches."""
    start, end = outline[0] / cell_mm, outline[1] / cell_mm
    size = np.ceil(np.maximum(start.max(axis=0), 0.0)).astype(np.int64) + 1
    cells = _inside(start, end, (int(size[1]), int(size[0])))
    edge, share = _stretches(start, end)
    along = end - start
    inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
    inward *= INWARD / np.maximum(np.linalg.norm(inward, axis=1), INWARD)[:, None]
    point = start[edge] + share[:, None] * along[edge] + inward[edge]
    column, row = np.clip(np.floor(point), 0, size - 1).astype(np.int64).T
    cells[row, column] = True
    return cells


def _stretches(start: Points2, end: Points2) -> tuple[Numbers, Array]:
    """Return, for every stretch of an edge between two grid lines, the edge and the share of the way to its middle."""
    edge = [np.arange(start.shape[0]), np.arange(start.shape[0])]
    share = [np.zeros(start.shape[0]), np.ones(start.shape[0])]
    for axis in range(2):
        low, high = np.minimum(start[:, axis], end[:, axis]), np.maximum(start[:, axis], end[:, axis])
        which, line = _whole_numbers(np.floor(low) + 1.0, np.ceil(high))
        edge.append(which)
        share.append((line - start[which, axis]) / (end - start)[which, axis])
    every, at = np.concatenate(edge), np.concatenate(share)
    order = np.lexsort((at, every))
    every, at = every[order], at[order]
    same = every[1:] == every[:-1]
    return every[:-1][same], ((at[1:] + at[:-1]) / 2.0)[same]


def _whole_numbers(low: Values, high: Values) -> tuple[Numbers, Array]:
    """Return the whole numbers from each low up to and without its high: index of the pair, number."""
    count = np.maximum(high - low, 0.0).astype(np.int64)
    which = np.repeat(np.arange(low.size), count)
    return which, low[which] + (np.arange(which.size) - np.repeat(np.cumsum(count) - count, count))


def _inside(start: Points2, end: Points2, size: tuple[int, int]) -> Cells:
    """Return the cells whose middle lies inside, by the parity of crossings along each row."""
    low, high = np.minimum(start[:, 1], end[:, 1]) - 0.5, np.maximum(start[:, 1], end[:, 1]) - 0.5
    which, line = _whole_numbers(np.ceil(low), np.ceil(high))
    row = line.astype(np.int64)
    share = (line + 0.5 - start[which, 1]) / (end - start)[which, 1]
    x = start[which, 0] + share * (end - start)[which, 0]
    column = np.ceil(x - 0.5).astype(np.int64)
    crossings = np.zeros(size, dtype=np.int64)
    keep = (row >= 0) & (row < size[0]) & (column < size[1])
    np.add.at(crossings, (row[keep], np.maximum(column[keep], 0)), 1)
    inside: Cells = np.cumsum(crossings, axis=1) % 2 == 1
    return inside
