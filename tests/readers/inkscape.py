"""Inkscape's own importer of DXF, the program that Inkscape calls: layers are groups, arcs are arcs, pixels of 1/96 in.

It is a program in Python that needs the distribution's packages, so it is run with the distribution's Python.
"""

import re
import subprocess
from collections.abc import Iterator, Sequence
from math import ceil, pi, radians
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from stages.geometry.arrays import Points2
from tests.readers.reading import Fineness, Piece, Reader, Reading

IMPORTER = Path("/usr/share/inkscape/extensions/dxf_input.py")
PYTHON = Path("/usr/bin/python3")
PIXEL_MM = 25.4 / 96.0
STEP_RAD = radians(1.0)
"""The arcs of the picture are divided here, so finely that what is left is Inkscape's own."""

GRID_MM = 0.005 * PIXEL_MM
"""Six digits of a pixel, of numbers up to 9999: the ends of single lines."""

SCRIPT = """
import runpy, sys
importer, *paths = sys.argv[1:]
sys.path.insert(0, importer.rpartition("/")[0])
for path in paths:
    sys.argv = [importer, "--output=" + path[:-3] + "svg", path]
    runpy.run_path(importer, run_name="__main__")
"""

DOT = "A 0.250000,0.250000 "
"""What it draws for a POINT: a dot of a quarter of a pixel."""

SVG = "{http://www.w3.org/2000/svg}"
HREF = "{http://www.w3.org/1999/xlink}href"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def available() -> bool:
    return IMPORTER.exists() and PYTHON.exists()


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    """Return what one process makes of all files, the importer run anew for each."""
    command = [str(PYTHON), "-c", SCRIPT, str(IMPORTER), *map(str, paths)]
    subprocess.run(command, capture_output=True, check=True, timeout=60)
    return {path.stem: _read(path.with_suffix(".svg").read_bytes()) for path in paths}


def _read(picture: bytes) -> Reading:
    root = ElementTree.fromstring(picture)
    height = float(root.get("height", "0"))
    pieces, texts = [], []
    symbols = {f"#{one.get('id')}": one for one in root.iter(f"{SVG}symbol")}
    for group in root.findall(f"{SVG}g"):
        group.extend([symbols[use.get(HREF, "")] for use in group.findall(f"{SVG}use")])
        texts += ["".join(one.itertext()) for one in group.iter(f"{SVG}text")]
        for line in group.iter(f"{SVG}path"):
            if DOT in line.get("d", ""):
                continue
            points, closed = _points(line.get("d", ""))
            pieces.append(Piece(group.get(LABEL, ""), (points * [1.0, -1.0] + [0.0, height]) * PIXEL_MM, closed))
    return Reading(tuple(pieces), tuple(texts))


def _points(described: str) -> tuple[Points2, bool]:
    """Return the points of a path of M, L, A and z; ValueError for any other letter."""
    made: list[Points2] = []
    closed = False
    for letter, numbers in _commands(described):
        if letter in "ML":
            made.append(np.array([numbers]))
        elif letter == "A":
            made.append(_arc(made[-1][-1], numbers))
        elif letter in "zZ":
            made.append(made[0][:1])
            closed = True
        else:
            raise ValueError(f"a path of Inkscape with the letter {letter}")
    return np.concatenate(made), closed


def _commands(described: str) -> Iterator[tuple[str, list[float]]]:
    for letter, rest in re.findall(r"([A-Za-z])([^A-DF-Za-df-z]*)", described):
        yield letter, [float(word) for word in re.split(r"[ ,]+", rest.strip()) if word]


def _arc(start: Points2, numbers: list[float]) -> Points2:
    """Return points on a circular arc as SVG states it: radii, turn, large, sweep, end."""
    radius, _, _, large, sweep, *end = numbers
    chord = complex(end[0] - start[0], end[1] - start[1])
    half = min(abs(chord) / 2.0, radius)
    aside = np.sqrt(radius**2 - half**2) * (1.0 if large != sweep else -1.0)
    centre = complex(*start) + chord / 2.0 + 1j * chord / abs(chord) * aside
    arm = complex(*start) - centre
    angle = np.angle((complex(*end) - centre) / arm)
    turn = angle % (2.0 * pi) if sweep else -((-angle) % (2.0 * pi))
    steps = np.linspace(0.0, turn, ceil(abs(turn) / STEP_RAD) + 1)[1:]
    points = centre + arm * np.exp(1j * steps)
    points[-1] = complex(*end)
    return np.column_stack([points.real, points.imag])


READER = Reader("Inkscape", available, read, Fineness(step_rad=STEP_RAD, grid_mm=GRID_MM), block_layers=False)
