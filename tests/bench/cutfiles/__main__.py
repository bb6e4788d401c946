"""The command: all measures, or those that are named; it ends with 1 where one is missed."""

import sys
from collections.abc import Callable, Iterable, Iterator

from tests.bench.cutfiles import contents, figures, program
from tests.bench.cutfiles.rows import Row, head, shown

MEASURES: dict[tuple[str, ...], Callable[[], Row | Iterable[Row]]] = {
    ("W1",): program.readers,
    ("W2",): program.unit_errors,
    ("W3",): contents.distance,
    ("W4",): program.arcs,
    ("W5",): contents.smoothness,
    ("W6",): contents.wholeness,
    ("W7", "W8"): contents.judged,
    ("W9", "W10"): contents.as_ezdxf_reads,
    ("W11",): figures.round_trip,
    ("W12",): figures.bends,
    ("W13",): program.same_bytes,
    ("W14",): figures.copies,
    ("W15",): figures.pattern_files,
    ("W16",): program.planted,
}


def rows(wanted: set[str]) -> Iterator[Row]:
    """Yield the rows of the measures that are wanted, of all if none is named, each as soon as it is there."""
    for names, measure in MEASURES.items():
        if not wanted or wanted & {*names}:
            made = measure()
            yield from [made] if isinstance(made, Row) else made


if __name__ == "__main__":
    print(head())
    missed = False
    for row in rows({*sys.argv[1:]}):
        print(shown(row), flush=True)
        missed |= not row.right
    sys.exit(missed)
