"""Dia's import of DXF, by the SVG that it exports: 20 units of that are one of the drawing, and y runs down.

It keeps layers, takes numbers as they are, and knows no LWPOLYLINE, no bulge, and no closed POLYLINE.
"""

import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from math import asin, hypot, pi, tan
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from stages.geometry.arrays import Points2
from tests.readers.entities import STEP_RAD, arc, polyline
from tests.readers.reading import Fineness, Piece, Reader, Reading

SVG = "{http://www.w3.org/2000/svg}"
SCALE = 20.0
NUMBER = re.compile(r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?")
GRID_MM = 5e-3
"""It writes six digits: 0.05 units from 10000 on, which are 500 mm."""


def available() -> bool:
    return shutil.which("dia") is not None


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    for path in paths:
        command = ["dia", "-n", "-t", "svg", "-e", str(path.with_suffix(".svg")), str(path)]
        subprocess.run(command, capture_output=True, check=True, timeout=60)
    return {path.stem: _read(path.with_suffix(".svg")) for path in paths}


def _read(path: Path) -> Reading:
    root = ElementTree.parse(path).getroot()
    texts = tuple("".join(one.itertext()).strip() for one in root.iter(f"{SVG}text"))
    pieces = [
        Piece(layer.get("id", ""), points / SCALE * np.array([1.0, -1.0]))
        for layer in root.iter(f"{SVG}g")
        for points in _curves(layer)
    ]
    return Reading(tuple(pieces), texts)


def _curves(layer: ElementTree.Element) -> Iterator[Points2]:
    """Yield the curves of a layer as points, in units of the picture."""
    for one in layer:
        kind = one.tag.removeprefix(SVG)
        if kind == "line":
            yield np.array([[_of(one, "x1"), _of(one, "y1")], [_of(one, "x2"), _of(one, "y2")]])
        elif kind == "ellipse":
            yield arc(complex(_of(one, "cx"), _of(one, "cy")), _of(one, "rx"), 0.0, 0.0)
        elif kind in ("polyline", "polygon"):
            points = np.array([float(word) for word in NUMBER.findall(one.get("points", ""))]).reshape(-1, 2)
            yield np.vstack([points, points[:1]]) if kind == "polygon" else points
        elif kind == "path":
            yield _arc(one.get("d", ""))


def _of(one: ElementTree.Element, name: str) -> float:
    return float(one.get(name, "nan"))


def _arc(data: str) -> Points2:
    """Return the points of an arc: start, two radii, a turn of 0, whether it is the larger one, its sense, its end."""
    x0, y0, radius, _, _, large, sense, x1, y1 = (float(word) for word in NUMBER.findall(data))
    half = asin(min(hypot(x1 - x0, y1 - y0) / (2.0 * radius), 1.0))
    bulge = tan((pi - half if large else half) / 2.0) * (1.0 if sense else -1.0)
    return polyline([complex(x0, y0), complex(x1, y1)], [bulge, 0.0], closed=False)


READER = Reader("Dia", available, read, Fineness(step_rad=STEP_RAD, grid_mm=GRID_MM))
