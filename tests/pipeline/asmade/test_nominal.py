"""What can be measured of a job: sizes of closed forms, general tolerances of the standard, an empty sheet."""

import csv
import io
import json
from hashlib import sha256
from math import pi
from pathlib import Path

import numpy as np
import pytest

from pipeline.asmade.nominal import Nominal
from pipeline.asmade.rows import COLUMNS
from pipeline.asmade.sheet import read_sheet, template
from pipeline.asmade.sizes import ISO_2768_ANGLES, ISO_2768_M, length_tolerance
from stages.errors import BadInputError
from tests.near import assert_near
from tests.pipeline.asmadejobs import PLATE_NAME, sheet


def test_sizes_of_the_blank_and_of_the_formed_part_are_those_of_closed_forms(nominal: Nominal) -> None:
    sizes = {(one.part, one.what): one.nominal for one in nominal.dimensions}
    assert sizes[PLATE_NAME, "diagonal 1"] == 500.0
    assert sizes[PLATE_NAME, "hole bore"] == 40.0
    assert sizes["shell", "roll 1 radius"] == 299.0
    assert (sizes["angle", "flange 1"], sizes["angle", "flange 2"]) == (42.0, 62.0)
    assert_near(sizes["angle", "height"], 36 + 56 + pi / 2 * (4 + 0.4 * 2), bound=5e-7, why="rounded to 1e-6 mm")


def test_nominal_sizes_say_which_job_and_which_report_they_are_of(made_job: Path, nominal: Nominal) -> None:
    content = (made_job / "out" / "report.json").read_bytes()
    assert nominal.digest == json.loads(content)["job"]["digest"]
    assert nominal.report_sha256 == sha256(content).hexdigest()


def test_the_empty_sheet_names_everything_and_reads_as_nothing_measured(made_job: Path, nominal: Nominal) -> None:
    text = template(nominal)
    rows = list(csv.DictReader(io.StringIO(text)))
    assert list(rows[0]) == list(COLUMNS)
    assert {row["part"] for row in rows} == {"'=plate()", "shell", "angle"}
    with pytest.raises(BadInputError, match="nothing is measured"):
        read_sheet(sheet(made_job, text), nominal)


@pytest.mark.parametrize(
    ("size", "limit"), [(0.4, None), (3.0, 0.1), (30.0, 0.2), (30.5, 0.3), (4000.0, 2.0), (4001.0, None)]
)
def test_general_tolerances_are_those_of_the_table(size: float, limit: float | None) -> None:
    assert length_tolerance(size) == limit


def test_both_tables_of_general_tolerances_are_those_of_the_standard() -> None:
    lengths = {3: "0.1", 6: "0.1", 30: "0.2", 120: "0.3", 400: "0.5", 1000: "0.8", 2000: "1.2", 4000: "2"}
    minutes = {10: 60, 50: 30, 120: 20, 400: 10, np.inf: 5}
    assert dict(ISO_2768_M) == {size: float(limit) for size, limit in lengths.items()}
    for (leg, limit), (most, minute) in zip(ISO_2768_ANGLES, minutes.items(), strict=True):
        assert leg == most
        assert_near(60.0 * limit, float(minute), bound=1e-12, why="minutes of arc as degrees")
