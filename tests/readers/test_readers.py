"""Every reader on every sample, and the samples themselves; one file, so that the samples are made once."""

from pathlib import Path

import pytest

from stages.model.cutfile import Flavour, Version
from tests.near import assert_relative
from tests.readers import librecad
from tests.readers.drawings import FLAVOURS, asked, samples
from tests.readers.everyone import READERS, must_be_here, wrong
from tests.readers.reading import Reader

READ_RIGHT: dict[str, tuple[Flavour, ...]] = {
    "OpenSCAD": ("lines-arcs", "polylines"),
    "Dia": ("lines-arcs",),
    "dime": ("lines-arcs", "polylines", "aama"),
    "dxf2gcode": ("lines-arcs", "polylines", "r12", "aama"),
    "dxf-json (npm)": ("polyline-arcs", "lines-arcs", "polylines", "r12"),
    "jscad (npm)": ("polyline-arcs", "polylines"),
}
"""What a reader can read, where that is not all: the table says so, and both of yes and no are kept true here."""


@pytest.mark.readers
@pytest.mark.parametrize(("flavour", "version"), asked())
@pytest.mark.parametrize("reader", READERS, ids=[reader.name for reader in READERS])
def test_every_file_is_read_right_or_the_table_says_so(reader: Reader, flavour: Flavour, version: Version) -> None:
    must_be_here(reader)
    faults = wrong(reader, flavour, version)
    if flavour in READ_RIGHT.get(reader.name, FLAVOURS):
        assert faults == []
    else:
        assert faults != []


@pytest.mark.parametrize(
    ("flavour", "least"), [("polyline-arcs", 12), ("lines-arcs", 15), ("polylines", 15), ("r12", 12), ("aama", 12)]
)
def test_most_readers_read_a_flavour_right(flavour: Flavour, least: int) -> None:
    """Of 16, by what is asked of each above; the one that reads lines and arcs wrong loses short arcs."""
    assert len(READERS) == 16
    assert sum(flavour in READ_RIGHT.get(reader.name, FLAVOURS) for reader in READERS) == least


def test_every_flavour_has_readers_and_every_reader_a_flavour() -> None:
    assert {reader.name for reader in READERS} >= set(READ_RIGHT)
    assert all(READ_RIGHT.get(reader.name, FLAVOURS) for reader in READERS)


@pytest.mark.readers
def test_librecad_prints_a_file_1_to_1_if_nobody_says_a_scale(tmp_path: Path) -> None:
    must_be_here(next(reader for reader in READERS if reader.name.startswith("LibreCAD")))
    path = tmp_path / "plate.dxf"
    path.write_text(next(one for one in samples("polyline-arcs", "R2000") if one.name == "plate").text, "ascii")
    low, high = path.read_text("ascii").partition("$EXTMIN")[2], path.read_text("ascii").partition("$EXTMAX")[2]
    wide = float(high.split()[1]) - float(low.split()[1])
    assert_relative(librecad.printed_width_mm(path), wide, bound=1e-3, why="a step of the page is 1/47 mm")


def test_the_length_of_trimesh_needs_straight_polylines_where_arcs_are_flat(tmp_path: Path) -> None:
    """It calls an arc of half a degree straight, and refuses; told of in the table's notes, so kept true here."""
    import trimesh

    def its_length(flavour: Flavour) -> float:
        strip = next(one for one in samples(flavour, "R2000") if one.name == "strip")
        path = tmp_path / f"{flavour}.dxf"
        path.write_text(strip.text, "ascii")
        return float(trimesh.load_path(str(path)).length) / strip.figures["cut_length_mm"]

    with pytest.raises(ValueError, match="colinear"):
        its_length("polyline-arcs")
    assert_relative(its_length("polylines"), 1.0, bound=1e-9, why="straight pieces, rounded to 1e-10 mm")


@pytest.mark.parametrize(("flavour", "version"), asked())
def test_readers_are_held_to_what_the_write_stage_reports(flavour: Flavour, version: Version) -> None:
    for sample in samples(flavour, version):
        assert_relative(
            sample.cut_mm, sample.figures["cut_length_mm"], bound=1e-9, why="coordinates rounded to 1e-10 mm"
        )


def test_the_samples_hold_what_a_cut_file_can_hold() -> None:
    drawings = [sample.drawing for sample in samples("polyline-arcs", "R2000")]
    layers = {item.layer for drawing in drawings for item in drawing.items}
    assert layers == {"CUT_OUTER", "CUT_INNER", "MARK", "BEND_UP", "BEND_DOWN", "SHEET"}
    assert any(label.angle_deg % 90.0 for drawing in drawings for label in drawing.labels)
    assert any(drawing.divided for drawing in drawings)
    assert any(not item.path.closed for drawing in drawings for item in drawing.items if item.layer == "CUT_OUTER")
