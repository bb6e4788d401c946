"""`planish` and `python -m pipeline`.

`planish --version` is answered before click is loaded, which takes three quarters of the time to start.

Linear algebra runs on one thread unless the environment says otherwise: the matrices are small, more threads wait for
each other, and the last bits would depend on their number.

The collector is not asked at the end: it would look through all that was loaded, which takes a tenth of a small job.
"""

import gc
import os
import sys

from pipeline import __version__

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def main() -> None:
    """Run the command line and exit."""
    for name in THREADS:
        os.environ.setdefault(name, "1")
    if sys.argv[1:] == ["--version"]:
        sys.stdout.write(f"planish {__version__}\n")
        return
    from pipeline.cli import main as command_line

    try:
        command_line()
    finally:
        gc.freeze()


if __name__ == "__main__":
    main()
