"""One row for each engine on each instance, and the rows as text."""

import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from math import isnan, nan
from statistics import mean
from typing import NamedTuple

import msgspec

from tests.bench.nest.engines import Run
from tests.bench.nest.instances import Instance
from tests.bench.nest.layouts import Measured, Said, measured, nesting_of

HEADS = ("instance", "parts", "engine", "result", "density %", "equivalent %", "valid?", "wall s", "CPU s", "remark")
NUMBERS = {"parts", "density %", "equivalent %", "wall s", "CPU s"}
COUNTED = ("valid", "rounding")
REMARK = 90
"""A remark is cut at so many letters; the JSON has it whole."""


class Asked(NamedTuple):
    """How an engine was run: its version, seed and seconds."""

    version: str
    seed: int
    seconds: float


class Row(msgspec.Struct):
    """What an engine reached; densities as fractions, null where there is none; sheets 0: no layout."""

    instance: str
    parts: int
    engine: str
    version: str
    seed: int
    seconds: float
    valid: str
    sheets: int
    length_mm: float | None
    density: float | None
    equivalent: float | None
    wall_s: float
    cpu_s: float
    nest_s: float | None
    memory_mb: float | None
    remark: str


class Report(msgspec.Struct):
    """A run of the benchmark."""

    date: str
    machine: str
    cores: int
    rows: list[Row]


def best(said: Sequence[Said], instance: Instance) -> tuple[Measured | None, str]:
    """Return the last layout that is valid, else the last one, and what there is to say of the others."""
    remarks = [one.error or f"not offered: {one.unable}" for one in said if one.error or one.unable]
    refused: list[Measured] = []
    for one in reversed([one for one in said if one.placed]):
        found = measured(nesting_of(one.placed, instance), instance)
        if found.verdict != "INVALID":
            return found, "; ".join([*remarks, *_refused(refused)])
        refused.append(found)
    if not remarks and not refused:
        remarks = ["no layout in time"]
    return (refused[0] if refused else None), "; ".join([*remarks, *_refused(refused)])


def _refused(layouts: Sequence[Measured]) -> list[str]:
    """Return how many layouts are not valid, and why the last is not."""
    return [f"{len(layouts)} invalid: {layouts[0].faults[0]}"] if layouts else []


def row(instance: Instance, engine: str, asked: Asked, run: Run) -> Row:
    """Return the row of a run."""
    found, remark = best(run.said, instance)
    shown = found or Measured("INVALID", (), 0, nan, nan)
    told = run.said[-1] if run.said else Said()
    return Row(
        instance.name,
        instance.parts,
        engine,
        asked.version,
        asked.seed,
        asked.seconds,
        shown.verdict if found else "-",
        shown.sheets,
        _known(shown.length_mm),
        _known(shown.density),
        _known(shown.equivalent),
        run.wall_s,
        run.cpu_s,
        told.seconds,
        told.memory_mb,
        remark,
    )


def figure(one: Row) -> float | None:
    """Return the density by which rows are compared: the equivalent one where there is one; None: nothing valid."""
    if one.valid not in COUNTED:
        return None
    return one.density if one.equivalent is None else one.equivalent


def worth(one: Row) -> tuple[bool, int, float]:
    """Return a key that sorts the better row first: valid, fewer sheets, denser."""
    return one.valid not in COUNTED, one.sheets, -(figure(one) or 0.0)


def against(rows: Sequence[Row], ours: str) -> list[str]:
    """Return how we stand to each other engine, over the instances for which both have a valid layout."""
    found = {(one.instance, one.engine): value for one in rows if (value := figure(one)) is not None}
    lines = []
    for rival in dict.fromkeys(one.engine for one in rows if one.engine != ours):
        both = [name for name, who in found if who == rival and (name, ours) in found]
        pairs = {name: (found[name, ours], found[name, rival]) for name in both}
        if pairs:
            lines.append(f"{ours} and {rival}: {_compared(pairs)}")
    return lines


def _compared(pairs: Mapping[str, tuple[float, float]]) -> str:
    """Return the two means in percent, and the instance on which we are least ahead."""
    mine, theirs = (100.0 * mean(pair[k] for pair in pairs.values()) for k in range(2))
    least = min(pairs, key=lambda name: pairs[name][0] - pairs[name][1])
    ahead = 100.0 * (pairs[least][0] - pairs[least][1])
    return f"{mine:.2f} and {theirs:.2f} % on {len(pairs)} instances, least ahead on {least}: {ahead:+.2f} points"


def median(rows: Sequence[Row]) -> Row:
    """Return the middle one of several runs, of an even number the worse of the two."""
    return sorted(rows, key=worth)[len(rows) // 2]


def machine() -> str:
    """Return the processor, system and Python."""
    system = f"{platform.system()} {platform.release()}"
    return f"{processor() or platform.machine()}, {system}, Python {platform.python_version()}"


def processor() -> str:
    """Return the name of the processor, where the system tells it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:  # noqa: PTH123
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor()


def today() -> str:
    """Return the date, UTC."""
    return datetime.now(UTC).date().isoformat()


def text(rows: Sequence[Row]) -> str:
    """Return the rows under their heads, in columns."""
    cells = [HEADS, *map(_cells, rows)]
    widths = [max(len(line[k]) for line in cells) for k in range(len(HEADS))]
    lines = [
        "  ".join(
            cell.rjust(width) if head in NUMBERS else cell.ljust(width)
            for head, cell, width in zip(HEADS, line, widths, strict=True)
        ).rstrip()
        for line in cells
    ]
    return "\n".join([lines[0], "-" * max(map(len, lines)), *lines[1:]])


def _cells(one: Row) -> tuple[str, ...]:
    memory = f"{one.memory_mb:.0f} MB" if one.memory_mb else ""
    nest = f"nest {one.nest_s:.2f} s" if one.nest_s is not None else ""
    remark = "; ".join(filter(None, (nest, memory, one.remark)))
    return (
        one.instance,
        str(one.parts),
        one.engine,
        _result(one),
        _percent(one.density),
        _percent(one.equivalent),
        one.valid,
        f"{one.wall_s:.1f}",
        f"{one.cpu_s:.1f}",
        remark if len(remark) <= REMARK else remark[: REMARK - 3] + "...",
    )


def _result(one: Row) -> str:
    if not one.sheets:
        return "-"
    return f"{one.sheets} sheets" if one.length_mm is None else f"{one.length_mm:.6g} long"


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100.0 * share:.2f}"


def _known(value: float) -> float | None:
    return None if isnan(value) else value
