"""What goes into one file: a sheet, a part, or all sheets of a material."""

from collections import Counter

import pytest

from stages.geometry.paths.arcpath import bounds
from stages.model.cutfile import Machine
from stages.write import write
from stages.write.readback import read
from stages.write.sheets import SHEETS_APART_MM, seen, windows
from tests.near import assert_near
from tests.stages.write.patterns import nesting, plate, sector


def files(machine: Machine) -> dict[str, str]:
    outcome = write([plate(), sector()], nesting(), machine)
    assert outcome.report.passed
    return {file.path: file.text for file in outcome.product if file.path.startswith("cut/")}


def test_names_are_those_of_the_template() -> None:
    assert list(files(Machine(file_name="no{index}_of_{stock}"))) == ["cut/no1_of_stock.dxf", "cut/no2_of_stock.dxf"]


def test_a_file_for_each_part_holds_it_once_and_no_sheet() -> None:
    made = files(Machine(file_per="part", file_name="p_{part}"))
    assert list(made) == ["cut/p_plate.dxf", "cut/p_sector.dxf"]
    for text in made.values():
        layers = Counter(entity.layer for entity in read(text).entities)
        assert layers["CUT_OUTER"] == 1
        assert layers["SHEET"] == 0


@pytest.mark.parametrize("flavour", ["polyline-arcs", "lines-arcs"])
def test_all_sheets_lie_beside_each_other_and_are_read_as_if_alone(flavour) -> None:
    machine = Machine(flavour=flavour, file_per="material", file_name="all")
    (text,) = files(machine).values()
    alone = [read(text).entities for text in files(Machine(flavour=flavour)).values()]
    entities = read(text).entities
    low, high = (bounds(one.path) for one in entities if one.layer == "SHEET" and one.path is not None)
    assert_near(high[0] - low[2], SHEETS_APART_MM, bound=1e-9, why="ten decimals")
    for window, wanted in zip(windows(nesting().layouts, {}), alone, strict=True):
        found = list(seen(entities, window))
        paths = [one for one in wanted if one.path is not None]
        assert [one.layer for one in found] == [one.layer for one in paths]
        for one, other in zip(found, paths, strict=True):
            assert_near(bounds(one.path), bounds(other.path), bound=1e-8, why="ten decimals, or ends of arcs")


def test_figures_of_each_sheet_are_those_of_its_own_file() -> None:
    together = write([plate(), sector()], nesting(), Machine(file_per="material", file_name="all")).report.detail[
        "sheets"
    ]
    alone = write([plate(), sector()], nesting(), Machine()).report.detail["files"]
    for index, figures in enumerate(together, 1):
        for name, value in alone[f"cut/stock-{index}.dxf"].items():
            assert_near(figures[name], value, bound=1e-6, why="sums of some ten lengths of ten decimals")
