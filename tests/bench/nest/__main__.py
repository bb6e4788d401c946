"""The nesting benchmark: planish beside other engines, same machine, same time, each layout certified.

One engine after another, each in a child process that is kept to the same cores.  Without a folder: the stored
instances, the jigsaws of `made.py`, the ring test, and the time and memory of the first certified layout of 100 and
1000 different parts.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec

from tests.bench.nest.engines import ENGINES, Engine, core_limit, install, run, version
from tests.bench.nest.instances import FOLDER, Instance, instance, load, on_sheets
from tests.bench.nest.made import made, many
from tests.bench.nest.table import Asked, Report, Row, against, machine, median, row, text, today

COUNTS = (100, 1000)
"""Parts of which the first certified layout is timed."""
FIRST_LIMIT_S = 300.0


def main(words: Sequence[str]) -> None:
    """Run what was asked for and print the table."""
    asked = parsed(words)
    if asked.rivals:
        install()
    names = asked.engines.split(",")
    there = {one: found for one in ENGINES if one.name in names and (found := version(one))}
    for name in names:
        if name not in {one.name for one in there}:
            print(f"{name}: not installed (--rivals installs what can be)", file=sys.stderr)
    with core_limit(asked.cores) as cores:
        report = Report(today(), machine(), cores, [])
        print(heading(report, asked, there), flush=True)
        try:
            for one in rows(asked, there):
                report.rows.append(one)
                print(f"{one.instance}: {one.engine}: {one.valid}", file=sys.stderr, flush=True)
        except KeyboardInterrupt:
            print("interrupted: the rows so far", file=sys.stderr)
    print(text(report.rows), *against(report.rows, ENGINES[0].name), sep="\n")
    if asked.json:
        asked.json.write_bytes(msgspec.json.format(msgspec.json.encode(report)) + b"\n")


def heading(report: Report, asked: argparse.Namespace, engines: dict[Engine, str]) -> str:
    """Return where, when and how the rows were measured."""
    how = f"{asked.seconds:g} s for each engine, median of {asked.runs} from seed {asked.seed}"
    versions = ", ".join(f"{one.name} {found}" for one, found in engines.items())
    return f"{report.date}, {report.machine}, {report.cores} cores, {how}\n{versions}"


def parsed(words: Sequence[str]) -> argparse.Namespace:
    """Return what the words ask for."""
    asks = argparse.ArgumentParser("dev.py bench nest", description=__doc__.partition("\n")[0])
    asks.add_argument("folder", nargs="?", type=Path, help="folder of instances, in place of those of the project")
    asks.add_argument("--seconds", type=float, default=60.0, help="for each engine on each instance (60)")
    asks.add_argument("--only", default="", help="instances with this in their name")
    asks.add_argument("--engines", default=",".join(one.name for one in ENGINES), help="by name, with commas")
    asks.add_argument("--seed", type=int, default=1, help="of the first run (1)")
    asks.add_argument("--runs", type=int, default=1, help="runs with seeds one after another; the median is shown (1)")
    asks.add_argument("--cores", type=int, default=2, help="each engine may use (2)")
    asks.add_argument("--sheets", help="WIDTHxHEIGHT: nest the parts of strips on sheets of that size instead")
    asks.add_argument("--rivals", action="store_true", help="install the other engines into .bench first")
    asks.add_argument("--json", type=Path, help="write the rows there as well")
    return asks.parse_args(words)


def rows(asked: argparse.Namespace, engines: dict[Engine, str]) -> Iterator[Row]:
    """Return the row of every engine on every instance."""
    for one in chosen(asked):
        for engine, found in engines.items():
            yield median([once(one, engine, found, seed, asked.seconds) for seed in seeds(asked)])
    if asked.folder is None and any(engine.ours for engine in engines):
        yield from first(asked, engines)


def first(asked: argparse.Namespace, engines: dict[Engine, str]) -> Iterator[Row]:
    """Return how long planish takes to its first certified layout: no time for the search."""
    ours, found = next((engine, found) for engine, found in engines.items() if engine.ours)
    for count in COUNTS:
        if asked.only in f"first_{count}":
            one = instance(f"first_{count}", many(count))
            yield row(one, ours.name, Asked(found, asked.seed, 0.0), run(ours, one, 0.0, asked.seed, FIRST_LIMIT_S))


def chosen(asked: argparse.Namespace) -> list[Instance]:
    """Return the instances asked for."""
    every = [*load(FOLDER), *made()] if asked.folder is None else load(asked.folder)
    some = [one for one in every if asked.only in one.name]
    if asked.sheets:
        width, height = map(float, asked.sheets.split("x"))
        some = [on_sheets(one, width, height) for one in some if one.is_strip]
    return some


def seeds(asked: argparse.Namespace) -> range:
    return range(asked.seed, asked.seed + asked.runs)


def once(one: Instance, engine: Engine, found: str, seed: int, seconds: float) -> Row:
    """Return the row of one run."""
    return row(one, engine.name, Asked(found, seed, seconds), run(engine, one, seconds, seed))


if __name__ == "__main__":
    main(sys.argv[1:])
