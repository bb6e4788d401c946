"""Every kind of surface: lengths and areas against 40 digits from 1 mm to 10 m, and what each kind refuses."""

from fractions import Fraction
from functools import cache

import pytest
from mpmath import mpf

from stages.construct import construct
from stages.construct.sets import parts_of
from stages.model.part import KINDS
from stages.model.report import Metric, StageReport
from stages.model.surface import RuledSurface
from stages.unroll import unroll
from stages.verify import verify
from tests import oracles
from tests.kinds.example import Pair
from tests.kinds.examples import EXAMPLES
from tests.near import assert_relative
from tests.parts import DEFAULT, part

NOT_RULED = {"flat", "mesh", "face"}
"""Kinds without rulings of their own, tested elsewhere."""
PROMISED = 1e-10
"""What the program promises of lengths and areas, relative."""
SIZES = [Fraction(1, 5), Fraction(1500)]
"""The examples measure 1 to 12: some 1 mm, and some 10 m, by turns."""


def figures(blank: list[Pair]) -> dict[str, mpf]:
    """Return area and edges of a blank at size 1, by quadrature in 40 digits."""
    first, last = blank[0], blank[-1]
    return {
        "area": sum((oracles.area(*pair) for pair in blank), mpf(0)),
        "c0": sum((oracles.length(c0) for c0, _ in blank), mpf(0)),
        "c1": sum((oracles.length(c1) for _, c1 in blank), mpf(0)),
        "start": oracles.norm(oracles.add(first[1](mpf(0))[0], first[0](mpf(0))[0], -1)),
        "end": oracles.norm(oracles.add(last[1](mpf(1))[0], last[0](mpf(1))[0], -1)),
    }


@cache
def wanted(kind: str) -> list[dict[str, mpf]]:
    return [figures(blank) for blank in EXAMPLES[kind].blanks()]


def measured(report: StageReport, side: str) -> dict[str, float]:
    made = report.detail[side]
    assert isinstance(made, dict)
    return {"area": made["area"]} | made["edges"]


def test_every_kind_has_its_example() -> None:
    tags = {kind.__struct_config__.tag for kind in KINDS}
    assert set(EXAMPLES) == tags - NOT_RULED


@pytest.mark.parametrize(("kind", "size"), [(kind, SIZES[i % 2]) for i, kind in enumerate(EXAMPLES)])
def test_lengths_and_areas_agree_with_40_digits(kind: str, size: Fraction) -> None:
    whole = part(EXAMPLES[kind].table(size))
    blanks = parts_of(whole)
    assert len(blanks) == len(wanted(kind))
    for blank, exact in zip(blanks, wanted(kind), strict=True):
        made = construct(blank, DEFAULT)
        assert made.product is not None, made.report.findings
        certificate = verify(made.product, DEFAULT)
        assert certificate.product is not None, certificate.report.findings
        assert certificate.product.reached == "exact"
        _evidence(made.product, certificate.report.metric("max_warp_deg"), proved=EXAMPLES[kind].proved)
        report = unroll(certificate.product, DEFAULT).report
        for side in ("surface", "flat"):
            found = measured(report, side)
            assert set(found) == set(exact)
            for name, value in exact.items():
                lengths = 2 if name == "area" else 1
                assert_relative(
                    found[name], float(value) * float(size) ** lengths, bound=PROMISED, why=f"{side} {name}"
                )


def _evidence(surface: object, warp: Metric, *, proved: bool) -> None:
    """Check that exact directrices are proved, and that the example's are what it says."""
    assert isinstance(surface, RuledSurface)
    assert all(patch.exact for patch in surface.patches) == proved
    if proved:
        assert warp.evidence == "proved"
