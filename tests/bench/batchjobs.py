"""Jobs to measure a batch with: the samples as they are, as far as no clock is in them, and jobs that do nothing."""

from pathlib import Path

from pipeline.batch import draft
from pipeline.batch.entries import Entries, entries
from pipeline.batch.families import rows, table_of
from pipeline.batch.work import Record, Work

SAMPLES = (
    "ducts/job", "strakes/job", "hides/job", "auger/job", "hopper/job", "cladding/job", "paper/job", "guard/job",
    "bracket/job", "upper/job", "bag/job", "flanges/job", "strakes/as-drawn", "paper/as-printed",
)  # fmt: skip
"""From the longest, some seconds, to the shortest: one worker has little left to do when the other ends, which of a
batch of thousands is so in any order.  `bag/sewn` alone takes a quarter of the time of all, and is left out."""
SEARCHED = ("strakes/job", "hides/job", "hopper/job")
"""Samples whose parts take more than one sheet, or a hide."""
REPEATS = 6


def one_file(work: Work) -> Record:
    """Leave a folder with one small file, written as those of any job are."""
    mark = draft.write(Path(work.draft), {"report.json": work.text or b""})
    return Record("made", "", 0.0, (), mark, own=True)


def places(folder: Path, count: int) -> Path:
    """Write a file of JSON Lines with that many lines of the smallest sort."""
    file = folder / "jobs.jsonl"
    with file.open("w") as stream:
        stream.writelines(f'{{"n":{number}}}\n' for number in range(count))
    return file


def mixed(folder: Path, times: int) -> Entries:
    """Yield every sample so many times, those whose nest is searched without their stock.

    A search takes the time that it is given, on however many workers.
    """
    table = folder / "nothing.csv"
    table.write_text("stock\n[]\n")
    for name in (name for name in SAMPLES for _ in range(times)):
        file = Path("samples", f"{name}.toml")
        yield from rows(table_of(table, file)) if name in SEARCHED else entries([file])
