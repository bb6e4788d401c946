"""Job files for tests: the shortest ones that run, and ways to spoil them."""

from pathlib import Path

PLATE = """\
schema = 1
[report]
formats = ["json"]
[[part]]
name = "plate"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]] }
"""
"""The shortest job: a plate of 40 x 30, no stock."""

STOCK = """\
[[stock]]
id = "sheet"
width = 100
height = 60
price = 12.5
"""

TWISTED = """\
[[part]]
name = "twisted"
[part.surface]
kind = "ruled"
c0 = { line = [[0, 0, 0], [100, 0, 0]] }
c1 = { line = [[0, 0, 50], [100, 40, 50]] }
"""
"""A part that no sheet takes: a hyperbolic paraboloid."""

CONE = """\
[[part]]
name = "cone"
[part.surface]
kind = "cone"
radius0 = 10
radius1 = 4
height = 15
"""


def write_job(folder: Path, text: str = PLATE, name: str = "job.toml") -> Path:
    """Return a job file with that text."""
    file = folder / name
    file.write_text(text, "utf-8")
    return file
