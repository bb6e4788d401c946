"""Fill a sheet with true shapes: every place on a grid at once by a fast Fourier transform, then pushed to rest.

Sheet and parts are covered by square cells, every touched cell counted, so that parts without a common cell do not
overlap.  The correlation of both pictures counts the common cells at every place.  Of all the free places the leftmost
is taken, in the angle where the right end comes out least; then the part is pushed down and left until it touches, on
polygons, so that the grid leaves no gaps behind.  Holes of parts are free space.  No clock, no random numbers: counts
are whole numbers, told apart at 1/2, so the rounding of the transform does not matter.

Where a bed has regions, cells that are not wholly in the region of a part's class are taken for it, and it is pushed
against the rim of the region too.  A roll is filled within a length that its parts may need, and within more if it does
not suffice.

Limits: what needs a place exact to the last micron, up to two cells on each side, is found by `boxes` only; one pass,
no part is moved again.

Source: the correlation picture is the discrete form of the no-fit polygon; J. A. Bennell, J. F. Oliveira, "The geometry
of nesting problems: a tutorial", European Journal of Operational Research 184 (2008) 397-415, section 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from shapely import STRtree, box

from stages.nest.blank import Bed, Placed, Region, Turned, as_region, core_at, edges, polygon_at, polygons
from stages.nest.cells import Cells, cover, framed, widest_gap
from stages.nest.slide import NOTHING, Outline, moved, together, way_down, way_left

Picture = NDArray[np.complex64]

FEWEST_CELLS, MOST_CELLS = 20_000, 160_000
"""Cells of a sheet: fewer lose narrow gaps, more cost time without gain once the parts are pushed to rest."""

WORK = 12_000_000
"""Copies times cells that a fill may cost: about 1 s."""

FREE = 0.5
"""Fewer common cells than this are none: counts are whole numbers, single precision errs by some 1e-2."""

HALF_CELL = float(np.sqrt(0.5))
"""A point is at most this far, in cells, from the middle of its cell."""

PUSHES = 3
"""Down and left, this often: parts seldom move after the second time."""

PUSH_CELLS = 3.0
"""How far a part is pushed: the grid costs up to two cells, beyond lies free space that the search has refused."""


LONGER = 1.6
"""A roll is filled within this many times the length that the area of the parts asks for, and so on if need be."""


@dataclass(slots=True)
class Board:
    """A sheet while it is filled: what lies on it, its cells, and the left end known to be the least for each shape.

    pictures: those of the part whose turn it is; of a thousand parts they would fill hundreds of megabytes.
    blocked, rims: for each class of parts, the cells that are not wholly in its region, and the edges of the region.
    """

    bed: Bed
    cell_mm: float
    cells: Cells
    blocked: Sequence[Cells | None]
    rims: Sequence[Outline]
    placed: list[Placed] = field(default_factory=list)
    outlines: list[Outline] = field(default_factory=list)
    pictures: dict[int, Picture] = field(default_factory=dict)
    least: dict[int, int] = field(default_factory=dict)


def fill_raster(
    bed: Bed, queue: Sequence[tuple[int, tuple[Turned, ...]]], already: Sequence[Placed] = ()
) -> list[Placed]:
    """Return what lay on the bed already and the copies of the queue (how many, in which angles) that find room."""
    if not queue or min(bed.width_mm, bed.height_mm) <= 0.0:
        return list(already)
    if not bed.sheet.is_roll:
        return _fill(bed, queue, already)
    wanted = len(already) + sum(count for count, _ in queue)
    length = _first_length(bed, queue, already)
    while len(found := _fill(cut_off(bed, length), queue, already)) < wanted and length < bed.width_mm:
        length *= LONGER
    return found


def _first_length(bed: Bed, queue: Sequence[tuple[int, tuple[Turned, ...]]], already: Sequence[Placed]) -> float:
    """Return a length of a roll in which all copies should find room: by their area, and the longest by itself."""
    area = sum((count * turns[0].shape.area for count, turns in queue if turns), start=0.0)
    longest = max((min(one.width_mm for one in turns) for _, turns in queue if turns), default=0.0)
    used = max((one.right_mm for one in already), default=0.0)
    return max(LONGER * area / max(bed.height_mm, 1.0), longest, used) + longest


def cut_off(bed: Bed, length_mm: float) -> Bed:
    """Return the left end of a bed."""
    if length_mm >= bed.width_mm:
        return bed
    end = box(0.0, 0.0, length_mm, bed.height_mm)
    regions = tuple(None if one is None else as_region(polygons(one.intersection(end))) for one in bed.regions)
    return replace(bed, width_mm=length_mm, regions=regions)


def _fill(bed: Bed, queue: Sequence[tuple[int, tuple[Turned, ...]]], already: Sequence[Placed]) -> list[Placed]:
    board = empty_board(bed, sum(count for count, _ in queue))
    for placed in already:
        _lay(board, placed)
    for count, turns in queue:
        for _ in range(0 if not turns or _hopeless(board, turns) else count):
            if not _place_one(board, turns):
                break
        board.pictures.clear()
    return board.placed


def empty_board(bed: Bed, copies: int) -> Board:
    """Return a board with nothing on it, its grid the finer the fewer copies there are."""
    wanted = int(np.clip(WORK / max(copies, 1), FEWEST_CELLS, MOST_CELLS))
    cell = float(np.sqrt(bed.width_mm * bed.height_mm / wanted))
    rows, columns = int(np.ceil(bed.height_mm / cell)), int(np.ceil(bed.width_mm / cell))
    size = (fft.next_fast_len(rows, real=True), fft.next_fast_len(columns, real=True))
    blocked = [None if region is None else _outside(bed, region, cell, size) for region in bed.regions]
    rims = [NOTHING if region is None else Outline(*edges(region)) for region in bed.regions]
    return Board(bed, cell, np.zeros(size, dtype=np.bool_), blocked, rims)


def _outside(bed: Bed, region: Region, cell_mm: float, size: tuple[int, int]) -> Cells:
    """Return the cells of a bed that are not wholly in a region."""
    rest = box(0.0, 0.0, bed.width_mm, bed.height_mm).difference(region)
    return framed(cover(edges(rest), cell_mm), size)


def _place_one(board: Board, turns: Sequence[Turned]) -> bool:
    """Lay one copy in its best angle; whether there was room."""
    taken = _taken(board, _level(board, turns[0]))
    sheet: Picture = fft.rfft2(taken.astype(np.float32))
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


def _taken(board: Board, level: int) -> Cells:
    """Return the cells that parts of a class cannot have."""
    blocked = board.blocked[level]
    return board.cells if blocked is None else board.cells | blocked


def _hopeless(board: Board, turns: Sequence[Turned]) -> bool:
    """Return whether there is surely no room: nowhere as much as the largest circle in the part needs."""
    rows, columns = (int(np.ceil(size / board.cell_mm)) for size in (board.bed.height_mm, board.bed.width_mm))
    gap = widest_gap(_taken(board, _level(board, turns[0]))[:rows, :columns])
    return turns[0].blank.inner_radius_mm > (gap + HALF_CELL) * board.cell_mm


def _level(board: Board, one: Turned) -> int:
    """Return the class of a part on the bed."""
    return board.bed.level(one.blank.pattern.quality)


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
        cells = framed(cover(one.outline, board.cell_mm), (rows, columns))
        board.pictures[id(one)] = np.conj(fft.rfft2(cells.astype(np.float32)))
    return board.pictures[id(one)]


def _at_rest(board: Board, placed: Placed) -> Placed:
    """Return the part pushed down and left until it touches, or as it was if that would overlap."""
    outline = Outline(*placed.turned.outline)
    level = _level(board, placed.turned)
    fixed = together(_near(board, placed), board.rims[level])
    x, y = placed.x, placed.y
    reach = PUSH_CELLS * board.cell_mm
    for _ in range(PUSHES):
        down = way_down(moved(outline, x, y), fixed, min(reach, y))
        left = way_left(moved(outline, x, y - down), fixed, min(reach, x))
        x, y = x - left, y - down
    rested = Placed(placed.turned, x, y)
    free = free_at(board.placed, placed.turned, x, y) and in_region(board.bed.regions[level], rested)
    return rested if free else placed


def in_region(region: Region | None, placed: Placed) -> bool:
    """Return whether a part lies in a region of a bed; the whole box is not asked."""
    return region is None or region.contains(core_at(placed.turned, placed.x, placed.y))


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
    board.cells |= framed(cover((start, end), board.cell_mm), board.cells.shape)
