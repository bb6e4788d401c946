"""The topics, each run in a process of its own, so that none finds the memory or the pages of the one before."""

import sys
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from multiprocessing import get_context

from tests.bench.rows import Asked, Row, Section

TOPICS = {
    "start-up": "starting", "unroll": "unrolling", "verify": "verifying", "dxf": "drawing", "nest": "nesting",
    "batch": "batches", "growth": "growth",
}  # fmt: skip
"""The topics and their modules, in the order in which they run."""


def alone(name: str, asked: Asked) -> Section:
    """Return the section of a topic, run in a process of its own."""
    try:
        with ProcessPoolExecutor(1, get_context("spawn")) as process:
            return process.submit(section, name, asked).result()
    except BrokenProcessPool as error:
        return Section(name, "", (), f"its process ended: {error}")


def section(name: str, asked: Asked) -> Section:
    """Return the section of a topic, with the rows that there are where one of them failed."""
    about, rows = "", list[Row]()
    try:
        topic = import_module(f"tests.bench.topics.{TOPICS[name]}")
        about = topic.ABOUT
        for row in topic.rows(asked):
            rows.append(row)
            print(f"  {row.what}, {row.size}, {row.program}", file=sys.stderr, flush=True)
    except Exception as error:
        return Section(name, about, tuple(rows), f"{type(error).__name__}: {error}")
    return Section(name, about, tuple(rows))
