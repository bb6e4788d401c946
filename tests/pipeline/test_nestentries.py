"""What a report says of stock and wishes comes back as the values it was made from, through JSON."""

import json
from dataclasses import fields

import msgspec
import numpy as np
import pytest

from pipeline.report.document import encoded
from pipeline.report.nestentries import StockEntry, WishEntry, options_entry, sheet_of, stock_entry, wish_entry
from stages.geometry.paths.arcpath import ArcPath
from stages.model.sheet import NestOptions, Sheet, Zone
from tests.stages.nest.shapes import rectangle


def path(size: float) -> ArcPath:
    corners = np.array([[0.1, 0.0], [size, 1.0 / 3.0], [size, size]])
    return ArcPath(corners, np.array([0.0, 0.25, -0.0]), closed=True)


STOCK = {
    "sheet": Sheet("plate", 1000.0, 500.0, quantity=3, edge_gap_mm=5.0, price=12.5),
    "roll": Sheet("coil", np.inf, 500.0, kind="roll", grain_deg=0.0),
    "hide": Sheet(
        "hide", 700.0, 600.0, quantity=1, kind="hide", outline=path(700.0), defects=(path(10.0), path(3.0)),
        zones=(Zone(path(50.0), 2), Zone(path(20.0), -1)), grain_deg=33.3,
    ),
}  # fmt: skip


def same(a: object, b: object) -> bool:
    """Return whether two values hold the same numbers, bit by bit."""
    if isinstance(a, ArcPath) and isinstance(b, ArcPath):
        return a.vertices.tobytes() == b.vertices.tobytes() and a.bulges.tobytes() == b.bulges.tobytes()
    if isinstance(a, Zone) and isinstance(b, Zone):
        return a.quality == b.quality and same(a.outline, b.outline)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b


@pytest.mark.parametrize("kind", STOCK)
def test_stock_comes_back_bit_by_bit(kind: str) -> None:
    sheet = STOCK[kind]
    back = sheet_of(msgspec.json.decode(encoded(stock_entry(sheet)), type=StockEntry))
    assert [
        field.name for field in fields(Sheet) if not same(getattr(back, field.name), getattr(sheet, field.name))
    ] == []


def test_every_wish_for_the_nest_is_told_and_comes_back() -> None:
    options = NestOptions(0.1, (0.0, 90.0), 3.0, 7, True, True, True, 0.2, 50.0)
    entry = json.loads(encoded(options_entry(options)))
    assert list(entry) == [field.name for field in fields(NestOptions)]
    assert msgspec.convert(entry, NestOptions) == options


@pytest.mark.parametrize("rotations", [None, "free", (0.0, 90.0)])
@pytest.mark.parametrize("quality", ["best", "any", 3])
def test_every_wish_of_a_part_is_told_and_comes_back(rotations: object, quality: object) -> None:
    part = rectangle("part", 4.0, 3.0).replace(
        rotations=rotations, quality=quality, axis_deg=12.5, axis_band_deg=5.0, pair=True
    )
    wish = msgspec.json.decode(encoded(wish_entry(part)), type=WishEntry)
    back = (wish.rotations, wish.quality, wish.axis_deg, wish.axis_band_deg, wish.pair)
    assert back == (rotations, quality, 12.5, 5.0, True)
