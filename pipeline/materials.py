"""The table of materials: `data/materials.toml`, every value with its source in words.

A limit that neither the table nor the job gives is not checked.  The leather rows are estimates; whoever cuts leather
should put his own measurements into the job.
"""

import tomllib
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.resources import files


@dataclass(frozen=True, slots=True)
class Sourced:
    """A value and where it comes from."""

    value: float
    source: str


@dataclass(frozen=True, slots=True)
class MaterialRow:
    """One material.

    density in kg/m3; bend_radius_ratio: smallest inside radius over thickness; max_strain of the outer fibre, as a
    fraction; yield_strength in MPa and youngs_modulus in GPa: None for what is not elastic.
    """

    name: str
    also: tuple[str, ...]
    density: Sourced
    bend_radius_ratio: Sourced
    max_strain: Sourced
    yield_strength: Sourced | None = None
    youngs_modulus: Sourced | None = None


VALUES = {
    "density": "kg/m3", "bend_radius_ratio": "x thickness", "max_strain": "", "yield_strength": "MPa",
    "youngs_modulus": "GPa",
}  # fmt: skip
"""The values of a row and their units."""


@cache
def table() -> tuple[MaterialRow, ...]:
    """Return all rows in the order of the file."""
    text = files("pipeline").joinpath("data", "materials.toml").read_text("utf-8")
    return tuple(
        MaterialRow(row["name"], tuple(row["also"]), **{key: _sourced(row[key]) for key in VALUES if key in row})
        for row in tomllib.loads(text)["material"]
    )


def _sourced(entry: dict[str, object]) -> Sourced:
    return Sourced(float(str(entry["value"])), str(entry["source"]))


def look_up(name: str) -> tuple[MaterialRow | None, tuple[str, ...]]:
    """Return the row of that name, if there is one, and a note if not."""
    known = {_plain(alias): row for row in table() for alias in (row.name, *row.also)}
    row = known.get(_plain(name))
    if row is not None:
        return row, ()
    near = get_close_matches(_plain(name), known, 1)
    advice = f'; did you mean "{known[near[0]].name}"?' if near else "; planish materials lists those that it has"
    return None, (f'material "{name}" is not in the table: only the values given count{advice}',)


def are_same(one: str, other: str) -> bool:
    """Return whether two names mean one material: they are names of one row, or alike but for case and hyphens."""
    rows = [look_up(name)[0] for name in (one, other)]
    return _plain(one) == _plain(other) or (rows[0] is not None and rows[0] is rows[1])


def _plain(name: str) -> str:
    return " ".join(name.casefold().replace("aluminum", "aluminium").replace("-", " ").split())


def listing() -> str:
    """Return the table as text: every value with its source."""
    return "\n".join(line for row in table() for line in _row_lines(row))


def _row_lines(row: MaterialRow) -> list[str]:
    lines = [f"{row.name}   (also: {', '.join(row.also)})"]
    for key, unit in VALUES.items():
        sourced: Sourced | None = getattr(row, key)
        if sourced is not None:
            lines.append(f"  {key:18} {f'{sourced.value:g} {unit}'.rstrip():16} {sourced.source}")
    return lines
