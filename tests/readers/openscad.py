"""OpenSCAD's `import`: the closed contours of a layer as areas; 2021.01 bends no polyline and knows no old ones.

Asked for the layers that are cut; what it makes of them is written as SVG, on a grid of 1/1024 mm, in six digits.
"""

import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from math import radians
from pathlib import Path

import numpy as np

from stages.model.patternlayers import BOUNDARY, CUT_OUT
from tests.readers.reading import Fineness, Piece, Reader, Reading

ASKED = "CUT_OUTER", "CUT_INNER", BOUNDARY, CUT_OUT
"""What is cut, as drawings and as pattern files call it."""

STEP_DEG, STEP_MM = 0.5, 0.05
"""Its $fa and $fs: arcs take the larger step of the two, on the smallest radius of the samples, 4 mm, 0.72 degrees."""

LARGEST_STEP_RAD = radians(0.72)
GRID_MM = 1.0 / 1024.0


def available() -> bool:
    return shutil.which("openscad") is not None


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    return {path.stem: Reading(tuple(piece for layer in ASKED for piece in _layer(path, layer))) for path in paths}


def _layer(path: Path, layer: str) -> Iterator[Piece]:
    """Yield the contours of a layer; none where OpenSCAD finds nothing to write."""
    script, answer = path.with_suffix(".scad"), path.with_suffix(".svg")
    answer.unlink(missing_ok=True)
    script.write_text(f'$fa = {STEP_DEG}; $fs = {STEP_MM}; import("{path}", layer = "{layer}");')
    subprocess.run(["openscad", "-o", str(answer), str(script)], capture_output=True, check=False, timeout=60)
    described = re.findall(r' d="([^"]*)"', answer.read_text()) if answer.exists() else []
    for ring in re.findall(r"M([^z]*)z", " ".join(described)):
        points = np.array(re.findall(r"([-\d.e]+),([-\d.e]+)", ring), dtype=np.float64) * [1.0, -1.0]
        yield Piece(layer, np.concatenate([points, points[:1]]), closed=True)


FINENESS = Fineness(step_rad=LARGEST_STEP_RAD, grid_mm=GRID_MM)
READER = Reader("OpenSCAD", available, read, FINENESS, only=ASKED)
