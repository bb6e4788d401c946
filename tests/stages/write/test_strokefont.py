"""Strokes for letters: all of printable ASCII, inside their box, where and as a text lies."""

from itertools import pairwise
from string import printable

import numpy as np
import pytest

from stages.model.cutfile import Machine
from stages.write import write
from stages.write.drawing import flat_drawing
from stages.write.readback import read
from stages.write.strokefont import ADVANCE, CAPITAL, GLYPHS, lettering, reach
from tests.near import assert_near
from tests.stages.write.patterns import nesting, pattern, plate, sector

LETTERS = [letter for letter in printable if letter.isprintable()]


def test_every_printable_letter_has_its_own_strokes_on_the_grid() -> None:
    assert sorted(GLYPHS) == sorted(LETTERS)
    assert len(set(GLYPHS.values())) == len(GLYPHS)
    for strokes in GLYPHS.values():
        for stroke in strokes.split():
            points = [stroke[k : k + 2] for k in range(0, len(stroke), 2)]
            assert len(stroke) % 2 == 0
            assert len(points) > 1
            assert all(a != b for a, b in pairwise(points))
            assert all(x in "01234" for x, _ in points)


def test_a_capital_is_as_high_as_the_text_and_stands_about_the_point() -> None:
    (path,) = lettering("O", np.array([10.0, 20.0]), 3.0, 0.0)
    assert path.closed
    assert_near(path.vertices.min(axis=0), [10.0 - 1.0, 20.0 - 1.5], bound=1e-14, why="4 of 6 grid lines wide")
    assert_near(path.vertices.max(axis=0), [10.0 + 1.0, 20.0 + 1.5], bound=1e-14, why="as high as the text")


@pytest.mark.parametrize("angle", [0.0, 33.0, 180.0, 270.0])
def test_a_text_turned_is_turned_about_its_middle(angle: float) -> None:
    at = np.array([5.0, -3.0])
    turn = np.exp(1j * np.radians(angle))
    for path, plain in zip(lettering("Ab7", at, 2.0, angle), lettering("Ab7", np.zeros(2), 2.0, 0.0), strict=True):
        turned = (plain.vertices @ [1.0, 1j]) * turn + at @ [1.0, 1j]
        wanted = np.stack([turned.real, turned.imag], axis=1)
        assert_near(path.vertices, wanted, bound=1e-14, why="rotation by a complex number")


def test_reach_is_that_of_the_furthest_stroke() -> None:
    assert_near(reach("II"), np.hypot((ADVANCE / 2.0 + 1.0) / CAPITAL, 0.5), bound=1e-15, why="serif of the last I")
    assert reach("  ") == 0.0


def test_names_are_engraved_inside_their_parts_and_nothing_is_text() -> None:
    outcome = write([plate(), sector()], nesting(), Machine(text="strokes"))
    assert outcome.report.passed
    assert outcome.report.findings == ()
    for file in outcome.product:
        back = read(file.text)
        assert not [entity for entity in back.entities if entity.kind == "TEXT"]
        copies = sum(entity.layer == "CUT_OUTER" for entity in back.entities)
        name = {"flat/plate.dxf": "plate", "flat/sector.dxf": "sector"}.get(file.path)
        if name:
            strokes = sum(len(GLYPHS[letter].split()) for letter in name)
            assert sum(entity.layer == "ENGRAVE" for entity in back.entities) == copies * strokes


def test_strokes_that_are_marks_already_are_not_engraved_again() -> None:
    machine = Machine(text="strokes")
    once = flat_drawing(plate(), machine)
    from stages.model.pattern import Mark

    marks = tuple(Mark("", item.path, "ENGRAVE") for item in once.items if item.layer == "ENGRAVE")
    again = flat_drawing(pattern("plate", plate().outer, (45.0, 20.0), marks=marks), machine)
    assert sum(item.layer == "ENGRAVE" for item in again.items) == len(marks) > 0
