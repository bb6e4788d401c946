"""Each patch of a surface, examined once: by proof where its directrices are exact, by samples where that leaves a gap.

What is proved is not sampled again.
"""

from dataclasses import dataclass

import numpy as np

from stages.geometry.ruled.ruled import RuledPatch, warp
from stages.verify import sampled
from stages.verify.certificate import Certified, certify
from stages.verify.sampled import Extreme, Survey


@dataclass(frozen=True, slots=True)
class Examined:
    """What is known of one patch.

    proof: None for directrices that are not exact.
    samples: None where the proof bounds warp and |K|; where the patch is singular is always proved.
    """

    patch: RuledPatch
    piece: int
    proof: Certified | None
    samples: Survey | None

    @property
    def proved(self) -> bool:
        """Return whether the warp is proved."""
        return self.proof is not None and self.proof.warp_rad is not None

    @property
    def curvature_proved(self) -> bool:
        """Return whether the bound of |K| is proved (it may be infinite)."""
        return self.proof is not None and self.proof.curvature is not None

    @property
    def regular(self) -> bool:
        """Return whether the surface has a normal everywhere, edges included."""
        return self._surveyed.regular if self.proof is None else self.proof.regular

    @property
    def warp(self) -> Extreme:
        """Return the largest warp, rad: the proved bound, or the largest sample."""
        if self.proof is not None and self.proof.warp_rad is not None:
            return Extreme(self.proof.warp_rad, self.piece, self.proof.where or 0.0)
        return self._surveyed.warp

    @property
    def gaussian(self) -> Extreme:
        """Return the largest |K|, 1/mm2: the proved bound, or the largest sample."""
        if self.proof is not None and self.proof.curvature is not None:
            return Extreme(self.proof.curvature, self.piece, self.proof.curvature_where or 0.0)
        return self._surveyed.gaussian

    @property
    def sampled_warp(self) -> float:
        """Return the largest warp met at a ruling, rad; of a proof, that of the ruling where it is nearly reached.

        A proof may reach its largest value towards a ruling at which both normals vanish: then just beside it.
        """
        if self.samples is not None:
            return self.samples.warp.value
        at = self.proof.where if self.proof is not None else None
        if at is None:
            return 0.0
        met = warp(self.patch, np.clip([at, at - BESIDE, at + BESIDE], 0.0, 1.0))
        return float(np.nanmax(met[:1] if np.isfinite(met[0]) else met, initial=0.0))

    @property
    def _surveyed(self) -> Survey:
        if self.samples is None:
            raise ValueError("neither proved nor sampled")
        return self.samples


BESIDE = 1e-3
"""How far in v beside a ruling without normals the warp is looked at: normals that vanish there of the third order have
1e-9 of their size, and keep six digits."""


def examine(patch: RuledPatch, piece: int) -> Examined:
    """Return what is known of a patch."""
    proof = certify(patch) if patch.exact else None
    enough = proof is not None and None not in (proof.warp_rad, proof.curvature)
    return Examined(patch, piece, proof, None if enough else sampled.survey(patch, piece))
