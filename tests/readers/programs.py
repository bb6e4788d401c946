"""Readers that are asked through a program of ours: three in Python, two in C++ that `install.sh` builds."""

import sys
import tempfile
from collections.abc import Callable
from math import radians
from pathlib import Path

from tests.readers.entities import STEP_RAD, program
from tests.readers.reading import Fineness, Reader

HERE = Path(__file__).parent
PROGRAMS, BUILT, MODULES = HERE / "programs", HERE / "build", HERE / "python_modules"
DEBIAN = "/usr/bin/python3"
"""Debian's own Python, which sees Debian's packages."""

SINGLE_MM = 5e-4
"""dime keeps centres as numbers of 24 bits: an arc of 5000 mm ends 3e-4 mm off."""


def there(*signs: str | Path) -> Callable[[], bool]:
    return lambda: all(Path(sign).exists() for sign in signs)


def by_python(name: str, sign: str | Path, python: str) -> Reader:
    """Return a reader that is a package for Python."""
    environment = {"PYTHONPATH": str(MODULES), "PATH": "/usr/bin:/bin", "HOME": tempfile.gettempdir()}
    read = program([python, str(PROGRAMS / f"from_{name.lower()}.py")], environment)
    return Reader(name, there(sign, python), read, Fineness(step_rad=STEP_RAD))


def built(name: str, fineness: Fineness) -> Reader:
    """Return a reader that is a library for C++."""
    made = BUILT / name
    return Reader(name, there(made), program([str(made)]), fineness)


DXFGRABBER = by_python("dxfgrabber", MODULES / "dxfgrabber", sys.executable)
BCNC = by_python("bCNC", "/usr/share/bcnc/bCNC/lib/dxf.py", DEBIAN)
DXF2GCODE = by_python("dxf2gcode", "/usr/lib/python3/dist-packages/dxf2gcode/dxfimport/importer.py", DEBIAN)
DXFLIB = built("dxflib", Fineness(step_rad=STEP_RAD))
DIME = built("dime", Fineness(step_rad=radians(22.5), grid_mm=SINGLE_MM))
