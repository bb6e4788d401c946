"""Run drawn job files, no two alike, by the thousand: `python -m tests.fuzz --jobs 100000 --seed 1 --finds FOLDER`.

The finds lie in the folder, three for each place in the program at most, each with what was raised beside it.  They are
made small by hand and kept in `tests/corpus`.
"""

import argparse
import os
import sys
import tempfile
from collections import Counter
from contextlib import closing
from hashlib import sha256
from itertools import islice
from pathlib import Path
from time import monotonic

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "MKL_NUM_THREADS")
KEPT = 3
TOLD_EVERY = 1000
IN_MEMORY = Path("/dev/shm")
"""Where files are written and synced to no disk."""


def main() -> int:
    """Run the jobs asked for; exit code 1 if there are finds."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("--jobs", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--finds", type=Path, default=Path("finds"))
    chosen = parser.parse_args()
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    from tests.fuzz.lots import Find, run_lots

    places: Counter[str] = Counter()
    count, start = 0, monotonic()

    def keep(find: Find) -> None:
        place = f"{find.fault.sort}: {find.fault.where}"
        places[place] += 1
        if places[place] <= KEPT:
            name = f"{find.fault.sort}-{sha256(find.drawn.content).hexdigest()[:10]}"
            chosen.finds.mkdir(parents=True, exist_ok=True)
            (chosen.finds / name).with_suffix(Path(find.drawn.name).suffix).write_bytes(find.drawn.content)
            (chosen.finds / name).with_suffix(".txt").write_text(f"{place}\n{find.fault.text}\n", "utf-8", "replace")
            print(f"{count} {place} {name}", flush=True)

    with (
        tempfile.TemporaryDirectory(prefix="fuzz-", dir=IN_MEMORY if IN_MEMORY.is_dir() else None) as folder,
        closing(run_lots(chosen.seed * 10**6, Path(folder))) as finds,
    ):
        for find in islice(finds, chosen.jobs):
            count += 1
            if find is not None:
                keep(find)
            if count % TOLD_EVERY == 0:
                print(f"{count} jobs, {sum(places.values())} finds, {monotonic() - start:.0f} s", flush=True)
    print(f"{count} jobs in {monotonic() - start:.0f} s, finds: {dict(places) or 'none'}")
    return 1 if places else 0


if __name__ == "__main__":
    sys.exit(main())
