"""How long the kernels take, each with its result asserted.  Run with `pytest --benchmark-enable tests/bench`.

Goals: certificate of a quintic patch 100 ms, its development 5 ms, the minimax of Theorem 2.3 50 ms.  The shape checks
that run with the tests cost more than the kernels: measure with `-p no:jaxtyping` or by `-o addopts=`.
"""

from fractions import Fraction

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from stages.construct.minimax import solve
from stages.construct.quintic import cone_ends
from stages.geometry.development import develop
from stages.model.part import QuinticCone
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

PATCHES: dict[str, Table] = {
    "example 1": EXAMPLE_1, "example 2, printed": EXAMPLE_2_PRINTED, "example 2, cylinder": EXAMPLE_2_CYLINDER,
    "tangent surface": QUINTIC_TANGENT,
}  # fmt: skip


@pytest.mark.parametrize("name", PATCHES)
def test_the_certificate_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    (patch,) = patches(PATCHES[name])
    place = sampled.largest_warp(patch, 0).v
    proof = benchmark(certify, patch, place)
    assert proof.developable is (name != "example 2, printed")


@pytest.mark.parametrize("name", PATCHES)
def test_the_development_of_a_quintic_patch(name: str, benchmark: BenchmarkFixture) -> None:
    made = benchmark(develop, patches(PATCHES[name]))
    assert len(made.pieces) == 1


def test_the_minimax_of_example_3(benchmark: BenchmarkFixture) -> None:
    spec = part(EXAMPLE_3).spec.surface
    assert isinstance(spec, QuinticCone)
    ends = cone_ends(spec, (Fraction(0),) * 4, normalise=False)
    assert benchmark(solve, *ends).speed_max <= 0.698368026963404 + 1e-9
