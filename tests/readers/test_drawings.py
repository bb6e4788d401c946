import pytest

from stages.geometry.arcpath import length
from stages.model.cutfile import Flavour, Version
from tests.near import assert_relative
from tests.readers.drawings import asked, samples


@pytest.mark.parametrize(("flavour", "version"), asked())
def test_readers_are_held_to_what_the_write_stage_reports(flavour: Flavour, version: Version) -> None:
    for sample in samples(flavour, version):
        cut = sum(length(item.path) for item in sample.drawing.items if item.layer.startswith("CUT_"))
        assert_relative(cut, sample.figures["cut_length_mm"], bound=1e-9, why="coordinates rounded to 1e-10 mm")


def test_the_samples_hold_what_a_cut_file_can_hold() -> None:
    drawings = [sample.drawing for sample in samples("polyline-arcs", "R2000")]
    layers = {item.layer for drawing in drawings for item in drawing.items}
    assert layers == {"CUT_OUTER", "CUT_INNER", "MARK", "BEND_UP", "BEND_DOWN", "SHEET"}
    assert any(label.angle_deg % 90.0 for drawing in drawings for label in drawing.labels)
    assert any(drawing.divided for drawing in drawings)
    assert any(not item.path.closed for drawing in drawings for item in drawing.items if item.layer == "CUT_OUTER")
