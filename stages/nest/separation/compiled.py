"""How the kernels of the search become machine code.

A kernel is a plain function on numbers, arrays and tuples of arrays, compiled by numba for the processor at hand the
first time it is called, and kept on disk for the next time.  Kernels let other threads run meanwhile.  Each carries
`no_type_check` below the decorator: checkers of shapes wrap functions in what numba cannot compile.

numba looks at the file of a kernel, not at those of the kernels that it calls, to tell whether its code is stale.  So
the code is kept in a folder named after the digest of all kernels; where it cannot be kept it is compiled each time.
"""

import os
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from shutil import rmtree
from typing import Any, TypeVar, cast

import numba

Kernel = TypeVar("Kernel", bound=Callable[..., Any])

HERE = Path(__file__).parent

KERNELS = b"@no_type_check\ndef "
"""What a file with kernels holds."""

TUPLES = "state.py"
"""The file with the tuples of arrays and the numbers that kernels know."""

PREFIX = "kernels-"


def _folder() -> Path:
    """Return where the machine code of just these sources is kept."""
    texts = ((file.name, file.read_bytes()) for file in sorted(HERE.glob("*.py")))
    sources = b"".join(text for name, text in texts if KERNELS in text or name == TUPLES)
    return HERE / "__pycache__" / f"{PREFIX}{sha256(sources).hexdigest()[:16]}"


def _kept() -> bool:
    """Return whether machine code can be kept; tells numba where, and removes that of earlier sources."""
    folder = _folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    for old in set(folder.parent.glob(f"{PREFIX}*")) - {folder}:
        rmtree(old, ignore_errors=True)
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]  # made when numba is loaded
    return os.access(folder, os.W_OK)


KEPT = _kept()


SUMS = {"reassoc", "contract", "nsz"}
"""What the compiler may do with sums: their order, fused products, signs of zero."""


def compiled(function: Kernel) -> Kernel:
    """Return the function as machine code; divisions by 0 give inf or NaN, as numpy's do.

    It makes no arrays and counts no references: to count those of tuples of arrays takes longer than most kernels do.
    """
    return _made(function, _nrt=False)


def inlined(function: Kernel) -> Kernel:
    """Return the function as machine code that is put into its callers: to hand over many arrays takes its time."""
    return _made(function, _nrt=False, forceinline=True)


def vectorised(function: Kernel) -> Kernel:
    """Return the function as machine code that may sum in any order, so that its loops take several numbers at once."""
    return _made(function, _nrt=False, fastmath=SUMS)


def allocating(function: Kernel) -> Kernel:
    """Return the function as machine code, for kernels that make arrays and are not called often."""
    return _made(function, _nrt=True)


def _made(function: Kernel, **options: object) -> Kernel:
    """Return the function as machine code; what it calls takes over the options that it does not set itself."""
    always: dict[str, Any] = {"cache": KEPT, "nogil": True, "error_model": "numpy", **options}
    return cast(Kernel, numba.njit(**always)(function))
