"""Cut files certified as they read back: a file that was tampered with is no cut file."""

import io
import json
from pathlib import Path

import ezdxf
import pytest

from pipeline.certified import certified_files, written
from pipeline.cli import main
from stages.geometry.curves.rigid import Rigid2
from stages.model.cutfile import CutFile, Machine
from stages.model.report import Finding
from stages.model.sheet import Nesting, NestOptions, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.drawing import sheet_drawing
from stages.write.dxf import dxf_text
from tests.pipeline.jobs import PLATE, STOCK, write_job
from tests.stages.nest.shapes import rectangle
from tests.stages.write.patterns import plate, sector

SHEET = Sheet("stock", 1000.0, 1000.0, edge_gap_mm=5.0)
OPTIONS = NestOptions(gap_mm=5.0)
PARTS = [plate(), sector()]


def placed(x: float) -> Nesting:
    """Return a plate and a sector, some of the way apart."""
    motions = (Rigid2(100.0, 300.0), Rigid2(x, 300.0, 30.0))
    laid = tuple(Placement(part.part, 1, motion) for part, motion in zip(PARTS, motions, strict=True))
    return Nesting((SheetLayout(SHEET, 1, laid, 0.0),))


GOOD = placed(600.0)


def sheet_text(nesting: Nesting) -> str:
    return next(file.text for file in write(PARTS, nesting, Machine()).product if file.path == "cut/stock-1.dxf")


def judged(text: str, nesting: Nesting = GOOD) -> list[Finding]:
    return list(certified_files([CutFile("cut/stock-1.dxf", text)], nesting, PARTS, OPTIONS)[1])


def test_files_that_hold_the_nest_pass_with_their_gaps_in_the_report() -> None:
    outcome = written(PARTS, GOOD, Machine(), OPTIONS)
    assert outcome.report.passed
    names = [metric.name for metric in outcome.report.metrics]
    assert names[-3:] == ["min_gap_mm", "min_edge_gap_mm", "overlap_mm2"]
    assert outcome.report.metric("min_gap_mm").value > 5.0
    assert outcome.report.metric("overlap_mm2").evidence == "proved"


def test_without_a_nest_there_is_nothing_to_certify() -> None:
    outcome = written(PARTS, None, Machine(), OPTIONS)
    assert outcome.report.passed
    assert "min_gap_mm" not in [metric.name for metric in outcome.report.metrics]


def tampered(text: str, layer: str, number: int, by: float) -> str:
    """Return the file with one contour moved to the right."""
    document = ezdxf.read(io.StringIO(text))
    entity = [one for one in document.modelspace() if one.dxf.layer == layer][number]
    entity.translate(by, 0.0, 0.0)
    out = io.StringIO()
    document.write(out)
    return out.getvalue()


@pytest.mark.parametrize("layer", ["CUT_OUTER", "CUT_INNER"])
def test_a_contour_that_is_not_where_it_was_placed_is_found(layer: str) -> None:
    assert judged(sheet_text(GOOD)) == []
    assert judged(tampered(sheet_text(GOOD), layer, 0, 0.0)) == []
    assert [one.code for one in judged(tampered(sheet_text(GOOD), layer, 0, 1e-3))] == ["file-copies"]


def test_a_file_whose_parts_are_too_near_is_found_by_the_file_alone() -> None:
    metrics, _ = certified_files([CutFile("cut/stock-1.dxf", sheet_text(GOOD))], GOOD, PARTS, OPTIONS)
    gap = next(metric.value for metric in metrics if metric.name == "min_gap_mm")
    near = placed(600.0 - float(gap or 0.0) + 4.0)
    assert [one.code for one in judged(sheet_text(near), near)] == ["gap"]
    outcome = written(PARTS, near, Machine(), OPTIONS)
    assert not outcome.report.passed


def test_a_job_whose_file_is_wrong_exits_3_without_a_cut_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job = write_job(tmp_path, PLATE + STOCK)
    with pytest.raises(SystemExit) as good:
        main(["run", str(job), "-o", str(tmp_path / "good"), "--quiet"])
    assert good.value.code == 0
    assert (tmp_path / "good" / "cut").exists()

    def refused(*_: object) -> tuple[tuple[()], tuple[Finding, ...]]:
        return (), (Finding("gap", "planted", fatal=True),)

    monkeypatch.setattr("stages.nest.legal.files.certify_contours", refused)
    with pytest.raises(SystemExit) as bad:
        main(["run", str(job), "-o", str(tmp_path / "bad"), "--quiet"])
    assert bad.value.code == 3
    assert not (tmp_path / "bad" / "cut").exists()
    report = json.loads((tmp_path / "bad" / "report.json").read_text())
    assert [finding["code"] for finding in report["write"]["findings"]] == ["gap"]


def test_parts_that_share_cuts_are_certified_as_they_are_put_together_again() -> None:
    parts = [rectangle("a", 100.0, 60.0), rectangle("b", 80.0, 60.0), rectangle("c", 90.0, 50.0)]
    motions = (Rigid2(20.0, 20.0), Rigid2(120.2, 20.0), Rigid2(20.0, 80.2))
    laid = tuple(Placement(part.part, 1, motion) for part, motion in zip(parts, motions, strict=True))
    nest = Nesting((SheetLayout(SHEET, 1, laid, 0.0),))
    machine = Machine(common_kerf_mm=0.2)
    text = dxf_text(sheet_drawing(nest.layouts[0], {part.part: part for part in parts}, machine), machine)
    for options, wanted in (
        (NestOptions(5.0, kerf_mm=0.2, common_line=True), []),
        (NestOptions(5.0, kerf_mm=0.3, common_line=True), ["file-copies"] * 3),
    ):
        metrics, findings = certified_files([CutFile("cut/stock-1.dxf", text)], nest, parts, options)
        assert [finding.code for finding in findings] == wanted
        assert not wanted or metrics == ()


def test_parts_in_files_of_their_own_are_measured_as_they_lie_on_the_sheets() -> None:
    together = written(PARTS, GOOD, Machine(), OPTIONS).report
    alone = written(PARTS, GOOD, Machine(file_per="part", file_name="{part}"), OPTIONS).report
    assert alone.passed
    for name in ("min_gap_mm", "min_edge_gap_mm", "overlap_mm2"):
        assert alone.metric(name).value == pytest.approx(together.metric(name).value, abs=1e-8)
    near = placed(600.0 - together.metric("min_gap_mm").value + 4.0)
    report = written(PARTS, near, Machine(file_per="part", file_name="{part}"), OPTIONS).report
    assert [one.code for one in report.findings] == ["gap"]
