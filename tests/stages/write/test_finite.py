"""Numbers that are not finite cannot reach a file: a gate where coordinates are rounded, one before the whole text."""

from math import inf, nan

import numpy as np
import pytest
from ezdxf.document import Drawing as Document
from hypothesis import given
from hypothesis import strategies as st

from stages.model.cutfile import Machine
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text, exported, finite
from stages.write.entities import rounded
from tests.stages.write.patterns import plate

BROKEN = [nan, inf, -inf]


@pytest.mark.parametrize("number", BROKEN)
def test_no_rounding_lets_one_pass(number: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        rounded(np.array([1.0, number]), 10)


def with_line(document: Document, number: float) -> None:
    document.modelspace().add_line((number, 0.0), (1.0, 1.0))


def with_bulge(document: Document, number: float) -> None:
    document.modelspace().add_lwpolyline([(0.0, 0.0, number), (1.0, 1.0, 0.0)], format="xyb")


def with_circle(document: Document, number: float) -> None:
    document.modelspace().add_circle((1.0, number), 1.0)


def with_arc(document: Document, number: float) -> None:
    document.modelspace().add_arc((1.0, 1.0), 1.0, number, 2.0)


@pytest.mark.parametrize("number", BROKEN)
@pytest.mark.parametrize("change", [with_line, with_bulge, with_circle, with_arc])
def test_whatever_is_put_into_a_document_is_looked_at_in_its_text(change, number: float) -> None:
    good = Document.new("R2000")
    change(good, 1.0)
    assert exported(good)
    broken = Document.new("R2000")
    change(broken, number)
    with pytest.raises(ValueError, match="must be a finite number"):
        exported(broken)


TEXT = dxf_text(flat_drawing(plate(), Machine()), Machine()).splitlines()
FLOATS = {*range(10, 60), *range(110, 150), *range(210, 240), *range(460, 470), *range(1010, 1060)}
"""Group codes of floating-point numbers, from the DXF reference."""

NUMBERS = [place + 1 for place in range(0, len(TEXT) - 1, 2) if int(TEXT[place]) in FLOATS]


@given(st.sampled_from(NUMBERS), st.sampled_from(["nan", "inf", "-inf", "NaN", "Infinity", "1e999"]))
def test_no_number_of_a_file_may_be_anything_else(place: int, word: str) -> None:
    assert finite("\n".join(TEXT)) == "\n".join(TEXT)
    with pytest.raises(ValueError, match=f"line {place + 1} "):
        finite("\n".join([*TEXT[:place], word, *TEXT[place + 1 :]]))


def test_tags_that_hold_numbers_are_those_of_the_reference_and_no_others() -> None:
    for code in range(1100):
        text = f"{code:3}\ninf\n"
        if code in FLOATS:
            with pytest.raises(ValueError, match="line 2 "):
                finite(text)
        else:
            assert finite(text) == text


@pytest.mark.parametrize("word", ["nan", "inf", "1e999"])
def test_a_part_may_be_called_so(word: str) -> None:
    assert f"\n{word}\n" in dxf_text(flat_drawing(plate(word), Machine()), Machine())
