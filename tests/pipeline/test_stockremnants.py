"""The remnants of earlier jobs as the stock of the next."""

from pathlib import Path

import pytest

from pipeline.job import job_of
from pipeline.jobfile import read
from tests.pipeline.jobs import PLATE, write_job
from tests.pipeline.stockjobs import FROM_REMNANTS, job, refused, remnants


def test_the_remnants_of_a_job_are_stock_for_the_next(tmp_path: Path) -> None:
    remnants(tmp_path)
    first, second = job(tmp_path, FROM_REMNANTS + '[material]\nname = "mild steel"\nthickness = 2\n').stock
    assert [first.id, first.kind, first.quantity, first.edge_gap_mm] == ["plate-1", "remnant", 1, 4.0]
    assert [first.width_mm, first.height_mm, first.grain_deg] == [812.5, 100.25, 90.0]
    assert [second.id, second.height_mm] == ["plate-2", 200.5]


def test_remnants_are_in_mm_whatever_the_units_of_the_job(tmp_path: Path) -> None:
    remnants(tmp_path)
    text = PLATE.replace("schema = 1", 'schema = 1\nunits = "in"') + '[[stock]]\nfile = "remnant.json"\n'
    assert job_of(read(write_job(tmp_path, text))).stock[0].width_mm == 812.5


def test_one_remnant_may_be_asked_for_and_named(tmp_path: Path) -> None:
    remnants(tmp_path)
    assert [s.id for s in job(tmp_path, FROM_REMNANTS + 'entry = "plate-2"\n').stock] == ["plate-2"]
    assert [s.id for s in job(tmp_path, FROM_REMNANTS + 'entry = "plate-2"\nid = "rest"\n').stock] == ["rest"]
    assert [s.id for s in job(tmp_path, FROM_REMNANTS + 'id = "rest"\n').stock] == ["rest-plate-1", "rest-plate-2"]


def test_what_is_not_known_of_a_remnant_is_not_held_against_it(tmp_path: Path) -> None:
    remnants(tmp_path, material=None, thickness_mm=None, grain_deg=None)
    made = job(tmp_path, FROM_REMNANTS + '[material]\nname = "brass"\nthickness = 3\ngrain = 7\n')
    assert [sheet.grain_deg for sheet in made.stock] == [7.0, 7.0]


BAD_REMNANTS = {
    "another material": ('[material]\nname = "brass"\n', {}, 'stock[0]: "plate-1" is of "DC01"'),
    "another thickness": ("[material]\nthickness = 3\n", {}, 'stock[0]: "plate-1" is 2 mm thick'),
    "no width": ("", {"width_mm": None}, "stock[0].file: remnant plate-1: width_mm: nothing (null) where"),
    "no height": ("", {"height_mm": 0}, "stock[0].file: remnant plate-1: height_mm is 0 (must be above 0)"),
    "no such remnant": ('entry = "plate-3"\n', {}, 'stock[0].entry: there is no "plate-3" in the file (did you mean'),
}


@pytest.mark.parametrize("name", BAD_REMNANTS)
def test_a_remnant_that_does_not_do_is_refused(tmp_path: Path, name: str) -> None:
    table, changes, wanted = BAD_REMNANTS[name]
    remnants(tmp_path, **changes)
    if not table.startswith("entry"):
        table = f'entry = "plate-1"\n{table}'
    assert wanted in refused(tmp_path, FROM_REMNANTS + table)
