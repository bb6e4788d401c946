"""The records of a drawing against those that ezdxf writes of the same entities, letter by letter."""

from collections.abc import Callable
from dataclasses import replace
from io import StringIO
from itertools import count

import numpy as np
import pytest
from ezdxf.document import Drawing as Document
from ezdxf.entities.polyline import Polyline
from ezdxf.enums import TextEntityAlignment
from ezdxf.layouts.layout import Modelspace
from ezdxf.lldxf.tagwriter import TagWriter

from stages.geometry.paths.arcpath import ArcPath, centres, chords, piece_count, radii, sweeps
from stages.model.cutfile import Layer, Machine
from stages.write.drawing import Drawing, Item, Label, flat_drawing
from stages.write.dxf import dxf_text
from stages.write.entities import BULGE_DECIMALS, DECIMALS, circle, rounded
from stages.write.records import Form, records
from tests.readers.drawings import bent
from tests.stages.write.cases import CASES, Case, document, machine
from tests.stages.write.patterns import drop, plate, sector, strip

LABELS = tuple(
    Label("LABEL", text, np.array([1.0 / 3.0, -2.5e-11]), 2.5, angle)
    for text, angle in (("plate", 0.0), ("a b-C_1", 33.3), ("%%d 5^", -0.0))
)


def drawings(how: Machine) -> list[Drawing]:
    """Return drawings of lines, arcs, circles, curves, marks and texts."""
    found = [flat_drawing(one, how) for one in (plate(), sector(), strip(), drop(), bent())]
    return [*found, replace(found[0], labels=LABELS), replace(found[0], items=_begun(found[0].items))]


def _begun(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """Return items whose circles begin at a place, and so are polylines."""
    return tuple(replace(item, begun=True) for item in items)


def exported(drawing: Drawing, how: Machine) -> str:
    """Return the records that ezdxf writes of entities that are added one by one."""
    new = Document.new(how.version)
    space = new.modelspace()
    for item in drawing.items:
        layer = how.layers[item.layer]
        _added(space, item, how)({"layer": layer.name, "color": layer.colour})
    for label in drawing.labels:
        _add_text(space, label, how.layers[label.layer])
    stream = StringIO()
    space.entity_space.export_dxf(TagWriter(stream, dxfversion=new.dxfversion))
    return stream.getvalue()


Attributes = dict[str, object]


def _added(space: Modelspace, item: Item, how: Machine) -> Callable[[Attributes], None]:
    """Return what adds the entities of a path, with their attributes."""
    path, round_one = item.path, None if item.begun else circle(item.path)
    if round_one is not None:
        x, y, radius = rounded(np.array(round_one), DECIMALS)
        return lambda own: space.add_circle((x, y), radius, dxfattribs=own)
    if how.flavour == "lines-arcs":
        return lambda own: _add_pieces(space, path, own)
    if piece_count(path) == 1 and path.bulges[0] == 0.0 and item.contour is None:
        return lambda own: _add_pieces(space, path, own)
    x, y = (rounded(path.vertices[:, k], DECIMALS) for k in (0, 1))
    points = list(zip(x, y, rounded(path.bulges, BULGE_DECIMALS), strict=True))
    add = space.add_polyline2d if how.version == "R12" else space.add_lwpolyline
    return lambda own: add(points, format="xyb", close=path.closed, dxfattribs=own)


def _add_pieces(space: Modelspace, path: ArcPath, attributes: Attributes) -> None:
    start, end = chords(path)
    sweep, centre, radius = sweeps(path), centres(path), radii(path)
    for piece in range(piece_count(path)):
        own = {**attributes, "linetype": "CONTINUOUS"} if piece == 0 else attributes
        if sweep[piece] == 0.0:
            ends = rounded(np.concatenate([start[piece], end[piece]]), DECIMALS)
            space.add_line(ends[:2], ends[2:], dxfattribs=own)
            continue
        both = np.stack([start[piece], end[piece]])[:: 1 if sweep[piece] > 0.0 else -1] - centre[piece]
        x, y, long = rounded(np.array([*centre[piece], radius[piece]]), DECIMALS)
        first, last = rounded(np.degrees(np.arctan2(both[:, 1], both[:, 0])) % 360.0, BULGE_DECIMALS)
        space.add_arc((x, y), long, first % 360.0, last % 360.0, dxfattribs=own)


def _add_text(space: Modelspace, label: Label, layer: Layer) -> None:
    x, y, height, angle = rounded(np.array([*label.at, label.height_mm, label.angle_deg]), DECIMALS)
    own = {"layer": layer.name, "color": layer.colour, "rotation": angle}
    text = space.add_text("", height=height, dxfattribs=own)
    # past its check, which takes a last ^ away: it is a letter as any other
    text.dxf.__dict__["text"] = label.text
    text.set_placement((x, y), align=TextEntityAlignment.MIDDLE_CENTER)


def written(drawing: Drawing, how: Machine) -> str:
    """Return the records of this program, for a new document of the library's."""
    new = Document.new(how.version)
    handles = count(int(str(new.entitydb.handles), 16))
    return records(drawing, Form(how, new.modelspace().layout_key, handles))


@pytest.mark.parametrize("case", CASES)
def test_every_record_is_the_librarys_letter_by_letter(case: Case) -> None:
    how = machine(case)
    for drawing in drawings(how):
        assert written(drawing, how) == exported(drawing, how)


@pytest.mark.parametrize("case", CASES)
def test_handles_go_on_from_those_of_the_document_and_none_is_given_twice(case: Case) -> None:
    how = machine(case)
    found = document(dxf_text(drawings(how)[0], how))
    space = found.modelspace()
    every = [one for entity in space for one in (entity, *(entity.vertices if isinstance(entity, Polyline) else ()))]
    handles = [int(one.dxf.handle, 16) for one in every]
    assert len({*handles}) == len(handles)
    assert max(handles) < int(str(found.header["$HANDSEED"]), 16)
    assert found.audit().errors == []


def test_a_layer_may_be_called_as_the_section_of_entities() -> None:
    layers = {**Machine().layers, "MARK": Layer("ENTITIES", 3)}
    how = replace(Machine(), layers=layers)
    found = document(dxf_text(drawings(how)[0], how))
    assert sum(entity.dxf.layer == "ENTITIES" for entity in found.modelspace()) == 2


def test_a_text_that_ends_in_a_caret_is_written_as_it_is() -> None:
    how = Machine()
    found = document(dxf_text(drawings(how)[-2], how))
    assert [text.dxf.text for text in found.modelspace().query("TEXT")] == [label.text for label in LABELS]
