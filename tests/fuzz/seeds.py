"""Valid jobs to begin with: one of every kind, and some that use what parts and stock may have besides a surface."""

import tomllib
from importlib.resources import files
from pathlib import Path

TEMPLATES = files("pipeline").joinpath("data", "init")
RICH = Path(__file__).with_name("jobs")
SLOW = ("rails", "ribbon", "elbow")
"""Kinds that take some hundred milliseconds as they are: drawn less often."""
RARE = ("face", "mesh", *SLOW)


def _template(kind: str) -> dict[str, object]:
    """Return the job of a kind without stock, with no pictures."""
    table = tomllib.loads(TEMPLATES.joinpath(f"{kind}.toml").read_text("utf-8"))
    table.pop("stock", None)
    return table | {"report": {"formats": ["json"]}}


KINDS = sorted(entry.name.removesuffix(".toml") for entry in TEMPLATES.iterdir())
SEEDS = {kind: _template(kind) for kind in KINDS} | {
    file.stem: tomllib.loads(file.read_text("utf-8")) for file in sorted(RICH.glob("*.toml"))
}
OFTEN = sorted({*SEEDS} - {*RARE})
