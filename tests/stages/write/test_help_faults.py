"""Faults planted in the leads and tabs of a cut file: a good file has none, break one thing, and that is found."""

from collections.abc import Callable
from io import StringIO

import ezdxf
import pytest
from ezdxf.document import Drawing as Document

from stages.model.cutfile import CutFile
from stages.model.helps import Helps
from stages.write import judged
from stages.write.helps import helped
from stages.write.sheets import cut_drawings
from tests.stages.write.helpcases import LEADS, TABS, machine, usual
from tests.stages.write.patterns import nesting, plate, sector


def leads_of(document: Document) -> list[object]:
    return [one for one in document.modelspace() if one.dxf.layer == "LEAD"]


def shift_lead(document: Document) -> None:
    leads_of(document)[0].translate(0.01, 0.0, 0.0)  # type: ignore[attr-defined]


def long_lead(document: Document) -> None:
    line = next(one for one in leads_of(document) if one.dxftype() == "LINE")  # type: ignore[attr-defined]
    line.dxf.start = line.dxf.end + 60.0 * (line.dxf.start - line.dxf.end)


def drop_piece(document: Document) -> None:
    space = document.modelspace()
    space.delete_entity(next(one for one in space if one.dxf.layer == "CUT_OUTER"))


def wide_gap(document: Document) -> None:
    piece = next(one for one in document.modelspace() if one.dxf.layer == "CUT_OUTER")
    points = piece.get_points("xyb")
    piece.set_points([(points[0][0] + 0.01, points[0][1] + 0.01, points[0][2]), *points[1:]], format="xyb")


def filled_gap(document: Document) -> None:
    space = document.modelspace()
    one, other = [piece.get_points("xy") for piece in space if piece.dxf.layer == "CUT_OUTER"][:2]
    space.add_lwpolyline([one[-1], other[0]], dxfattribs={"layer": "CUT_OUTER", "color": 1})


@pytest.mark.parametrize(
    ("helps", "change", "code"),
    [
        (LEADS, shift_lead, "readback-lead"),
        (LEADS, long_lead, "readback-lead"),
        (TABS, drop_piece, "readback-open-contour"),
        (TABS, wide_gap, "readback-open-contour"),
        (TABS, filled_gap, "readback-content"),
    ],
)
def test_a_planted_fault_is_found(helps: Helps, change: Callable[[Document], None], code: str) -> None:
    how = machine(helps)
    parts = {one.part: one for one in (plate(), sector())}
    drawing = helped(cut_drawings(nesting().layouts, parts, how)[0], how)
    text = {file.path: file.text for file in usual(helps).product}[drawing.path]
    assert judged([CutFile(drawing.path, text)], [drawing], parts, how).passed
    document = ezdxf.read(StringIO(text))
    change(document)
    stream = StringIO()
    document.write(stream)
    report = judged([CutFile(drawing.path, stream.getvalue())], [drawing], parts, how)
    assert code in {finding.code for finding in report.findings if finding.fatal}
