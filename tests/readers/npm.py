"""Four packages for JavaScript: `dxf` and jscad's make polylines in their own steps, the others hand entities over.

jscad's keeps no layers: what it makes of a file is a list of shapes.
"""

import shutil
from collections.abc import Callable
from math import radians
from pathlib import Path

from tests.readers.entities import STEP_RAD, program
from tests.readers.reading import Fineness, Reader

JSCAD_STEP_RAD = radians(45.0)
"""It takes 16 steps a turn, of an arc as many whole ones as fit: one step may be nearly two."""

HERE = Path(__file__).parent
PROGRAMS = HERE / "programs"


def available(package: str) -> Callable[[], bool]:
    return lambda: shutil.which("node") is not None and (HERE / "node_modules" / package).is_dir()


def reader(name: str, package: str, step_rad: float, *, layered: bool = True, block_layers: bool = True) -> Reader:
    """Return the reader that a package is, asked by the program of its name."""
    node = shutil.which("node") or "node"
    environment = {"NODE_PATH": str(HERE / "node_modules"), "PATH": str(Path(node).parent)}
    read = program([node, str(PROGRAMS / f"{name}.cjs")], environment)
    fineness = Fineness(step_rad=step_rad)
    return Reader(f"{name} (npm)", available(package), read, fineness, layered, block_layers=block_layers)


DXF = reader("dxf", "dxf", radians(5.0), block_layers=False)
PARSER = reader("dxf-parser", "dxf-parser", STEP_RAD)
JSON = reader("dxf-json", "dxf-json", STEP_RAD)
JSCAD = reader("jscad", "@jscad/dxf-deserializer", JSCAD_STEP_RAD, layered=False)
