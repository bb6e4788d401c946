"""Instances that are made, not stored: jigsaws, a ring with something to lie in its hole, and many different parts."""

from math import cos, pi, sin
from random import Random

from tests.bench.nest.instances import (
    Bin,
    Box,
    File,
    Instance,
    Item,
    Rectangle,
    Ring,
    Rings,
    Simple,
    WithHoles,
    instance,
)
from tests.bench.nest.jigsaw import SEEDS, jigsaw

RING_MM, HOLE_MM, SQUARE_MM = 200.0, 105.0, 100.0
"""The hole leaves the square half a millimetre more than the gap on every side."""
GAP_MM, EDGE_MM, PLAY_MM = 2.0, 5.0, 4.0
"""Play of the ring on its sheet: some engines refuse an exact fit."""

RADII_MM = 20.0, 120.0
CORNERS = 6, 14
SHEET_MM = 3000.0, 1500.0


def made() -> list[Instance]:
    """Return the instances that go with the stored ones."""
    jigsaws = [instance(f"strip_jigsaw20-s{seed}", jigsaw(seed)) for seed in SEEDS]
    return [*jigsaws, instance("ring_gap2", ring())]


def ring() -> File:
    """Return a square ring and a square on sheets with room for the ring only: in its hole, one sheet is enough."""
    frame = WithHoles(Rings(_square(RING_MM), [_square(HOLE_MM, (RING_MM - HOLE_MM) / 2.0)]))
    side = RING_MM + 2.0 * EDGE_MM + PLAY_MM
    items = [Item(0, 1, frame), Item(1, 1, Simple(_square(SQUARE_MM)))]
    return File(items, bins=[_sheet(side, side)], min_item_separation=GAP_MM, min_edge_separation=EDGE_MM)


def many(count: int, seed: int = 1) -> File:
    """Return so many different star-shaped parts, to be turned as one likes, on sheets of 3000 x 1500 mm."""
    random = Random(seed)
    items = [Item(number, 1, Simple(_star(random))) for number in range(count)]
    return File(items, bins=[_sheet(*SHEET_MM)], min_item_separation=GAP_MM, min_edge_separation=EDGE_MM)


def _sheet(width: float, height: float) -> Bin:
    return Bin(0, Rectangle(Box(0.0, 0.0, width, height)))


def _square(side: float, at: float = 0.0) -> Ring:
    return [(at, at), (at + side, at), (at + side, at + side), (at, at + side)]


def _star(random: Random) -> Ring:
    """Return a polygon around the origin whose corners lie at equal angles and random distances."""
    corners = random.randint(*CORNERS)
    size = random.uniform(*RADII_MM)
    radii = [size * random.uniform(0.5, 1.0) for _ in range(corners)]
    angles = [2.0 * pi * k / corners for k in range(corners)]
    return [(r * cos(a), r * sin(a)) for r, a in zip(radii, angles, strict=True)]
