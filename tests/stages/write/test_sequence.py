"""The order in which a file is cut."""

from io import StringIO

import ezdxf
import numpy as np
import pytest

from stages.geometry.paths.arcpath import ArcPath
from stages.write import write
from stages.write.chains import Entity
from stages.write.closing import Closed
from stages.write.sequence import MARKS_FIRST, order_faults, shared_order_faults
from tests.stages.write.patterns import nesting, plate, sector
from tests.stages.write.planted import MACHINE, codes


def test_a_hole_after_its_own_outline_but_before_another_is_out_of_order() -> None:
    outcome = write([plate(), sector()], nesting(), MACHINE)
    text = next(file.text for file in outcome.product if file.path == "cut/stock-1.dxf")
    document = ezdxf.read(StringIO(text))
    space = document.modelspace()
    entities = list(space)
    holes = [i for i, e in enumerate(entities) if e.dxf.layer == "CUT_INNER"]
    outlines = [i for i, e in enumerate(entities) if e.dxf.layer == "CUT_OUTER"]
    moved = entities.pop(holes[0])
    entities.insert(outlines[0], moved)
    for entity in entities:
        space.unlink_entity(entity)
        space.add_entity(entity)
    stream = StringIO()
    document.write(stream)
    assert "readback-order" in codes(stream.getvalue())


BESIDE_MM = 0.05


def path(layer: str, *points: tuple[float, float], closed: bool = True) -> Entity:
    made = ArcPath(np.array(points, dtype=np.float64), np.zeros(len(points)), closed)
    return Entity("LWPOLYLINE", layer, 1, made, closed)


def square(layer: str, x: float, y: float, wide: float) -> Entity:
    return path(layer, (x, y), (x + wide, y), (x + wide, y + wide), (x, y + wide))


OUTER = square("CUT_OUTER", 0.0, 0.0, 10.0)
OTHER = square("CUT_OUTER", 20.0, 0.0, 10.0)
HOLE = square("CUT_INNER", 2.0, 2.0, 1.0)
MARK = path("MARK", (5.0, 5.0), (6.0, 5.0), closed=False)
NOT_HELD = ["LWPOLYLINE on MARK comes before an outline that does not hold it"]
NOT_BEFORE = "LWPOLYLINE on MARK does not come before an outline that holds it"


def line_to(x: float) -> Entity:
    return path("MARK", (5.0, 5.0), (x, 5.0), closed=False)


@pytest.mark.parametrize(
    ("entities", "told"),
    [
        ([MARK, HOLE, OUTER, OTHER], []),
        ([HOLE, MARK, OUTER], [MARKS_FIRST]),
        ([MARK, HOLE, OTHER, OUTER], [*NOT_HELD, NOT_HELD[0].replace("MARK", "CUT_INNER")]),
        ([line_to(10.0), OUTER], []),
        ([line_to(10.0 + 0.9 * BESIDE_MM), OUTER], []),
        ([line_to(10.0 + 1.1 * BESIDE_MM), OUTER], NOT_HELD),
        ([OTHER, line_to(25.0), OUTER], NOT_HELD),
        ([OUTER, MARK, HOLE], ["2 marks or holes come after the last outline"]),
        ([MARK], ["1 marks or holes come after the last outline"]),
        ([], []),
    ],
)
def test_what_an_outline_must_hold(entities: list[Entity], told: list[str]) -> None:
    assert list(order_faults(entities, BESIDE_MM)) == told


def test_what_is_no_path_has_its_place_in_the_order_alone() -> None:
    point = Entity("POINT", "CUT_INNER", 5, None, closed=False)
    assert list(order_faults([MARK, point, OUTER], BESIDE_MM)) == []
    assert list(order_faults([point, MARK, OUTER], BESIDE_MM)) == [MARKS_FIRST]


@pytest.mark.parametrize(("beyond", "told"), [(0.9, []), (1.1, [NOT_BEFORE])])
def test_where_cuts_are_shared_an_outline_holds_what_reaches_a_hair_beyond_it(beyond: float, told: list[str]) -> None:
    entities = [line_to(10.0 + beyond * BESIDE_MM), OUTER]
    assert list(shared_order_faults(entities, Closed((), ()), BESIDE_MM)) == told
