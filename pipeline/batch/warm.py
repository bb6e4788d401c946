"""What every job needs, loaded once: the process that all children are forked from imports this module first.

One small job is run, so that what is imported or worked out on the way is there; what other kinds of surface need is
loaded besides (`eager`), but not the search of a nest, which compiles and has processes of its own.  The children share
it all as long as no one writes to it, and `gc.freeze` keeps the collector from touching it.

One thread for linear algebra, set before numpy is loaded: children share the cores, and the last bits of a sum would
depend on the number of threads.  A nest is searched by one thread as well.  The values are set, not proposed, so that
every machine of a cluster computes alike.
"""

import gc
import os
from contextlib import suppress
from pathlib import Path

from pipeline.orphans import die_with_parent

THREADS = (
    "OPENBLAS_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "NUMBA_NUM_THREADS",
)
SERVER = os.getpid()
"""The process that loads this module; a child that is forked from it finds its parent here."""
STDERR = 2
KIND = "cylinder"
BESIDES = ("stages.write", "stages.nest.legal")
"""Packages whose modules are loaded as well: what only other formats and nests need."""


def prepare() -> None:
    """Make this process the one that children are forked from, which dies with the one that started it."""
    die_with_parent(os.getppid())
    os.environ.update(dict.fromkeys(THREADS, "1"))
    with suppress(Exception):  # what is wrong is met by the first job again, and there it is told
        warm_up()
    gc.freeze()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, STDERR)  # a child whose pool is gone before it has begun would say so at length
    os.close(nowhere)


def warm_up() -> None:
    """Run a job of all formats without stock, and load what other kinds and formats need besides."""
    from pipeline.batch import guard  # noqa: F401  # every child needs it
    from pipeline.eager import load, load_parts
    from pipeline.job import job_of
    from pipeline.jobfile import Given, read
    from pipeline.kinds import template
    from pipeline.outputs import outputs
    from pipeline.run import run_job

    text = Given(text=template(KIND).encode())
    outputs(run_job(job_of(read(Path(f"{KIND}.toml"), ("stock=[]",), given=text))))
    load_parts()
    load(BESIDES)


if __name__ == "__main__":
    warm_up()
else:
    prepare()
