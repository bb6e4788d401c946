"""Two packages for JavaScript: `dxf` makes polylines in steps of 5 degrees, `dxf-parser` hands entities over.

Of `dxf-parser` the centres, angles and bulges are taken as they come and divided here.
"""

import json
import shutil
import subprocess
from collections.abc import Callable, Sequence
from math import ceil, pi, radians
from pathlib import Path
from typing import Any

import numpy as np

from stages.geometry.arrays import Points2
from tests.readers.reading import Fineness, Piece, Reader, Reading

HERE = Path(__file__).parent
STEP_RAD = radians(1.0)
UNIT_MM = {1: 25.4, 4: 1.0, 5: 10.0, 6: 1000.0}
"""Of $INSUNITS: both packages hand it over and leave it to the caller."""

SCRIPTS = {
    "dxf": """
const {parseString, toPolylines} = require('dxf');
function answer(text) {
  const file = parseString(text);
  return {
    units: file.header.insUnits,
    lines: toPolylines(file).polylines.map(p => ({layer: p.layer.name, points: p.vertices})),
    texts: file.entities.filter(e => e.type === 'TEXT').map(e => e.string),
  };
}
""",
    "dxf-parser": """
const Parser = require('dxf-parser');
function answer(text) {
  const file = new Parser().parseSync(text);
  return {units: file.header['$INSUNITS'], entities: file.entities};
}
""",
}
LOOP = """
const fs = require('fs');
const made = {};
for (const path of process.argv.slice(2)) made[path] = answer(fs.readFileSync(path, 'latin1'));
fs.writeFileSync(1, JSON.stringify(made));
"""
Answer = dict[str, Any]


def available(package: str) -> Callable[[], bool]:
    return lambda: shutil.which("node") is not None and (HERE / "node_modules" / package).is_dir()


def asked(package: str, reading: Callable[[Answer], Reading]) -> Callable[[Sequence[Path]], dict[str, Reading]]:
    """Return the reading of all files by one run of node."""

    def read(paths: Sequence[Path]) -> dict[str, Reading]:
        script = paths[0].parent / f"{package}.cjs"
        script.write_text(SCRIPTS[package] + LOOP)
        command = ["node", str(script), *map(str, paths)]
        environment = {"NODE_PATH": str(HERE / "node_modules"), "PATH": str(Path(shutil.which("node") or "").parent)}
        done = subprocess.run(command, capture_output=True, check=True, timeout=60, env=environment)
        answers = json.loads(done.stdout)
        return {path.stem: _in_mm(reading(answers[str(path)]), answers[str(path)]["units"]) for path in paths}

    return read


def _in_mm(reading: Reading, unit: int) -> Reading:
    pieces = (Piece(one.layer, one.points * UNIT_MM[unit], one.closed) for one in reading.pieces)
    return Reading(tuple(pieces), reading.texts)


def polylines(answer: Answer) -> Reading:
    """Return what `dxf` made; of a text it makes a polyline without points."""
    lines = [(line["layer"], np.array(line["points"], dtype=np.float64)) for line in answer["lines"] if line["points"]]
    return Reading(tuple(Piece(layer, points) for layer, points in lines), tuple(answer["texts"]))


def entities(answer: Answer) -> Reading:
    """Return what `dxf-parser` hands over, arcs divided."""
    texts = tuple(one["text"] for one in answer["entities"] if one["type"] == "TEXT")
    curves = [one for one in answer["entities"] if one["type"] != "TEXT"]
    return Reading(tuple(Piece(one["layer"], _points(one), bool(one.get("shape"))) for one in curves), texts)


def _points(entity: Answer) -> Points2:
    """Return the points of a LINE, a CIRCLE, an ARC or a polyline; KeyError for anything else."""
    if entity["type"] in ("CIRCLE", "ARC"):
        first, last = entity.get("startAngle", 0.0), entity.get("endAngle", 2.0 * pi)
        turn = (last - first) % (2.0 * pi) or 2.0 * pi
        steps = first + np.linspace(0.0, turn, ceil(turn / STEP_RAD) + 1)
        circle: Points2 = np.column_stack([np.cos(steps), np.sin(steps)]) * entity["radius"]
        middle = np.array([entity["center"]["x"], entity["center"]["y"]])
        points: Points2 = circle + middle
        return points
    corners = [complex(one["x"], one["y"]) for one in entity["vertices"]]
    bulges = [one.get("bulge", 0.0) for one in entity["vertices"]]
    ends = corners[1:] + (corners[:1] if entity.get("shape") else [])
    made = [_bulged(*piece) for piece in zip(corners, ends, bulges, strict=False)]
    points = np.concatenate([[corners[0]], *made])
    return np.column_stack([points.real, points.imag])


def _bulged(start: complex, end: complex, bulge: float) -> np.ndarray:
    """Return points after the first of a piece with a bulge, by the tangent of a quarter of its turn."""
    turn = 4.0 * np.arctan(bulge)
    count = max(ceil(abs(turn) / STEP_RAD), 1)
    if not bulge:
        return np.array([end])
    arm = (start - end) / (1.0 - np.exp(1j * turn))
    made: np.ndarray = start - arm + arm * np.exp(1j * np.linspace(0.0, turn, count + 1)[1:])
    made[-1] = end
    return made


DXF = Reader("dxf (npm)", available("dxf"), asked("dxf", polylines), Fineness(step_rad=radians(5.0)))
PARSER = Reader("dxf-parser (npm)", available("dxf-parser"), asked("dxf-parser", entities), Fineness(step_rad=STEP_RAD))
