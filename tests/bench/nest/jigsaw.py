"""Jigsaws: a rectangle cut into interlocking pieces, turned and shuffled, so that the densest layout is known.

A grid of cells of 200 x 150 mm; every inner node is moved by up to `NODE` of a cell, every inner edge is bent at a
point `ALONG` of its length from its middle at most, by `BEND` of its length, all at random.  Bent edges leave their
nodes within 38 degrees (rows) and 49 degrees (columns) of the lines of the grid, and stay within half a cell of them:
pieces are simple polygons and do not overlap.  Neighbours share their corners, multiples of 1e-4 mm.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain
from random import Random

from tests.bench.nest.instances import Corner, File, Item, Ring, Simple

CELL_MM = (200.0, 150.0)
NODE, ALONG, BEND = 0.13, 0.15, (0.05, 0.15)
DIGITS = 4
SLACK = 1.0001
"""The strip is higher than the rectangle by this: engines that round to single precision refuse an exact fit."""

SEEDS = range(1, 6)
QUARTERS = (0.0, 90.0, 180.0, 270.0)


@dataclass(frozen=True, slots=True)
class Piece:
    """One piece where it was cut, and how often it is then turned by 90 degrees."""

    corners: tuple[Corner, ...]
    quarters: int


def grid(pieces: int) -> tuple[int, int]:
    """Return columns and rows of a grid of that many cells, as square as can be, columns first."""
    rows = max(count for count in range(1, int(pieces**0.5) + 1) if pieces % count == 0)
    return pieces // rows, rows


def cut(seed: int, pieces: int = 20) -> list[Piece]:
    """Return the pieces of a rectangle from the origin, in the order in which they are handed out."""
    random, (columns, rows) = Random(seed), grid(pieces)
    nodes = {(i, j): _node(random, i, j, columns, rows) for i in range(columns + 1) for j in range(rows + 1)}
    across = {(i, j): _edge(random, nodes[i, j], nodes[i + 1, j], 0 < j < rows) for i, j in nodes if i < columns}
    along = {(i, j): _edge(random, nodes[i, j], nodes[i, j + 1], 0 < i < columns) for i, j in nodes if j < rows}
    cells = [(i, j) for i in range(columns) for j in range(rows)]
    random.shuffle(cells)
    return [
        Piece(_around(across[i, j], along[i + 1, j], across[i, j + 1], along[i, j]), random.randrange(4))
        for i, j in cells
    ]


def jigsaw(seed: int, pieces: int = 20) -> File:
    """Return the pieces as an instance: each turned, its box at the origin, for a strip just as high as they need."""
    columns, rows = grid(pieces)
    items = [
        Item(number, 1, Simple(_at_origin(turned(piece))), list(QUARTERS))
        for number, piece in enumerate(cut(seed, pieces))
    ]
    height, length = rows * CELL_MM[1] * SLACK, columns * CELL_MM[0]
    return File(items, f"jigsaw{pieces}-s{seed}", round(height, DIGITS), known_optimal_length=length)


def turned(piece: Piece) -> Ring:
    """Return the corners turned about the origin."""
    ring = list(piece.corners)
    for _ in range(piece.quarters):
        ring = [(-y, x) for x, y in ring]
    return ring


def _node(random: Random, i: int, j: int, columns: int, rows: int) -> Corner:
    """Return a node of the grid, moved if it lies inside; on a side it moves along that side, a corner stays."""
    dx, dy = random.uniform(-NODE, NODE), random.uniform(-NODE, NODE)
    x = (i + (dx if 0 < i < columns else 0.0)) * CELL_MM[0]
    y = (j + (dy if 0 < j < rows else 0.0)) * CELL_MM[1]
    return round(x, DIGITS), round(y, DIGITS)


def _edge(random: Random, a: Corner, b: Corner, inner: bool) -> Ring:
    """Return an edge from a to b, bent if it lies inside."""
    if not inner:
        return [a, b]
    share = 0.5 + random.uniform(-ALONG, ALONG)
    bend = random.choice((-1.0, 1.0)) * random.uniform(*BEND)
    dx, dy = b[0] - a[0], b[1] - a[1]
    middle = a[0] + share * dx - bend * dy, a[1] + share * dy + bend * dx
    return [a, (round(middle[0], DIGITS), round(middle[1], DIGITS)), b]


def _around(bottom: Ring, right: Ring, top: Ring, left: Ring) -> tuple[Corner, ...]:
    """Return the corners of a cell counter-clockwise."""
    sides: Iterable[Ring] = (bottom[:-1], right[:-1], top[:0:-1], left[:0:-1])
    return tuple(chain.from_iterable(sides))


def _at_origin(ring: Ring) -> Ring:
    x, y = min(x for x, _ in ring), min(y for _, y in ring)
    return [(round(a - x, DIGITS), round(b - y, DIGITS)) for a, b in ring]
