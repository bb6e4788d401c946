"""Faults planted among the entities of each flavour: lines and arcs, old polylines."""

from collections.abc import Callable
from io import StringIO

import pytest
from ezdxf.document import Drawing as Document
from ezdxf.entities import DXFEntity

from stages.model.cutfile import Flavour, Machine, Version
from tests.stages.write.cases import document, good, told


def changed(how: Machine, change: Callable[[Document], None]) -> str:
    found = document(good(how))
    # the library forgets them where there is no layout
    found.modelspace().reset_extents(found.header["$EXTMIN"], found.header["$EXTMAX"])
    change(found)
    stream = StringIO()
    found.write(stream)
    text = stream.getvalue()
    if how.version == "R12":
        text = text.replace("  9\n$LUNITS\n", "  9\n$INSUNITS\n 70\n4\n  9\n$MEASUREMENT\n 70\n1\n  9\n$LUNITS\n", 1)
    return text


def outer(found: Document) -> list[DXFEntity]:
    return [entity for entity in found.modelspace() if entity.dxf.layer == "CUT_OUTER"]


def lose_one(found: Document) -> None:
    found.modelspace().delete_entity(outer(found)[2])


def shift_one(found: Document) -> None:
    outer(found)[2].translate(0.0, 1e-3, 0.0)


def swap_two(found: Document) -> None:
    space, some = found.modelspace(), outer(found)
    order = [*some[:1], some[2], some[1], *some[3:]]
    for entity in order:
        space.unlink_entity(entity)
        space.add_entity(entity)


def twice(found: Document) -> None:
    space = found.modelspace()
    for entity in outer(found):
        space.add_entity(entity.copy())


def bend_other_way(found: Document) -> None:
    arc = next(entity for entity in outer(found) if entity.dxftype() == "ARC")
    # the arc over the same chord on its other side
    middle = (arc.start_point + arc.end_point) / 2.0
    arc.dxf.center = 2.0 * middle - arc.dxf.center
    arc.dxf.start_angle, arc.dxf.end_angle = (arc.dxf.start_angle + 180.0) % 360.0, (arc.dxf.end_angle + 180.0) % 360.0


def grow_arc(found: Document) -> None:
    arc = next(entity for entity in outer(found) if entity.dxftype() == "ARC")
    arc.dxf.radius += 1e-3


def outline_first(found: Document) -> None:
    space = found.modelspace()
    for entity in [entity for entity in space if entity.dxf.layer != "CUT_OUTER"]:
        space.unlink_entity(entity)
        space.add_entity(entity)


def other_colour(found: Document) -> None:
    for entity in outer(found):
        entity.dxf.color = 256


def extents(found: Document) -> None:
    high = (100.0, 60.5, 0.0)
    found.modelspace().reset_extents((0.0, 0.0, 0.0), high)
    found.header["$EXTMAX"] = high


LOOSE: list[tuple[str, Callable[[Document], None]]] = [
    ("readback-open-contour", lose_one),
    ("readback-open-contour", shift_one),
    ("readback-open-contour", swap_two),
    ("readback-open-contour", grow_arc),
    ("readback-duplicate", twice),
    ("readback-content", bend_other_way),
    ("readback-order", outline_first),
    ("readback-colour", other_colour),
    ("readback-extents", extents),
]


@pytest.mark.parametrize("version", ["R12", "R2000"])
@pytest.mark.parametrize(("code", "change"), LOOSE)
def test_a_fault_among_lines_and_arcs_is_found(version: Version, code: str, change: Callable[[Document], None]) -> None:
    how = Machine(flavour="lines-arcs", version=version)
    assert told(changed(how, lambda _: None), how) == set()
    assert code in told(changed(how, change), how)


def open_old(found: Document) -> None:
    outer(found)[0].dxf.flags &= ~1


def flip_old(found: Document) -> None:
    corner = next(vertex for vertex in outer(found)[0].vertices if vertex.dxf.bulge)
    corner.dxf.bulge = -corner.dxf.bulge


def move_old(found: Document) -> None:
    outer(found)[0].vertices[1].dxf.location += (0.0, 1e-3, 0.0)


def reverse_old(found: Document) -> None:
    line = outer(found)[0]
    points = [(v.dxf.location.x, v.dxf.location.y, v.dxf.bulge) for v in line.vertices]
    bulges = [-points[(i - 1) % len(points)][2] for i in range(len(points))]
    places = [point[:2] for point in points][::-1]
    layer = {"layer": "CUT_OUTER", "color": 1}
    space = found.modelspace()
    space.delete_entity(line)
    space.add_polyline2d(
        [(*place, bulge) for place, bulge in zip(places, bulges[::-1], strict=True)],
        format="xyb",
        close=True,
        dxfattribs=layer,
    )


def repeat_old(found: Document) -> None:
    line = outer(found)[0]
    line.insert_vertices(1, [line.vertices[0].dxf.location], dxfattribs={"layer": "CUT_OUTER"})


def wide_old(found: Document) -> None:
    outer(found)[0].vertices[-1].dxf.bulge = 1.5


def fitted_old(found: Document) -> None:
    outer(found)[0].dxf.flags |= 4


OLD: list[tuple[str, Callable[[Document], None]]] = [
    ("readback-open-contour", open_old),
    ("readback-content", move_old),
    ("readback-direction", reverse_old),
    ("readback-repeated-vertex", repeat_old),
    ("readback-bulge", wide_old),
    ("readback-open-contour", fitted_old),
    ("readback-duplicate", twice),
    ("readback-order", outline_first),
    ("readback-colour", other_colour),
    ("readback-extents", extents),
]


@pytest.mark.parametrize("flavour", ["r12", "polylines"])
@pytest.mark.parametrize(("code", "change"), OLD)
def test_a_fault_in_an_old_polyline_is_found(flavour: Flavour, code: str, change: Callable[[Document], None]) -> None:
    how = Machine(flavour=flavour, version="R12")
    assert told(changed(how, lambda _: None), how) == set()
    assert code in told(changed(how, change), how)


def test_a_flipped_bulge_of_an_old_polyline_is_found() -> None:
    how = Machine(flavour="r12", version="R12")
    assert "readback-content" in told(changed(how, flip_old), how)
