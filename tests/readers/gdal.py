"""GDAL's `ogr2ogr`: layers are a column, arcs become points a given step apart; it takes no notice of units."""

import csv
import re
import shutil
import subprocess
from collections.abc import Sequence
from math import radians
from pathlib import Path

import numpy as np

from tests.readers.reading import Fineness, Piece, Reader, Reading

STEP_DEG = 1.0
BLOCKS = ("--config", "DXF_MERGE_BLOCK_GEOMETRIES", "FALSE")
"""Unasked, it merges all of a block into one geometry on the layer that the block is inserted on."""


def available() -> bool:
    return shutil.which("ogr2ogr") is not None


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    return {path.stem: stated(path) for path in paths}


def stated(path: Path, step_deg: float = STEP_DEG) -> Reading:
    """Return what `ogr2ogr` says in well-known text, a line for each entity."""
    options = ["--config", "OGR_ARC_STEPSIZE", str(step_deg), "-lco", "GEOMETRY=AS_WKT", *BLOCKS]
    command = ["ogr2ogr", *options, "-f", "CSV", "/vsistdout/", str(path)]
    answer = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout
    csv.field_size_limit(10**8)
    rows = list(csv.DictReader(answer.splitlines()))
    texts = tuple(row["Text"] for row in rows if row["WKT"].startswith("POINT") and row["Text"])
    lines = [(row["Layer"], ring) for row in rows for ring in _rings(row["WKT"])]
    return Reading(tuple(Piece(layer, points, _meet(points)) for layer, points in lines), texts)


def _rings(wkt: str) -> list[np.ndarray]:
    """Return the point rows of lines, rings and collections of them; none of a point."""
    if wkt.startswith("POINT"):
        return []
    return [
        np.array([[float(word) for word in point.split()[:2]] for point in ring.split(",")])
        for ring in re.findall(r"\(([^()]+)\)", wkt)
    ]


def _meet(points: np.ndarray) -> bool:
    return bool((points[0] == points[-1]).all())


READER = Reader("GDAL", available, read, Fineness(step_rad=radians(STEP_DEG)))
