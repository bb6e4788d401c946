"""A job with a plate, a rolled shell and a bent angle, and sheets of what was measured of them."""

from pathlib import Path

import pytest

from pipeline.cli import main

JOB = """\
schema = 1
[report]
formats = ["json"]
[material]
name = "DC01"
thickness = 2
k_factor = 0.4
[process]
type = "laser"
kerf = 0.15
[[part]]
name = "=plate()"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [400, 0], [400, 300], [0, 300], [0, 0]] }
[[part.hole]]
name = "bore"
kind = "circle"
at = [100, 100]
diameter = 40
[[part]]
name = "shell"
[part.surface]
kind = "cylinder"
directrix = { arc = { center = [0, 0, 0], radius = 300, normal = [0, 0, 1], start = 0, end = 120 } }
direction = [0, 0, 1]
length = 250
[[part]]
name = "angle"
face = "inner"
[part.surface]
kind = "strip"
[[part.surface.pieces]]
kind = "cylinder"
directrix = { line = [[0, 40, 0], [0, 4, 0]] }
direction = [0, 0, 1]
length = 50
[[part.surface.pieces]]
kind = "cylinder"
directrix = { arc = { center = [4, 4, 0], radius = 4, normal = [0, 0, 1], start = 180, end = 270 } }
direction = [0, 0, 1]
length = 50
[[part.surface.pieces]]
kind = "cylinder"
directrix = { line = [[4, 0, 0], [60, 0, 0]] }
direction = [0, 0, 1]
length = 50
[[part.bend]]
max_angle = 90
"""
PLATE_NAME = "=plate()"
HEAD = "part,what,measured,unit,uncertainty\n"
GOOD = HEAD + "'=plate(),width,399.82,mm,0.05\n'=plate(),height,299.83,mm,0.05\n'=plate(),hole bore,40.17,mm,0.05\n"


def planish(*words: str | Path) -> int:
    """Return the exit code of a command."""
    with pytest.raises(SystemExit) as caught:
        main([str(word) for word in words])
        raise SystemExit(0)
    return int(caught.value.code or 0)


def sheet(folder: Path, text: str, name: str = "measured.csv") -> Path:
    """Write a sheet of measurements and return it."""
    file = folder / name
    file.write_bytes(text.encode())
    return file
