"""The part as it is bent: the surface as given, how it turns, and where the sheet lies about it.

Radii at the ends of rulings follow from the rates of turning: rho = width / |beta| on the surface as given, less the
offset of whatever layer of the sheet is meant.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Values, Vector2
from stages.geometry.ruled.tightest import Tight
from stages.geometry.ruled.turning import Turning, is_fold, rates
from stages.model.material import Material
from stages.model.sheetface import Layers
from stages.model.surface import RuledSurface

SLIGHT = 1e-6
"""A curvature at a ruling, or a jump of it, below this share of 1/D bends the part by less than a micrometre per metre.
No press or roll is set by that: no radius is given there and no line drawn.  Whether the part bends at all is another
question, with a finer answer (`stages.verify.bending`)."""


@dataclass(frozen=True, slots=True)
class Bent:
    """A part as given: surface, turning, sheet (of no thickness where that is not known), and the K used for it.

    kept: u of the edge that the unrolled surface shares with the given one, its apexes (`stages.unroll.apexes`).
    """

    surface: RuledSurface
    bends: Turning
    sheet: Layers
    k: float
    kept: float | None = None

    def neutral_mm(self, sign: float) -> Vector2:
        """Return the offsets of both edges of the unrolled surface where it bends towards sign * N, mm."""
        return neutral_mm(self.sheet, self.k, self.kept, sign)

    @property
    def material(self) -> Material:
        """Return what the part is made of."""
        return self.surface.part.material

    def v_of(self, place: float) -> float:
        """Return the part's v at a place counted over the patches (i + v on patch i)."""
        piece = min(int(place), len(self.surface.patches) - 1)
        return self.surface.v_of(piece, place - piece)

    def rates_at(self, places: Values) -> Array:
        """Return the rate of turning and the widths of both edges at places, shape (n, 3)."""
        index = np.minimum(places.astype(np.int64), len(self.bends.pieces) - 1)
        found = np.zeros((places.size, 3))
        for k in np.unique(index):
            piece = self.bends.pieces[k]
            found[index == k] = rates(piece.patch, piece.normal, places[index == k] - k)
        return found

    def inside_mm(self, sign: float, tight: Tight) -> float:
        """Return the inside radius at the tightest place of one way, mm; below 0 where the sheet is too thick."""
        return 1.0 / tight.curvature - sign * self.sheet.inside_mm(sign)


def neutral_mm(sheet: Layers, k: float, kept: float | None, sign: float) -> Vector2:
    """Return how far both edges of the unrolled surface lie from those given, where it bends towards sign * N, mm."""
    return tapering(kept) * sheet.neutral_mm(sign, k)


def tapering(kept: float | None) -> Vector2:
    """Return the share of an offset that both edges move by: all of it, or nothing where u is kept."""
    return np.array([float(kept != 0.0), float(kept != 1.0)])


def inside_radii(at: Array, sheet: Layers, u: int) -> Values:
    """Return the inside radii at one end of rulings that bend, mm, never negative; `at`: rates of shape (n, 3)."""
    sign = np.sign(at[:, 0])
    inside = np.where(sign > 0.0, sheet.plus_mm, sheet.minus_mm)
    radii: Values = np.maximum(at[:, 1 + u] / np.abs(at[:, 0]) - sign * inside, 0.0)
    return radii


def radii_at(bent: Bent, places: Values) -> list[list[float | None]]:
    """Return the inside radii at both ends of the rulings at places, mm; None where the part is straight across."""
    at = bent.rates_at(places)
    bends = np.abs(at[:, 0]) * bent.surface.size_mm > SLIGHT * np.abs(at[:, 1:]).max(axis=1)
    found: list[list[float | None]] = [[None, None] for _ in places]
    for k, *radii in zip(np.flatnonzero(bends), *(inside_radii(at[bends], bent.sheet, u) for u in (0, 1)), strict=True):
        found[k] = [float(radius) for radius in radii]
    return found


def across(bent: Bent, places: Values, distance_mm: float | None = None) -> Array:
    """Return the distance across the rulings from the first one up to places, along c0 and along c1, mm, shape (n, 2).

    On the parallel surface at a distance; on the one that is unrolled if none is given.
    """
    total = np.zeros((places.size, 2))
    for stretch in bent.bends.stretches:
        if is_fold(stretch):
            continue
        ends = np.clip(places - stretch.piece, stretch.low, stretch.high)
        upto = bent.bends.pieces[stretch.piece].upto(np.append(ends, stretch.low))
        passed = upto[:-1] - upto[-1]
        sign = 1.0 if stretch.angle_rad >= 0.0 else -1.0
        distances = bent.neutral_mm(sign) if distance_mm is None else np.full(2, distance_mm)
        total += passed[:, 1:] - distances * passed[:, :1]
    return total
