"""What a batch needs of the machine, looked at one by one: `planish doctor`.

Each check does what a batch would do (writes through a journal, moves a folder, starts a child, asks a cluster) in a
folder that it makes beside the outputs and removes again.  What is not as it should be comes with its remedy.
"""

import os
import re
import shutil
import sqlite3
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from pipeline import __version__
from pipeline.batch import draft
from pipeline.batch.work import Limits, Record, Work
from stages.errors import BadInputError

LEAST_SPACE = 2 << 30
"""Bytes: some ten thousand jobs with all formats; below it a batch may well end with the disk full."""
LEAST_FILES = 200_000
"""Files that a file system can still hold: a job makes ten or so."""
SLOW_SYNC_S = 0.05
"""A disk that takes this long to make sure of a few bytes is remote or very busy."""
SYNCS = 5
CHILD_S = 60.0
REMOTE = frozenset({"nfs", "nfs4", "cifs", "smb3", "smbfs", "9p", "fuse.sshfs", "afs", "ceph", "lustre", "beegfs"})
"""File systems on which SQLite's write-ahead log, which needs shared memory, is not to be trusted."""


@dataclass(frozen=True, slots=True)
class Found:
    """One thing looked at: what it is, whether it is as it should be, and if not what to do."""

    what: str
    good: bool
    said: str
    remedy: str = ""

    def line(self) -> str:
        """Return it for people."""
        return f"{'ok' if self.good else 'NOT OK':6}  {self.what}: {self.said}" + (f"; {self.remedy}" * (not self.good))


def examine(out: Path, cluster: str | None) -> Iterator[Found]:
    """Yield what is found, in the order in which a batch would meet it."""
    yield versions()
    place = next(folder for folder in (out.absolute(), *out.absolute().parents) if folder.is_dir())
    try:
        with tempfile.TemporaryDirectory(prefix=".planish-doctor-", dir=place) as folder:
            for check in (journal, moving, syncing):
                yield check(Path(folder))
    except OSError as error:
        yield Found("folder", good=False, said=f"{place} takes no files: {error.strerror}", remedy="choose another")
    yield space(place)
    yield files_left(place)
    yield threads()
    yield child()
    if cluster is not None:
        yield from workers(cluster, out)


def versions() -> Found:
    """Return what runs."""
    from pipeline.provenance import environment

    rest = ", ".join(f"{name} {version}" for name, version in environment().items())
    return Found("versions", good=True, said=f"planish {__version__}, {rest}, SQLite {sqlite3.sqlite_version}")


def journal(folder: Path) -> Found:
    """Return whether a journal can be kept: written by one connection while another reads."""
    sort = file_system(folder)
    remedy = "put the output folder on a disk of this machine; only the workers' drafts may be far away"
    try:
        file = folder / "try.sqlite"
        with closing(sqlite3.connect(file)) as base, closing(sqlite3.connect(file)) as other:
            mode = base.execute("PRAGMA journal_mode=WAL").fetchone()[0]
            base.execute("CREATE TABLE one (row INTEGER)")
            base.execute("INSERT INTO one VALUES (1)")
            base.commit()
            seen = other.execute("SELECT count(*) FROM one").fetchone()[0]
    except sqlite3.Error as error:
        return Found("journal", good=False, said=str(error), remedy=remedy)
    good = mode == "wal" and seen == 1 and sort not in REMOTE
    return Found("journal", good, f"write-ahead log {'works' if mode == 'wal' else 'refused'} on {sort}", remedy)


def file_system(folder: Path) -> str:
    """Return the name of the file system that a folder lies on, as the kernel lists it; unknown elsewhere."""
    try:
        mounts = [line.split() for line in Path("/proc/mounts").read_text("utf-8", "replace").splitlines()]
    except OSError:
        return "an unknown file system"
    here = f"{folder.resolve()}/"
    points = [(ESCAPED.sub(lambda found: chr(int(found[1], 8)), where), sort) for _, where, sort, *_ in mounts]
    over = [(len(where), number, sort) for number, (where, sort) in enumerate(points) if _lies(here, where)]
    return max(over, default=(0, 0, "an unknown file system"))[-1]


