"""FreeCAD's importer: exact lines and arcs, each a loose edge; layers and texts are not kept without a window."""

import json
import shutil
import subprocess
from collections.abc import Sequence
from math import radians
from pathlib import Path

import numpy as np

from tests.readers.reading import Fineness, Piece, Reader, Reading

STEP_RAD = radians(1.0)
SCRIPT = """
import json, math
import FreeCAD, Import
made = {}
for number, path in enumerate(PATHS):
    document = FreeCAD.newDocument("d%d" % number)
    Import.readDXF(path, document.Name)
    edges = [edge for thing in document.Objects if hasattr(thing, "Shape") for edge in thing.Shape.Edges]
    made[path] = []
    for edge in edges:
        first, last = edge.ParameterRange
        bent = edge.Curve.TypeId == "Part::GeomCircle"
        count = int(math.ceil((last - first) / STEP)) if bent else 1
        values = [edge.valueAt(first + (last - first) * k / count) for k in range(count + 1)]
        made[path].append([(value.x, value.y) for value in values])
with open(ANSWER, "w") as file:
    json.dump(made, file)
"""


def available() -> bool:
    return shutil.which("freecadcmd") is not None


def read(paths: Sequence[Path]) -> dict[str, Reading]:
    """Return what one run of FreeCAD finds in all files."""
    folder = paths[0].parent
    script, answer = folder / "read.py", folder / "answer.json"
    names = [str(path) for path in paths]
    script.write_text(f"PATHS = {names!r}\nANSWER = {str(answer)!r}\nSTEP = {STEP_RAD!r}\n{SCRIPT}")
    subprocess.run(["freecadcmd", str(script)], capture_output=True, check=True, timeout=120)
    found = json.loads(answer.read_text())
    return {path.stem: Reading(tuple(Piece("", np.array(edge)) for edge in found[str(path)])) for path in paths}


READER = Reader("FreeCAD", available, read, Fineness(step_rad=STEP_RAD), layered=False)
