"""Finished jobs that cannot be nested together are refused, and all that is against them is told at once."""

import json
from pathlib import Path

import pytest

from pipeline.finished import all_finished, finished
from tests.pipeline.pooledjobs import (
    Folders,
    folders_in,
    pooled,
    problems_of,
)


@pytest.fixture
def folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Folders:
    """Return the output folders of some jobs, below the folder where the test runs."""
    monkeypatch.chdir(tmp_path)
    return folders_in(tmp_path)


def test_jobs_without_any_stock_are_refused(folders: Folders) -> None:
    (text,) = problems_of(lambda: pooled(folders("second")))
    assert text == (
        'no stock for "mild-steel-2mm" in job "second" '
        "(give a file of stock with --stock, or [[stock]] in the first of the jobs)"
    )


def test_a_part_with_a_direction_needs_stock_with_one(folders: Folders) -> None:
    (folder,) = folders("first")
    report = json.loads((folder / "report.json").read_text("utf-8"))
    report["parts"][0]["nest"]["axis_deg"] = 0.0
    (folder / "report.json").write_text(json.dumps(report), "utf-8")
    (text,) = problems_of(lambda: pooled([folder]))
    assert '"first/plate" lies along the grain, that of the stock "sheet" is not known' in text


def spoilt(folder: Path, **changes: object) -> Path:
    """Return the folder with its report changed."""
    report = json.loads((folder / "report.json").read_text("utf-8"))
    (folder / "report.json").write_text(json.dumps({**report, **changes}), "utf-8")
    return folder


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"status": "rejected"}, "report.json: status: the job is rejected, not made"),
        ({"status": "no-solution"}, "report.json: status: the job is no-solution, not made"),
        ({"schema": "planish-pool/1"}, '"planish-pool/1" is not the report of a job'),
        ({"parts": [{"name": "plate"}]}, "is no report that can be read: Object missing required field"),
        ({"nest": {"stock": [{"id": "x"}]}}, "is no report that can be read"),
    ],
)
def test_what_is_not_a_finished_job_is_refused(folders: Folders, changes: dict[str, object], message: str) -> None:
    (folder,) = folders("first")
    (text,) = problems_of(lambda: finished(spoilt(folder, **changes)))
    assert message in text
    assert text.startswith("first/report.json")


def test_a_stock_that_is_none_is_refused(folders: Folders) -> None:
    (folder,) = folders("first")
    nest = json.loads((folder / "report.json").read_text("utf-8"))["nest"]
    nest["stock"][0]["outline"] = {"vertices": [[0.0, 0.0]], "bulges": [0.0]}
    (text,) = problems_of(lambda: finished(spoilt(folder, nest=nest)))
    assert "nest.stock[0]" in text


def test_everything_against_all_jobs_is_told_at_once(folders: Folders) -> None:
    first, second, thin = folders("first", "second", "thin")
    drawing = first / "flat" / "plate.dxf"
    drawing.write_bytes(drawing.read_bytes().replace(b"40.0", b"40.1"))
    (second / "flat" / "holed.dxf").unlink()
    spoilt(thin, status="rejected")
    told = problems_of(lambda: all_finished([first, second, thin, Path("nowhere")]))
    assert [text.partition(" (")[0] for text in told] == [
        "first/flat/plate.dxf: the drawing was changed after the job had been made",
        "second/flat/holed.dxf: the drawing is missing",
        "thin/report.json: status: the job is rejected, not made",
        "nowhere/report.json: cannot be read: No such file or directory",
    ]


def test_a_changed_byte_of_a_drawing_is_seen(folders: Folders) -> None:
    (folder,) = folders("first")
    assert len(finished(folder).patterns) == 1
    drawing = folder / "flat" / "plate.dxf"
    drawing.write_bytes(drawing.read_bytes() + b"\n")
    assert len(problems_of(lambda: finished(folder))) == 1