ESCAPED = re.compile(r"\\([0-7]{3})")
"""How the list of mounts writes a blank and what else would break its lines, proc_pid_mounts(5)."""


def _lies(folder: str, place: str) -> bool:
    """Return whether a folder, with a slash at its end, lies below a place where something is mounted."""
    return folder.startswith(f"{place.rstrip('/')}/")


def moving(folder: Path) -> Found:
    """Return whether a finished draft can take its place."""
    name = "folders are moved whole"
    draft.write(folder / "draft", {"flat/part.dxf": b"0\nEOF\n"})
    try:
        (folder / "draft").rename(folder / "job")
    except OSError as error:
        return Found("drafts", good=False, said=f"{name}: {error.strerror}", remedy="choose another file system")
    return Found("drafts", good=True, said=name)


def syncing(folder: Path) -> Found:
    """Return how long the disk takes to make sure of a file."""
    start = perf_counter()
    for number in range(SYNCS):
        handle = os.open(folder / f"sync-{number}", os.O_WRONLY | os.O_CREAT)
        try:
            os.write(handle, b"x")
            os.fsync(handle)
        finally:
            os.close(handle)
    each = (perf_counter() - start) / SYNCS
    remedy = "a batch does it once for many jobs, so this costs time only where jobs are few or long"
    return Found("disk", each < SLOW_SYNC_S, f"{1e3 * each:.1f} ms to make sure of a file", remedy)


def space(folder: Path) -> Found:
    """Return how much room there is."""
    free = shutil.disk_usage(folder).free
    return Found("space", free >= LEAST_SPACE, f"{free / 2**30:.1f} GB free", "a job takes 50 kB to 5 MB: make room")


def files_left(folder: Path) -> Found:
    """Return how many files the file system can still hold; some count none."""
    seen = os.statvfs(folder)
    good = seen.f_files == 0 or seen.f_favail >= LEAST_FILES
    said = "not limited" if seen.f_files == 0 else f"{seen.f_favail} more"
    return Found("files", good, said, "ask for fewer formats (report.formats), or use another file system")


def threads() -> Found:
    """Return how many jobs can be run at a time here."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return Found("cores", good=True, said=f"{usable}: --workers {usable}; each child computes with one thread")


def child() -> Found:
    """Return whether a child starts, how long it takes, and what it needs."""
    from pipeline.batch.executor import Local

    start = perf_counter()
    local = Local(1, resident)
    try:
        nothing = Work("doctor", "/", None, b"", (), (), "/nowhere/doctor", Limits(CHILD_S, 1 << 30))
        record = local.submit(nothing).result(2 * CHILD_S)
    finally:
        local.close(now=True)
    said = f"ready after {perf_counter() - start:.1f} s, {record.cause}"
    remedy = f"see what `{sys.executable} -m {WARM}` says, and have TMPDIR name a folder with a short path"
    return Found("child", record.status == "made", said, remedy)


def resident(_work: Work) -> Record:
    """Say how much memory this child takes; runs in it."""
    pages = int(Path("/proc/self/statm").read_text().split()[1]) if Path("/proc/self/statm").exists() else 0
    size = f"{pages * os.sysconf('SC_PAGE_SIZE') / MEGABYTE:.0f} MB, most of it shared with the others"
    return Record("made", size if pages else "", 0.0, (), "", own=True)


WARM = "pipeline.batch.warm"
MEGABYTE = 1 << 20


def workers(address: str, out: Path) -> Iterator[Found]:
    """Yield whether the workers of a cluster can run jobs, and what keeps them from it."""
    from pipeline.batch.cluster import Cluster

    try:
        joined = Cluster(address, out, workers_s=CHILD_S / 2)
    except BadInputError as error:
        yield from (Found("cluster", good=False, said=each.message, remedy=each.hint) for each in error.problems)
        return
    count = sum(joined.client.nthreads().values())
    joined.close(now=True)
    yield Found("cluster", good=True, said=f"{address}: {count} threads, all with the same planish, all see {out}")
