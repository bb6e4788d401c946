"""How a machine wants its files, and a file as text, before anyone decides where it lies."""

from dataclasses import dataclass, field
from typing import Literal

Flavour = Literal["polyline-arcs"]
Version = Literal["R2000"]

LAYER_COLOURS: dict[str, int] = {
    "CUT_OUTER": 1,
    "CUT_INNER": 5,
    "MARK": 3,
    "BEND_UP": 6,
    "BEND_DOWN": 4,
    "LABEL": 2,
    "SHEET": 8,
}
"""Layer names and AutoCAD colour indices of the default profile for metal."""


@dataclass(frozen=True, slots=True)
class Machine:
    """What the reader of the file expects."""

    flavour: Flavour = "polyline-arcs"
    version: Version = "R2000"
    layers: dict[str, int] = field(default_factory=lambda: dict(LAYER_COLOURS))
    max_bulge: float = 0.41421356237309503
    """Arcs are split so that no bulge is larger: tan(90 deg / 4), a quarter circle; readers fail above 1."""


@dataclass(frozen=True, slots=True)
class CutFile:
    """One drawing: its place below the output folder (such as `cut/plate-1.dxf`) and its text."""

    path: str
    text: str
