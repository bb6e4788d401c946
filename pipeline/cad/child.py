"""The child process that reads one CAD file: `python -c ... FILE SORT`, the faces on stdout as `wire` writes them.

Whatever the libraries print goes nowhere; what they raise is told as a text.  If they crash, only this process ends.
"""

import os
import sys
from collections.abc import Callable

from pipeline.cad.wire import Unreadable, written
from pipeline.orphans import die_with_the_one_told
from stages.model.cadface import CadBody


def main() -> None:
    """Read the file and write what it holds."""
    die_with_the_one_told()
    file, sort = sys.argv[1:]
    answer, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    with os.fdopen(answer, "wb") as pipe:
        pipe.write(written(read(file, sort)))
        pipe.flush()
        # the libraries' own clean-up takes time and may crash
        os._exit(0)


def read(file: str, sort: str) -> CadBody | Unreadable:
    """Return the faces of a file, or why there are none."""
    if sort == "3dm":
        from pipeline.cad import rhino

        return _tried(lambda: rhino.faces(file))
    from pipeline.cad import step

    return _tried(lambda: step.faces(file, sort))


def _tried(reading: Callable[[], CadBody]) -> CadBody | Unreadable:
    try:
        return reading()
    except Exception as error:
        return Unreadable(str(error) or type(error).__name__)
