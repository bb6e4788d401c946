"""What one refinement of a flat map of least strain changed: the estimate of its error.

Where a map converges, the next change is smaller than the last, so that the last is a bound on what is missing.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Values, norm
from stages.geometry.flat.relaxedmap import RelaxedMap, principal

ACROSS = (1.0 - np.cos(np.linspace(0.0, np.pi, 11))) / 2.0
ALONG = (1.0 - np.cos(np.linspace(0.0, np.pi, 24))) / 2.0
"""Places of an element at which two levels are compared, the edges and corners among them, where both err most."""


@dataclass(frozen=True, slots=True)
class Change:
    """The largest change of a position, mm, and of a principal strain; the largest strain after it."""

    moved_mm: float
    strain: float
    largest: float

    def settled(self, before: "Change | None") -> bool:
        """Return whether more refinement is of no use to the strain: it stands, or does not converge.

        It does not at a corner that points into the pattern, where the least strain is infinite.
        """
        stands = self.strain <= SETTLED * self.largest
        return stands or (before is not None and self.strain > STALLED * before.strain)


SETTLED = 0.05
"""A strain is known when it changes nowhere by more than this share of the largest; classes are factors of 30 apart."""
STALLED = 0.8
"""A change that is not smaller than this share of the one before leads to no end: a converging one is below a half."""


def change(before: tuple[RelaxedMap, ...], after: tuple[RelaxedMap, ...]) -> Change:
    """Return what changed, over all pieces."""
    each = [_change(old, new) for old, new in zip(before, after, strict=True)]
    return Change(*(max(values) for values in zip(*each, strict=True)))


def _change(old: RelaxedMap, new: RelaxedMap) -> tuple[float, float, float]:
    u, v = _places(new)
    moved = norm(new.displacement(u, v) - old.displacement(u, v))
    strains = principal(new, u, v)
    differences = np.abs(strains - principal(old, u, v))
    return float(moved.max()), float(differences.max()), float(np.abs(strains).max())


def _places(piece: RelaxedMap) -> tuple[Values, Values]:
    """Return u and v of the places of all elements of a piece."""
    v = np.unique(piece.elements[:-1, None] + np.diff(piece.elements)[:, None] * ALONG)
    return np.tile(ACROSS, v.size), np.repeat(v, ACROSS.size)
