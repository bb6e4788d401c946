"""The table of cutting processes: `data/processes.toml`, every value with its source in words.

A limit that goes with the thickness is taken at its least value where no thickness is known.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from pipeline.materials import Sourced
from pipeline.processtables import ProcessTable


@dataclass(frozen=True, slots=True)
class Rule:
    """A least width: the larger of `least` (mm) and `per_thickness` times the thickness."""

    least: float
    per_thickness: float
    source: str

    def at(self, thickness: float | None) -> Sourced:
        """Return the width in mm for a thickness, and whence it comes."""
        wanted = self.per_thickness * (thickness or 0.0)
        how = f"{self.per_thickness:g} x thickness" if wanted > self.least else f"{self.least:g} mm"
        return Sourced(max(self.least, wanted), f"{how}; {self.source}")


@dataclass(frozen=True, slots=True)
class ProcessRow:
    """A process up to a thickness (mm; None: from the row before on)."""

    type: str
    up_to: float | None
    kerf: Sourced
    min_hole: Rule | None
    min_web: Rule | None


@cache
def table() -> tuple[ProcessRow, ...]:
    """Return all rows in the order of the file."""
    text = files("pipeline").joinpath("data", "processes.toml").read_text("utf-8")
    return tuple(
        ProcessRow(
            row["type"],
            row.get("up_to"),
            Sourced(float(row["kerf"]["value"]), row["kerf"]["source"]),
            _rule(row.get("min_hole")),
            _rule(row.get("min_web")),
        )
        for row in tomllib.loads(text)["process"]
    )


def _rule(entry: Mapping[str, object] | None) -> Rule | None:
    if entry is None:
        return None
    return Rule(float(str(entry["least"])), float(str(entry["per_thickness"])), str(entry["source"]))


def listing() -> str:
    """Return the table as text: every value with its source."""
    return "\n".join(line for row in table() for line in _row_lines(row))


def _row_lines(row: ProcessRow) -> list[str]:
    rules = {"min_hole": row.min_hole, "min_web": row.min_web}
    lines = [f"{row.type}{'' if row.up_to is None else f'   (up to {row.up_to:g} mm)'}"]
    lines.append(f"  {'kerf':18} {f'{row.kerf.value:g} mm':16} {row.kerf.source}")
    for name, rule in rules.items():
        if rule is not None:
            lines.append(f"  {name:18} {f'{rule.least:g} mm, {rule.per_thickness:g} t':16} {rule.source}")
    return lines


def look_up(process: str, thickness: float | None) -> ProcessRow:
    """Return the row of a process for a thickness; ValueError for a process that is in no row."""
    rows = [row for row in table() if row.type == process]
    for row in rows:
        if row.up_to is None or (thickness or 0.0) <= row.up_to:
            return row
    raise ValueError(f"no row of processes.toml holds for {process!r} at {thickness} mm")


def limits(asked: ProcessTable, thickness: float | None) -> dict[str, Sourced]:
    """Return kerf, min_hole and min_web in mm, as far as they are known: as given, else those of the table."""
    given = {"kerf": asked.kerf, "min_hole": asked.min_hole, "min_web": asked.min_web}
    own = {name: float(value) for name, value in given.items() if value is not None}
    named = {name: Sourced(value, f"job file, process.{name}") for name, value in own.items()}
    return (_of_table(asked.type, thickness) if asked.type is not None else {}) | named


def _of_table(process: str, thickness: float | None) -> dict[str, Sourced]:
    row = look_up(process, thickness)
    rules = {"min_hole": row.min_hole, "min_web": row.min_web}
    found = {"kerf": row.kerf} | {name: rule.at(thickness) for name, rule in rules.items() if rule is not None}
    return {name: Sourced(one.value, f"processes.toml, {process}: {one.source}") for name, one in found.items()}
