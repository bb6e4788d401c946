"""`planish compare`: verdicts on their limits, the table and the document, what is never replaced."""

import json
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest

from pipeline.asmade.compare import comparison
from pipeline.asmade.document import compare_document, compare_lines, compare_schema, verdict_line
from tests.pipeline.asmadejobs import GOOD, HEAD, planish, sheet


@pytest.mark.parametrize(("measured", "passed"), [("400.3", True), ("399.7", True), ("400.30000000000001", False)])
def test_a_value_on_its_limit_passes_and_the_next_one_fails(made_job: Path, measured: str, passed: bool) -> None:
    file = sheet(made_job, f"part,what,measured,unit,uncertainty,tolerance\n'=plate(),width,{measured},mm,0.05,0.3\n")
    (one,) = comparison(made_job / "out", file, None).dimensions
    assert (one.passed, one.sure) == (passed, False)


def test_inches_are_exact_and_the_default_tolerance_is_told(made_job: Path) -> None:
    file = sheet(made_job, HEAD + "shell,width,9.8425196850393700787,in,0.002\n")
    (one,) = comparison(made_job / "out", file, None).dimensions
    assert abs(float(one.difference)) < 1e-15
    assert (one.reading.tolerance, one.reading.by) == (Fraction(1, 2), "ISO 2768-1 m")
    assert one.reading.uncertainty == Fraction("0.0508")


def test_exchanged_digits_are_recognised_and_a_part_that_is_merely_off_is_not(made_job: Path) -> None:
    rows = "'=plate(),width,040.0,mm,0.05\nshell,width,520.0,mm,0.05\nangle,width,50.4,mm,0.05\n"
    file = sheet(made_job, HEAD + rows)
    slips = [one.slip for one in comparison(made_job / "out", file, None).dimensions]
    assert slips == ["400.0", "250.0", ""]


def test_the_command_writes_a_table_and_a_document_of_its_schema(
    made_job: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = sheet(tmp_path, GOOD)
    assert planish("compare", made_job / "out", file) == 0
    plain = capfd.readouterr()
    assert "kerf = 0.17" in plain.out
    assert plain.out.splitlines()[-1] == "3 measured; all within tolerance"
    assert planish("compare", made_job / "out", file, "--json") == 0
    content = (tmp_path / "compare.json").read_text("utf-8")
    assert capfd.readouterr().out == content
    jsonschema.validate(json.loads(content), json.loads(compare_schema()))
    assert json.loads(content)["fits"][0]["interval_95"][0] < 0.1733 < json.loads(content)["fits"][0]["interval_95"][1]
    assert not (made_job / "out" / "compare.json").exists()


def test_a_size_out_of_tolerance_ends_with_1_and_stands_first(made_job: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, GOOD + "angle,width,51,mm,0.05\n")
    assert planish("compare", made_job / "out", file, "--json") == 1
    lines = list(compare_lines(comparison(made_job / "out", file, None)))
    assert lines[1].split()[0] == "angle"
    assert lines[1].endswith("FAIL")


def test_what_no_tolerance_is_known_of_is_not_said_to_be_within_it(made_job: Path, tmp_path: Path) -> None:
    without = HEAD + "angle,thickness,2.01,mm,0.05\n"
    assert verdict_line(comparison(made_job / "out", sheet(tmp_path, without), None)) == (
        "1 measured; 1 without a tolerance"
    )
    some = verdict_line(comparison(made_job / "out", sheet(tmp_path, without + "angle,width,50.1,mm,0.05\n"), None))
    assert some == "2 measured; all others within tolerance; 1 without a tolerance"


def test_a_file_that_is_no_comparison_is_not_replaced(made_job: Path, tmp_path: Path) -> None:
    (tmp_path / "compare.json").write_text('{"my": "notes"}', "utf-8")
    assert planish("compare", made_job / "out", sheet(tmp_path, GOOD)) == 2
    assert (tmp_path / "compare.json").read_text("utf-8") == '{"my": "notes"}'


def test_the_usage_is_told(made_job: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert planish("compare", made_job / "out") == 2
    assert "either a sheet of measurements or --template" in capfd.readouterr().err
    assert planish("compare", tmp_path, "x.csv") == 2
    assert "give the output folder of a finished job" in capfd.readouterr().err
    assert planish("compare", made_job / "out", "x.csv") == 2
    assert planish("schema", "--compare") == 0


def test_the_report_of_pooled_jobs_is_called_that(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "report.json").write_text('{"schema": "planish-pool/1", "status": "made", "groups": []}', "utf-8")
    assert planish("compare", "--template", tmp_path) == 2
    told = capfd.readouterr().err
    assert 'report.json: schema: "planish-pool/1" is not the report of a job (give the output folder of' in told


def test_the_same_readings_give_the_same_document(made_job: Path, tmp_path: Path) -> None:
    file = sheet(tmp_path, GOOD)
    one, other = (compare_document(comparison(made_job / "out", file, None)) for _ in range(2))
    assert json.dumps(one) == json.dumps(other)
