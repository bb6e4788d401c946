from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.geometry.arrays import cross2
from stages.geometry.curves.rigid import Rigid2, apply
from stages.model.cutfile import Machine
from stages.model.pattern import FlatPattern, Text
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.compare import compared
from stages.write.drawing import flat_drawing, moved_text
from stages.write.dxf import dxf_text
from stages.write.readback import Writing, read
from tests.near import assert_near
from tests.stages.write.patterns import plate


def lettered() -> FlatPattern:
    return plate().replace(texts=(Text("mark-1", "TOP 7", np.array([20.0, 47.0]), 5.0, 30.0),))


def writings(text: str) -> list[Writing]:
    return [entity.writing for entity in read(text).entities if entity.writing is not None]


def test_a_text_is_written_where_it_stands_on_the_part() -> None:
    name, found = writings(dxf_text(flat_drawing(lettered(), Machine()), Machine()))
    assert (name.text, found.text) == ("plate", "TOP 7")
    assert_near([found.x, found.y, found.height_mm, found.angle_deg], [20, 47, 5, 30], bound=1e-10, why="10 decimals")


@pytest.mark.parametrize(
    ("motion", "wanted"),
    [
        (Rigid2(x=300.0, y=100.0, angle_deg=90.0), [253.0, 120.0, 120.0]),
        (Rigid2(x=300.0, y=100.0, angle_deg=0.0, mirrored=True), [280.0, 147.0, 150.0]),
    ],
)
def test_a_text_moves_with_its_part(motion: Rigid2, wanted: list[float]) -> None:
    layout = SheetLayout(Sheet("s", 600.0, 400.0), 1, (Placement("plate", 1, motion),), 0.1)
    outcome = write([lettered()], Nesting((layout,)), Machine())
    assert outcome.report.passed, outcome.report.findings
    found = writings(outcome.product[1].text)[1]
    assert_near([found.x, found.y, found.angle_deg], wanted, bound=1e-9, why="closed form, 10 decimals")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("TOP 7", "TOP 1"),
        (" 21\n47.0\n", " 21\n47.1\n"),
        ("\n 40\n5.0\n", "\n 40\n6.0\n"),
        ("\n 50\n30.0\n", "\n 50\n31.0\n"),
    ],
)
def test_a_text_that_is_not_as_drawn_is_found(old: str, new: str) -> None:
    drawing = flat_drawing(lettered(), Machine())
    text = dxf_text(drawing, Machine())
    assert not compared(read(text), drawing, {}).findings
    assert old in text
    assert [found.code for found in compared(read(text.replace(old, new)), drawing, {}).findings] == [
        "readback-content"
    ]


def test_a_text_that_is_missing_is_found() -> None:
    drawing = flat_drawing(lettered(), Machine())
    without = dxf_text(flat_drawing(plate(), Machine()), Machine())
    assert [found.code for found in compared(read(without), drawing, {}).findings] == ["readback-content"]


@given(st.floats(0.0, 360.0), st.floats(0.0, 360.0), st.booleans())
def test_the_line_of_a_text_goes_with_its_part_and_its_letters_are_never_mirrored(
    angle: float, turned: float, mirrored: bool
) -> None:
    """The baseline has the direction of its image, or the opposite one on a mirrored part; its middle is its image."""
    motion = Rigid2(30.0, -4.0, turned, mirrored)
    label = moved_text(Text("note", "A-1", np.array([12.0, 7.0]), 5.0, angle), motion)
    way = np.array([cos(radians(angle)), sin(radians(angle))])
    image = np.diff(apply(motion, np.stack([np.zeros(2), way])), axis=0)[0]
    across = cross2(image, np.array([cos(radians(label.angle_deg)), sin(radians(label.angle_deg))]))
    assert_near(across, 0.0, bound=1e-13, why="rounding of angles up to 720 deg")
    assert_near(label.at, apply(motion, np.array([[12.0, 7.0]]))[0], bound=1e-13, why="the same map")
