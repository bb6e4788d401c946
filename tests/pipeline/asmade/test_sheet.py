"""Sheets of measurements are read strictly, and everything that is wrong with one is told at once."""

from fractions import Fraction
from pathlib import Path

import pytest

from pipeline.asmade.nominal import Nominal
from pipeline.asmade.sheet import read_sheet
from stages.errors import BadInputError
from tests.pipeline.asmadejobs import HEAD, sheet

BAD = {
    "comma": ('angle,width,"50,1",mm,0.05', 'measured: "50,1" is no number (write a decimal point, not a comma)'),
    "bare comma": ("angle,width,50,1,mm,0.05", "6 cells, and 5 columns (a decimal comma? write a decimal point)"),
    "nan": ("angle,width,nan,mm,0.05", 'measured: "nan" is no number'),
    "inf": ("angle,width,1e99999,mm,0.05", 'measured: "1e99999" is no number'),
    "huge": ("angle,width,1e30,mm,0.05", 'measured: "1e30" is out of range'),
    "other digits": ("angle,width,٥٠,mm,0.05", "is no number"),
    "unit": ("angle,width,50,deg,0.05", 'unit: "deg" is no unit of this (mm | cm | m | in)'),
    "no unit": ("angle,width,50,,0.05", "unit: the unit is missing"),
    "uncertainty": ("angle,width,50,mm,", "uncertainty: the uncertainty is missing"),
    "certain": ("angle,width,50,mm,0", "no instrument measures without error"),
    "negative": ("angle,width,-50,mm,0.05", "is not above 0"),
    "part": ("angel,width,50,mm,0.05", 'part: "angel" is no part of this job (did you mean "angle"?)'),
    "what": ("angle,widht,50,mm,0.05", 'did you mean "width"?'),
    "twice": ("angle,width,50,mm,0.05\nangle,width,50,mm,0.05", "is on line 2 already (number the copies"),
    "formula": ("angle,width,=1+1,mm,0.05", 'measured: "=1+1" is no number'),
    "quote": ('angle,"width,50,mm,0.05', "is no table of commas"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_wrong_is_told_with_its_line_and_cure(made_job: Path, nominal: Nominal, name: str) -> None:
    rows, told = BAD[name]
    file = sheet(made_job, HEAD + rows + "\n")
    with pytest.raises(BadInputError) as caught:
        read_sheet(file, nominal)
    (problem,) = caught.value.problems
    assert told in str(problem)
    assert problem.file == str(file)
    assert problem.line == (3 if name == "twice" else 2)


def test_all_errors_come_at_once(made_job: Path, nominal: Nominal) -> None:
    with pytest.raises(BadInputError) as caught:
        read_sheet(sheet(made_job, HEAD + "angle,width,x,ell,\nnobody,y,1,mm,0.1\n"), nominal)
    assert [problem.line for problem in caught.value.problems] == [2, 2, 2, 3]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (b"", "is empty"),
        (b"part;what;measured\n", "parted by semicolons"),
        (b"part,what,measured,unit\n", "uncertainty: the column is missing"),
        (b"part,part,what,measured,unit,uncertainty,sum\n", "the column is there twice"),
        (b"part,what,measured,unit,uncertainty\n\xff\xfe,1\n", "is not UTF-8"),
    ],
)
def test_what_is_no_sheet_is_told(made_job: Path, nominal: Nominal, text: bytes, told: str) -> None:
    file = made_job / "bad.csv"
    file.write_bytes(text)
    with pytest.raises(BadInputError) as caught:
        read_sheet(file, nominal)
    assert told in str(caught.value)


def test_a_sheet_of_another_run_is_refused(made_job: Path, nominal: Nominal) -> None:
    rows = "part,what,nominal,measured,unit,uncertainty\nangle,width,51,50.0,mm,0.05\n"
    with pytest.raises(BadInputError, match="another run"):
        read_sheet(sheet(made_job, rows), nominal)


def test_byte_order_marks_crlf_and_columns_in_any_order_are_read(made_job: Path, nominal: Nominal) -> None:
    text = "\ufeffunit,what,Part,uncertainty,measured\r\nmm,width,angle,0.05, 50.1 \r\n\r\n"
    (one,) = read_sheet(sheet(made_job, text), nominal).readings
    assert (one.measured, one.line) == (Fraction("50.1"), 2)
