"""The job files that the README prints are taken as they stand, each laid over its first one."""

import re
import shutil
import tomllib
from pathlib import Path

import msgspec
import pytest

from pipeline.cli import main

ROOT = Path(__file__).parent.parent
BLOCKS = re.findall(r"^```toml\n(.*?)^```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL | re.MULTILINE)
HIDE = ROOT / "samples/hides/side-left.dxf"
"""Stands for the file that is named."""


def job(block: str) -> dict[str, object]:
    """Return the first job with the keys of a block: those of its material and its part one by one."""
    first, more = tomllib.loads(BLOCKS[0]), tomllib.loads(block)
    material = {"material": first["material"] | more.get("material", {})}
    part = {"part": [first["part"][0] | more.get("part", [{}])[0]]}
    return first | more | material | part


def test_a_whole_job_and_three_additions_are_printed() -> None:
    assert len(BLOCKS) == 4
    assert tomllib.loads(BLOCKS[0])["schema"] == 1


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: re.findall(r"\[+(\w+)", block)[0])
def test_a_job_that_is_printed_is_taken(block: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.json"
    file.write_bytes(msgspec.json.encode(job(block)))
    shutil.copy(HIDE, tmp_path / "hides.dxf")
    main(["check", str(file)])
    assert "1 part, no errors" in capsys.readouterr().err
