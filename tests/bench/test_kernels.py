"""How long the kernels take, each with its result asserted.  Run with `pytest --benchmark-enable tests/bench`.

Goals: certificate of a quintic patch 50 ms, its samples 5 ms, its development 5 ms, its flattening by least strain
300 ms, whether it crosses itself 20 ms, the minimax of Theorem 2.3 50 ms.  The shape checks that run with the tests
cost more than the kernels: measure with `-p no:jaxtyping` or by `-o addopts=`.
"""

from fractions import Fraction

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from stages.construct.minimax import solve
from stages.construct.quintic import cone_ends
from stages.geometry.flat.development import develop
from stages.geometry.flat.relaxed import relaxed
from stages.geometry.paths.cover import doubled
from stages.geometry.ruled.crossing import Search, crossings
from stages.geometry.ruled.ruled import size_of
from stages.model.part import QuinticCone
from stages.unroll.distortion import measure
from stages.unroll.divide import blanks
from stages.verify import sampled
from stages.verify.certificate import certify
from tests.parts import (
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    EXAMPLE_3,
    QUINTIC_TANGENT,
    Table,
    part,
    patches,
)
from tests.stages.geometry.paths.test_cover import sector
from tests.stages.unroll.maps import HONEST, TOL, surface, value
from tests.stages.unroll.test_divide import certified, helix_strip
from tests.stages.verify.families import perturbed
from tests.warped import saddle, shaken

PATCHES: dict[str, Table] = {
    "example 1": EXAMPLE_1, "example 2, printed": EXAMPLE_2_PRINTED, "example 2, cylinder": EXAMPLE_2_CYLINDER,
    "tangent surface": QUINTIC_TANGENT,
}  # fmt: skip


@pytest.mark.parametrize("name", PATCHES)
def test_the_certificate_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    (patch,) = patches(PATCHES[name])
    proof = benchmark(certify, patch)
    assert proof.developable is (name != "example 2, printed")
    assert proof.positive


def test_the_certificates_of_patches_slightly_off(benchmark: BenchmarkFixture) -> None:
    """Thirty patches of degrees 2 to 7, a third of them with weights, 1e-2 to 1e-9 of their size from developable."""
    off = [perturbed(seed) for seed in range(30)]
    proofs = benchmark(lambda: [certify(patch) for patch in off])
    assert not any(proof.developable for proof in proofs)


@pytest.mark.parametrize("name", PATCHES)
def test_the_samples_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    (patch,) = patches(PATCHES[name])
    found = benchmark(sampled.survey, patch, 0)
    assert np.degrees(found.warp.value) == pytest.approx(
        3.2849872165 if name == "example 2, printed" else 0.0, abs=1e-9
    )


@pytest.mark.parametrize("name", PATCHES)
def test_the_largest_curvature_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    (patch,) = patches(PATCHES[name])
    assert benchmark(sampled.largest_curvature, patch, 0).value >= 0.0


@pytest.mark.parametrize("name", PATCHES)
def test_the_development_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    made = benchmark(develop, patches(PATCHES[name]))
    assert len(made.pieces) == 1


@pytest.mark.parametrize("name", PATCHES)
def test_the_development_of_a_strip_of_twenty_patches(name: str, benchmark: BenchmarkFixture) -> None:
    assert len(benchmark(develop, patches(PATCHES[name]) * 20).pieces) == 20


@pytest.mark.parametrize("name", PATCHES)
def test_the_distortion_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    made = patches(PATCHES[name])
    found = benchmark(measure, surface(made), develop(made), TOL)
    assert (value(found, "metric_error") <= HONEST) is (name != "example 2, printed")


@pytest.mark.parametrize("name", PATCHES)
def test_whether_a_quintic_patch_crosses_itself(name: str, benchmark: BenchmarkFixture) -> None:
    made = patches(PATCHES[name])
    assert benchmark(crossings, made, size_of(made)) == Search((), None)


def test_whether_a_helical_strip_of_ten_close_turns_crosses_itself(benchmark: BenchmarkFixture) -> None:
    made = helix_strip(100.0, 5.0, 10.0).patches
    assert benchmark(crossings, made, size_of(made)) == Search((), None)


def test_the_area_that_three_turns_cover_again(benchmark: BenchmarkFixture) -> None:
    found = benchmark(doubled, sector(50.0, 100.0, 6 * np.pi))
    assert found == pytest.approx(2 * np.pi * (100.0**2 - 50.0**2), rel=1e-12)


def test_dividing_a_helical_strip_of_three_turns(benchmark: BenchmarkFixture) -> None:
    whole = certified(helix_strip(100.0, 60.0, 3.0))
    assert len(benchmark(blanks, whole, TOL)) == 3


WARPED = {
    "example 2, printed": patches(EXAMPLE_2_PRINTED), "tangent surface, shaken": shaken(patches(QUINTIC_TANGENT), 1e-2),
    "saddle of 10 deg": saddle(10.0),
}  # fmt: skip


@pytest.mark.parametrize("name", WARPED)
def test_the_least_strain_of_a_patch(name: str, benchmark: BenchmarkFixture) -> None:
    made = benchmark(relaxed, WARPED[name], accuracy=1e-7)
    assert made.reached <= 1e-7
    assert made.energy < made.energy_along_rulings / 4.0


def test_the_minimax_of_example_3(benchmark: BenchmarkFixture) -> None:
    spec = part(EXAMPLE_3).spec.surface
    assert isinstance(spec, QuinticCone)
    ends = cone_ends(spec, (Fraction(0),) * 4, normalise=False)
    assert benchmark(solve, *ends).speed_max <= 0.698368026963404 + 1e-9
