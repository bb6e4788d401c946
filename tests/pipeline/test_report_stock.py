"""What a report says of the stock: kind, used length of a roll, cost; and the notes on what was put right."""

import json
import math
from importlib.resources import files
from pathlib import Path

import jsonschema

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import outputs
from pipeline.report.stockfigures import layout_lines
from pipeline.run import run_job
from stages.geometry.curves.rigid import Rigid2
from stages.model.sheet import Placement, Rectangle, Sheet, SheetLayout
from tests.near import assert_near
from tests.pipeline.jobs import PLATE, STOCK, write_job
from tests.pipeline.test_stock import HIDE, ROLL
from tests.stages.nest.shapes import rectangle

NO_SEARCH = "[nest]\ntime_limit = 0.1\n"


def sheets(folder: Path, *tables: str, part: str = "") -> tuple[list[dict], dict[str, bytes]]:
    text = PLATE.replace('name = "plate"\n', f'name = "plate"\n{part}')
    _, produced = outputs(run_job(job_of(read(write_job(folder, text + "".join(tables) + NO_SEARCH)))))
    report = json.loads(produced["report.json"])
    schema = json.loads(files("pipeline").joinpath("data", "report-schema.json").read_text("utf-8"))
    jsonschema.Draft202012Validator(schema).validate(report)
    assert report["status"] == "made", report["nest"]
    return report["nest"]["sheets"], produced


def test_a_roll_costs_what_is_used_of_it(tmp_path: Path) -> None:
    (sheet,), _ = sheets(tmp_path, ROLL + "edge_gap = 5\n")
    assert sheet["kind"] == "roll"
    # the plate of 40 x 30 lies at the beginning, one of its sides along the roll
    assert min(abs(sheet["used_length_mm"] - used) for used in (30.0 + 10.0, 40.0 + 10.0)) < 1e-6
    assert_near(sheet["cost"], 12.0 * sheet["used_length_mm"] / 1000.0, bound=1e-12, why="12 a metre")


def test_a_sheet_costs_its_price_and_has_no_used_length(tmp_path: Path) -> None:
    (sheet,), _ = sheets(tmp_path, STOCK)
    assert [sheet["kind"], sheet["used_length_mm"], sheet["cost"]] == ["sheet", None, 12.5]
    (unpriced,), _ = sheets(tmp_path, STOCK.replace("price = 12.5\n", ""))
    assert unpriced["cost"] is None


def test_a_part_on_a_hide_keeps_out_of_its_zone_and_off_its_defect(tmp_path: Path) -> None:
    (sheet,), produced = sheets(tmp_path, HIDE, part="quantity = 30\n")
    assert (sheet["kind"], len(sheet["placements"])) == ("hide", 30)
    assert "cut/hide-1.dxf" in produced
    assert json.loads(produced["report.json"])["job"]["notes"] == []


def test_what_was_put_right_is_a_finding_of_the_nest(tmp_path: Path) -> None:
    _, produced = sheets(tmp_path, HIDE.replace("[200, 200]", "[12, 200]"))
    report = json.loads(produced["report.json"])
    message = 'stock "hide": defects[0] touch or cross the edge: what they cover of it is left out'
    wanted = {"code": "stock-repaired", "message": message, "fatal": False, "where": {"stock": "hide"}}
    assert wanted in report["nest"]["findings"]
    assert report["job"]["notes"] == [message]


def test_the_terminal_tells_of_each_sheet_what_is_used_and_left_over() -> None:
    parts = {"bar": rectangle("bar", 100.0, 40.0)}
    placed = (Placement("bar", 1, Rigid2(10.0, 10.0)), Placement("bar", 2, Rigid2(120.0, 10.0)))
    roll = SheetLayout(Sheet("coil", math.inf, 300.0, edge_gap_mm=5.0, kind="roll"), 1, placed, 0.124)
    sheet = SheetLayout(Sheet("plate", 500.0, 300.0), 2, placed[:1], 0.5, Rectangle(250.0, 0.0, 250.0, 300.0))
    assert list(layout_lines([roll, sheet], parts)) == [
        "sheet  coil 1  roll  2 pieces  utilisation 12.4 %  used 225 mm",
        "sheet  plate 2  1 piece  utilisation 50.0 %  left over 250 x 300 mm",
    ]
    many = list(layout_lines([sheet] * 20, parts))
    assert (len(many), many[-1]) == (13, "sheet  and 8 more: see report.json")
