"""Kerf, K-factor and springback are fitted within their stated intervals, or refused with the reason."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest

from pipeline.asmade.fits import k_offer, kerf_offer, springback_offer
from pipeline.asmade.nominal import Nominal
from pipeline.asmade.rows import Measured, Reading, exact
from stages.model.material import Material
from stages.unroll.rolls import tool_radius
from tests.pipeline.asmadejobs import PLATE_NAME

U_MM, U_DEG = Fraction(1, 20), Fraction(1, 5)
COVER = 1.959963984540054


def reading(
    nominal: Nominal, part: str, what: str, value: float, *, copy: int = 1, tool: float | None = None
) -> Reading:
    """Return a reading as an instrument shows it."""
    of = next(one for one in nominal.dimensions if (one.part, one.what) == (part, what))
    u = U_MM if of.unit == "mm" else U_DEG
    bent_to = None if tool is None else exact(tool)
    return Reading(2, copy, of, exact(value), u, None, "", bent_to, str(value), Fraction(1))


def blank(nominal: Nominal, kerf: float, rng: np.random.Generator) -> Measured:
    """Return all sizes of blanks cut with a kerf along nominal contours."""
    found = [
        reading(nominal, one.part, one.what, one.nominal + one.rate * kerf + rng.normal(0.0, float(U_MM) / COVER))
        for one in nominal.dimensions
        if one.rate is not None
    ]
    return Measured(tuple(found), (), 0)


def bent(nominal: Nominal, k: float, rng: np.random.Generator) -> Measured:
    """Return four angles bent from nominal blanks with another K, as measured."""
    found = []
    for copy in range(1, 5):
        true = {one.what: one.nominal for one in nominal.dimensions if one.part == "angle" and one.rate is None}
        true["height"] = 36 + 56 + pi / 2 * (4 + 0.4 * 2)
        true["flange 2"] += pi / 2 * (0.4 - k) * 2
        for what, value in true.items():
            u = float(U_DEG if what.endswith("angle") else U_MM) / COVER
            found.append(reading(nominal, "angle", what, value + rng.normal(0.0, u), copy=copy))
    return Measured(tuple(found), (), 0)


def rolled(nominal: Nominal, yield_mpa: float, rng: np.random.Generator) -> Measured:
    """Return the radii left of a shell rolled to those that would leave 299 mm."""
    tool = tool_radius(Material(thickness_mm=2.0, yield_strength_mpa=yield_mpa, youngs_modulus_gpa=210.0), 299.0)
    found = [
        reading(nominal, "shell", f"roll {i} radius", 299.0 + rng.normal(0.0, float(U_MM) / COVER), tool=tool)
        for i in range(1, 6)
    ]
    return Measured(tuple(found), (), 0)


FITS = {
    "kerf": (blank, kerf_offer, 0.18, 1.0),
    "k_factor": (bent, k_offer, 0.43, 1.0),
    "springback": (rolled, springback_offer, 260.0, 1.0 / 210e3),
}


@pytest.mark.parametrize("name", FITS)
def test_intervals_cover_the_truth_as_often_as_stated(nominal: Nominal, name: str) -> None:
    simulated, offer, truth, scale = FITS[name]
    rng = np.random.default_rng(11)
    made = [offer(simulated(nominal, truth, rng), nominal) for _ in range(200)]
    covered = np.mean([abs(one.value - truth * scale) <= one.half for one in made])
    assert covered >= 0.9  # 0.95 less 3.2 standard deviations of 200 draws
    assert np.mean([not one.reason for one in made]) >= 0.97
    assert all(one.toml for one in made if not one.reason)


def test_a_transposed_digit_is_named_and_not_averaged_away(nominal: Nominal) -> None:
    good = blank(nominal, 0.18, np.random.default_rng(2)).readings
    wrong = next(i for i, one in enumerate(good) if one.of.what == "height")
    spoilt = reading(nominal, PLATE_NAME, "height", 289.92)
    found = kerf_offer(Measured((*good[:wrong], spoilt, *good[wrong + 1 :]), (), 0), nominal)
    (outlier,) = found.outliers
    assert (outlier.tell.part, outlier.tell.what) == (PLATE_NAME, "height")
    assert abs(found.value - 0.18) <= found.half
    assert not found.reason


def test_too_few_readings_are_refused_with_what_to_measure(nominal: Nominal) -> None:
    two = Measured(blank(nominal, 0.2, np.random.default_rng(1)).readings[:2], (), 0)
    assert kerf_offer(two, nominal).reason.startswith("2 of at least 3 readings")
    four = bent(nominal, 0.4, np.random.default_rng(1)).readings
    without = Measured(tuple(one for one in four if one.of.what != "thickness"), (), 0)
    assert k_offer(without, nominal).reason.endswith("not measured: thickness")


def test_residuals_beyond_the_stated_uncertainty_are_refused(nominal: Nominal) -> None:
    rng = np.random.default_rng(5)
    coarse = [
        reading(nominal, one.part, one.what, one.nominal + rng.normal(0.0, 3 * float(U_MM)))
        for one in nominal.dimensions
        if one.rate is not None
    ]
    found = kerf_offer(Measured(tuple(coarse), (), 0), nominal)
    assert found.reason
    assert not found.toml


def test_no_kerf_is_offered_where_none_is_told_from_0(nominal: Nominal) -> None:
    assert kerf_offer(blank(nominal, 0.0, np.random.default_rng(1)), nominal).reason.startswith("not told from 0")
