"""What one K for a whole part neglects: K by the material's rule, edge by edge, against the one that is used.

int |K(r/t) - K| t |d theta| along each edge, with r its inside radius; apexes are no bends and do not count.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stages.geometry.arrays import Array, Values
from stages.geometry.numeric.quadrature import WEIGHTS
from stages.geometry.ruled.tightest import apexes
from stages.geometry.ruled.turning import FLAT, PatchTurning, is_fold
from stages.model.kfactor import Rule, k_at
from stages.unroll.bent import Bent, inside_radii


@dataclass(frozen=True, slots=True)
class Variation:
    """How K by a rule differs from the one K used: least and largest r/t and K, and by how much each edge changes.

    change_mm: length that the rule would add to c0 and to c1, signed.  bound_mm: the same with all signs positive.
    """

    ratio: tuple[float, float]
    k: tuple[float, float]
    change_mm: tuple[float, float]
    bound_mm: float


def variation(bent: Bent) -> Variation | None:
    """Return the variation of K over the part by its own rule; by DIN 6935 where nobody gave one."""
    if all(is_fold(stretch) or abs(stretch.angle_rad) <= FLAT for stretch in bent.bends.stretches):
        return None
    law = bent.material.k_factor
    rule: Rule = law.rule if law.given else "din6935"
    points = apexes(bent.bends)
    found = [
        _of_piece(piece, bent, rule, [u for u in (0, 1) if (i, float(u)) not in points])
        for i, piece in enumerate(bent.bends.pieces)
    ]
    ratios, ks = (np.concatenate([entry[i] for entry in found]) for i in (0, 1))
    change, bound = (np.sum([entry[i] for entry in found], axis=0) for i in (2, 3))
    return Variation(
        (float(ratios.min()), float(ratios.max())),
        (float(ks.min()), float(ks.max())),
        (float(change[0]), float(change[1])),
        float(bound.max()),
    )


def _of_piece(piece: PatchTurning, bent: Bent, rule: Rule, edges: Sequence[int]) -> tuple[Values, Values, Array, Array]:
    """Return r/t and K at the nodes of these edges that bend, and the change of both in mm, signed and unsigned."""
    beta, t = piece.rates[..., 0], bent.sheet.thickness_mm
    weights = np.diff(piece.breaks)[:, None] / 2.0 * WEIGHTS
    bends = np.abs(beta) > FLAT
    turn = (np.abs(beta) * weights)[bends]
    ratios = np.stack([inside_radii(piece.rates[bends], bent.sheet, u) for u in edges]) / t
    ks = np.stack([k_at(rule, row) for row in ratios])
    change = np.zeros((2, turn.size))
    change[list(edges)] = (ks - bent.k) * t * turn
    return ratios.ravel(), ks.ravel(), change.sum(axis=1), np.abs(change).sum(axis=1)
