"""What a file says, whatever its layers are called and in whichever flavour."""

from collections import Counter
from dataclasses import replace
from io import StringIO

import pytest

from stages.model.cutfile import PROFILES, CutFile, Layer, Machine
from stages.write import judged, write
from stages.write.drawing import flat_drawing
from stages.write.faults import faults
from stages.write.readback import read
from tests.stages.write.cases import CASES, Case, document, machine, on, texts_of
from tests.stages.write.patterns import CHORD_MM, plate
from tests.stages.write.planted import LEAST_MM, codes


def own_layers() -> dict[str, Layer]:
    return {
        **PROFILES["planish"],
        "CUT_OUTER": Layer("CUT", 1),
        "CUT_INNER": Layer("CUT", 5),
        "MARK": Layer("Etch it", 3),
    }


@pytest.mark.parametrize("case", CASES)
def test_inventor_names_are_in_the_file_and_read_as_what_they_mean(case: Case) -> None:
    how = replace(machine(case), layers=PROFILES["inventor"])
    text = write([plate()], None, how).product[0].text
    assert {e.dxf.layer for e in document(text).modelspace()} == {
        "IV_OUTER_PROFILE", "IV_INTERIOR_PROFILES", "IV_FEATURE_PROFILES", "LABEL"
    }  # fmt: skip
    assert {e.layer for e in read(text, how.layers).entities} == {"CUT_OUTER", "CUT_INNER", "MARK", "LABEL"}
    assert "readback-layer" in codes(text)


def test_layers_that_share_a_name_are_told_apart_by_colour() -> None:
    how = Machine(layers=own_layers())
    text = write([plate()], None, how).product[0].text
    assert Counter(e.dxf.layer for e in document(text).modelspace()) == {"CUT": 3, "Etch it": 2, "LABEL": 1}
    assert [layer.dxf.name for layer in document(text).layers].count("CUT") == 1
    assert Counter(e.layer for e in read(text, how.layers).entities if e.layer.startswith("CUT")) == {
        "CUT_INNER": 2, "CUT_OUTER": 1
    }  # fmt: skip
    outline = next(e for e in on("CUT", text) if e.dxf.color == 1)
    found = document(text)
    found.entitydb[outline.dxf.handle].dxf.color = 5
    stream = StringIO()
    found.write(stream)
    report = judged(
        [CutFile("flat/plate.dxf", stream.getvalue())], [flat_drawing(plate(), how)], {"plate": plate()}, how
    )
    assert not report.passed


def test_a_layer_of_another_profile_is_not_taken_for_one_of_ours() -> None:
    layers = {**PROFILES["planish"], "CUT_OUTER": Layer("CONTOUR", 1)}
    text = texts_of(CASES[0])["flat/plate.dxf"]
    found = {finding.code for finding in faults(read(text, layers), "x", LEAST_MM, CHORD_MM)}
    assert "readback-layer" in found
