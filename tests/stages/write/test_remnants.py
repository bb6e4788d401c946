"""Offcuts in drawings: on the sheet where they lie, alone in their own frame, both read back."""

from dataclasses import replace

from stages.geometry.paths.arcpath import area, bounds
from stages.model.cutfile import Machine
from stages.model.sheet import Nesting, Rectangle
from stages.write import write
from stages.write.pictureback import svg_paths
from stages.write.readback import ReadFile, read
from tests.near import assert_near
from tests.stages.write.patterns import nesting, plate, sector

OFFCUT = Rectangle(230.0, 0.0, 270.0, 300.0)


def with_offcut() -> Nesting:
    """Return the two sheets, the second with an offcut."""
    first, second = nesting().layouts
    return Nesting((first, replace(second, offcut=OFFCUT)))


def boxes(file: ReadFile) -> list[tuple[float, float, float, float]]:
    return [bounds(one.path) for one in file.entities if one.layer == "SHEET" and one.path is not None]


def test_only_the_sheet_with_an_offcut_has_a_remnant() -> None:
    outcome = write([plate(), sector()], with_offcut(), Machine())
    files = {file.path: read(file.text) for file in outcome.product}
    assert outcome.report.passed
    assert [path for path in files if path.startswith("remnants/")] == ["remnants/stock-2.dxf"]
    (alone,) = files["remnants/stock-2.dxf"].entities
    assert alone.closed
    assert alone.path is not None
    assert bounds(alone.path) == (0.0, 0.0, 270.0, 300.0)
    assert_near(area(alone.path), 270.0 * 300.0, bound=1e-9, why="a rectangle of whole numbers")
    assert boxes(files["cut/stock-1.dxf"]) == [(0.0, 0.0, 500.0, 300.0)]
    assert boxes(files["cut/stock-2.dxf"]) == [(0.0, 0.0, 500.0, 300.0), (230.0, 0.0, 500.0, 300.0)]


def test_an_offcut_is_not_cut() -> None:
    before, after = (write([plate(), sector()], nest, Machine()).report for nest in (nesting(), with_offcut()))
    figures = [report.detail["files"]["cut/stock-2.dxf"] for report in (before, after)]  # type: ignore[index]
    assert figures[0] == figures[1]
    assert after.detail["files"]["remnants/stock-2.dxf"]["cut_length_mm"] == 0.0  # type: ignore[index]


def test_without_an_offcut_there_is_no_remnant() -> None:
    assert not [file for file in write([plate(), sector()], nesting(), Machine()).product if "remnant" in file.path]


def test_a_remnant_has_the_pictures_that_every_drawing_has() -> None:
    outcome = write([plate(), sector()], with_offcut(), Machine(also=("svg", "pdf")))
    assert outcome.report.passed
    paths = [file.path for file in outcome.product]
    drawings = [path.removesuffix(".dxf") for path in paths if path.endswith(".dxf")]
    assert "remnants/stock-2" in drawings
    assert sorted(paths) == sorted(f"{one}.{how}" for one in drawings for how in ("dxf", "svg", "pdf"))
    picture = next(file.text for file in outcome.product if file.path == "remnants/stock-2.svg")
    (outline,) = svg_paths(picture)
    assert (outline.layer, outline.closed, outline.start) == ("SHEET", True, (0.0, 0.0))
    assert_near(outline.area_mm2, 270.0 * 300.0, bound=1e-9, why="a rectangle of whole numbers")
