"""The certificate on random patches: no false proof, every bound above the truth, and close to it."""

from fractions import Fraction
from math import radians

import pytest

from stages.verify import sampled
from stages.verify.certificate import certify
from tests.stages.verify.exactly import curvature_at, dot, warp_at
from tests.stages.verify.families import developable, perturbed

PLACES = [Fraction(k, 8) for k in range(9)]
EXACT_RAD = radians(1e-9)


@pytest.mark.parametrize("first", range(0, 120, 20))
def test_no_perturbed_patch_gets_a_false_proof_and_bounds_are_tight(first: int) -> None:
    regular = 0
    for seed in range(first, first + 20):
        patch = perturbed(seed)
        proof = certify(patch)
        assert not proof.developable, "every one of these is warped"
        if not proof.positive:
            continue
        found = sampled.survey(patch, 0)
        places = [Fraction(found.warp.v), Fraction(found.gaussian.v), *PLACES]
        worst = max(warp_at(patch, v) for v in places)
        assert proof.warp_rad is not None
        assert proof.warp_rad >= worst, f"seed {seed}: the bound is below a value"
        assert proof.warp_rad > EXACT_RAD or worst <= EXACT_RAD, f"seed {seed}: a false exact"
        if proof.regular and worst >= EXACT_RAD:
            regular += 1
            assert proof.warp_rad <= 4.0 * worst, f"seed {seed}: {proof.warp_rad} against {worst}"
            sharpest = max(curvature_at(patch, v) for v in places)
            assert proof.curvature is not None
            assert sharpest <= proof.curvature <= 4.0 * max(sharpest, found.gaussian.value), f"seed {seed}"
    assert regular >= 10, "most of them must be regular, or the test says little"


@pytest.mark.parametrize("first", range(0, 100, 25))
def test_every_developable_is_proved_in_the_numbers_as_typed(first: int) -> None:
    unfolded = 0
    for seed in range(first, first + 25):
        patch = developable(seed)
        proof = certify(patch)
        assert proof.developable, f"seed {seed}"
        assert proof.positive is not None, "a developable is never left open"
        if proof.positive:
            unfolded += 1
            assert (proof.warp_rad, proof.curvature) == (0.0, 0.0)
        else:
            assert proof.where is not None
            assert dot(patch, Fraction(proof.where)) < 0, f"seed {seed}: not folded there"
    assert unfolded >= 15, "most of them must not fold, or the test says little"
