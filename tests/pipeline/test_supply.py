"""Files of stock: the tables of a job without its parts, with every problem told at once."""

from pathlib import Path

import pytest

from pipeline.rates import Rates
from pipeline.supply import Row, Supply, supply_of
from stages.errors import BadInputError
from stages.model.sheet import Sheet

FILE = """\
schema = 1
units = "cm"
[nest]
gap = 0.2
[process]
type = "plasma"
speed = 300
pierce_time = 0.5
[[stock]]
id = "plate"
width = 100
height = 50
material = "Mild steel"
grain = 90
[[stock]]
id = "any"
width = 20
height = 20
thickness = "2 mm"
"""


def supply(folder: Path, text: str = FILE) -> Supply:
    (folder / "stock.toml").write_text(text, "utf-8")
    return supply_of(folder / "stock.toml")


def test_the_tables_are_those_of_a_job_in_its_units(tmp_path: Path) -> None:
    made = supply(tmp_path)
    plate, other = made.rows
    assert (plate.sheet.id, plate.sheet.width_mm, plate.sheet.grain_deg) == ("plate", 1000.0, 90.0)
    assert (plate.material, plate.thickness_mm, other.material, other.thickness_mm) == ("Mild steel", None, None, 2.0)
    assert (made.options.gap_mm, made.options.kerf_mm) == (2.0, 1.8)
    assert made.rates == Rates(3000.0, 0.5, 0.0)
    assert [name for name, _ in made.inputs] == ["stock.toml"]


@pytest.mark.parametrize(
    ("material", "thickness", "serves"),
    [("mild steel", 2.0, (True, True)), ("leather", 2.0, (False, True)), ("MILD STEEL", 3.0, (True, False)),
     ("mild-steel", 2.0, (True, True)), ("S235", 2.0, (True, True)), ("", None, (False, False))],
)  # fmt: skip
def test_a_row_serves_what_it_does_not_contradict(
    tmp_path: Path, material: str, thickness: float | None, serves: tuple[bool, bool]
) -> None:
    assert tuple(row.serves(material, thickness) for row in supply(tmp_path).rows) == serves


def test_a_row_that_states_nothing_serves_all() -> None:
    row = Row(Sheet("a", 1.0, 1.0))
    assert row.serves("", None)
    assert row.serves("brass", 3.0)


def test_every_problem_is_told_with_its_place(tmp_path: Path) -> None:
    text = FILE.replace("speed = 300", "speed = 0").replace("gap = 0.2", "gap = -1\noffcut_credit = 2")
    text = text.replace('id = "any"', 'id = "Plate"') + '[[part]]\nname = "x"\n'
    with pytest.raises(BadInputError) as caught:
        supply(tmp_path, text)
    told = [(problem.line, problem.path) for problem in caught.value.problems]
    assert told == [
        (4, "nest.gap"),
        (5, "nest.offcut_credit"),
        (8, "process.speed"),
        (17, "stock[1].id"),
        (21, "part"),
    ]


def test_stock_of_one_name_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match='"Plate" is taken'):
        supply(tmp_path, FILE.replace('id = "any"', 'id = "Plate"'))


def test_a_common_line_needs_the_width_of_the_cut(tmp_path: Path) -> None:
    asked = FILE.replace("gap = 0.2", "gap = 0.2\ncommon_line = true")
    assert supply(tmp_path, asked).options.common_line
    with pytest.raises(BadInputError, match="the width of the cut is not known"):
        supply(tmp_path, asked.replace('type = "plasma"\n', ""))


def test_no_stock_is_no_supply(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match="stock"):
        supply(tmp_path, "schema = 1\n")


def test_what_had_to_be_put_right_is_told(tmp_path: Path) -> None:
    bow = "outline = { polyline = [[0, 0], [40, 0], [40, 30], [0, 40], [50, -5], [0, 0]] }\n"
    made = supply(tmp_path, FILE + f'[[stock]]\nid = "bow"\nkind = "hide"\n{bow}')
    assert {finding.code for finding in made.repairs} == {"stock-repaired"}
    assert all("bow" in finding.message for finding in made.repairs)
    assert not supply(tmp_path).repairs
