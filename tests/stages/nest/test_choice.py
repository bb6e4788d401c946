"""The order in which sheets are asked."""

from stages.model.sheet import NestOptions, Sheet
from stages.nest.beds import beds
from stages.nest.blank import Bed
from stages.nest.choice import by_area, by_price, price
from tests.near import assert_near
from tests.stages.nest.shapes import rectangle
from tests.stages.nest.stock import roll


def names(asked: list[Bed]) -> list[str]:
    return [one.sheet.id for one in asked]


def stock(*sheets: Sheet) -> list[Bed]:
    return beds([rectangle("a", 100.0, 100.0, 50)], sheets, NestOptions())


SMALL, LARGE = Sheet("small", 300.0, 300.0, price=30.0), Sheet("large", 600.0, 300.0, price=100.0)


def test_the_smallest_is_asked_for_all_and_the_largest_for_anything() -> None:
    for_all, for_some = by_area(stock(LARGE, SMALL), 1.0)
    assert names(for_all) == ["small", "large"]
    assert names(for_some) == ["large", "small"]


def test_a_dear_sheet_is_not_asked_for_all_where_several_cheap_ones_cost_less() -> None:
    room = stock(LARGE, SMALL)
    assert names(by_price(room, 150_000.0)[0]) == ["small"]
    assert names(by_price(room, 400_000.0)[0]) == ["small", "large"], "five small ones cost 150"
    assert names(by_price(room, 1.0)[1]) == ["small", "large"]
    assert by_price([], 1.0) == ([], [])


def test_a_roll_costs_by_the_length_that_the_parts_need_at_least() -> None:
    (coil, _) = stock(roll("coil", 300.0, price=50.0), SMALL)
    assert_near(price(coil, 300_000.0), 50.0, bound=1e-4, why="one metre; the slack of the height is 1e-9 of it")
