"""The order in which a file is cut."""

from io import StringIO

import ezdxf

from stages.write import write
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
