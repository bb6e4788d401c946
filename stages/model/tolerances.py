"""What the shop accepts: one value, handed to every stage, named by meaning.

These are not the numerical guards of algorithms; those are constants beside their use.
"""

from dataclasses import dataclass
from typing import Literal

Class = Literal["exact", "fabrication", "metal", "leather"]
CLASSES: tuple[Class, ...] = ("exact", "fabrication", "metal", "leather")
"""From the best to the worst."""

WARP_LIMIT_DEG: dict[Class, float] = {"exact": 1e-9, "fabrication": 0.1, "metal": 8.0, "leather": 45.0}
"""The largest warp of each class.  0.1 % of strain is about 8 deg of warp on a square patch, 3 % about 45."""

STRAIN_LIMIT: dict[Class, float] = {"exact": 1e-9, "fabrication": 1e-5, "metal": 1e-3, "leather": 3e-2}
"""The largest strain of each class, as a fraction."""


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Shop tolerances of one job.

    accept: the worst class of surface that is cut.
    chord_mm: largest distance between a written contour and the exact one.
    join_mm: largest gap between the ends of adjacent pieces of a strip.
    tangent_norm: how far a vector given as a unit tangent or normal may be from length 1.
    normalise: scale such vectors to length 1 (the surface is then exact by bound, not by decimals).
    """

    accept: Class = "fabrication"
    chord_mm: float = 0.05
    join_mm: float = 0.01
    tangent_norm: float = 1e-3
    normalise: bool = False

    def accepts(self, reached: str) -> bool:
        """Return whether a part of that class is cut."""
        return reached in CLASSES[: CLASSES.index(self.accept) + 1]


def class_by_warp(warp_deg: float) -> Class | None:
    """Return the best class whose warp limit holds, or None."""
    return next((name for name in CLASSES if warp_deg <= WARP_LIMIT_DEG[name]), None)


def class_by_strain(strain: float) -> Class | None:
    """Return the best class whose strain limit holds, or None."""
    return next((name for name in CLASSES if strain <= STRAIN_LIMIT[name]), None)
