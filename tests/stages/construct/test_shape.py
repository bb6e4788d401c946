"""`alpha = "auto"` on every quintic kind: the numbers found stand in for those left out, and all else is as before."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from stages.construct.energy import least_energy
from stages.construct.minimax import solve
from stages.construct.quintic import cone_ends, directrix, ends_of
from stages.geometry.arrays import cross2
from stages.geometry.curves.curves import Bezier
from stages.geometry.flat.development import develop
from stages.model.quintics import QuinticCone, QuinticRuled
from stages.model.surface import RuledSurface
from tests.near import assert_near, assert_relative
from tests.parts import (
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    EXAMPLE_3,
    NEXT_PATCH,
    Table,
    passage,
    patches,
    read,
    troubles,
)
from tests.stages.construct.test_energy import energy

GIVEN = ("alpha0", "alpha1", "beta0", "beta1", "s0", "s1", "alpha")


def auto(table: Table, *keys: str) -> Table:
    """Return the table with the shape parameters of its directrices left to the program."""
    hats = {f"{key}_hat" for key in GIVEN} if "alpha_hat" in keys else set()
    return {k: v for k, v in table.items() if k not in GIVEN and k not in hats} | dict.fromkeys(keys, "auto")


CYLINDER, CONE = auto(EXAMPLE_2_CYLINDER, "alpha"), auto(EXAMPLE_3, "alpha")
RULED, PLANAR = auto(EXAMPLE_2_PRINTED, "alpha", "alpha_hat"), auto(EXAMPLE_1, "alpha", "alpha_hat")


@pytest.mark.parametrize("table", [CYLINDER, CONE, PLANAR])
def test_what_is_developable_for_any_shape_is_proved_to_be_with_the_one_found(table: Table) -> None:
    made = passage(table)
    assert made.value("construct", "theorem_residual") == 0.0
    warp = made.metric("verify", "max_warp_deg")
    assert (warp.value, warp.evidence) == (0.0, "proved")


def test_the_report_says_which_shape_was_found_and_its_energy() -> None:
    spec = read(RULED).surface
    assert isinstance(spec, QuinticRuled)
    detail = passage(RULED).reports["construct"].detail
    for suffix in ("", "_hat"):
        found = least_energy(*ends_of(spec, suffix, normalise=False))
        shape = {"alpha0": found.alpha0, "alpha1": found.alpha1, "beta0": found.beta0, "beta1": found.beta1}
        assert detail[f"shape{suffix}"] == {f"{key}{suffix}": value for key, value in shape.items()}
        assert detail[f"strain_energy{suffix}_mm2"] == found.energy_mm2


def test_the_numbers_found_may_be_typed_instead() -> None:
    detail = passage(RULED).reports["construct"].detail
    typed = {k: v for k, v in RULED.items() if k not in ("alpha", "alpha_hat")}
    for suffix in ("", "_hat"):
        shape = detail[f"shape{suffix}"]
        assert isinstance(shape, dict)
        typed |= {key: str(Fraction(value)) for key, value in shape.items()}
    for mine, found in zip(patches(typed), patches(RULED), strict=True):
        for a, b in ((mine.c0, found.c0), (mine.c1, found.c1)):
            assert isinstance(a, Bezier)
            assert isinstance(b, Bezier)
            assert a.exact == b.exact


def test_energy_falls_below_that_of_the_minimax() -> None:
    spec = read(CONE).surface
    assert isinstance(spec, QuinticCone)
    ends = cone_ends(spec, (Fraction(0),) * 4, normalise=False)
    by_speed = [Fraction(x) for x in solve(*ends).shape]
    assert least_energy(*ends).energy_mm2 < float(energy(*ends, by_speed))


def test_a_tangent_far_off_the_chord_is_told_and_does_not_stop_the_part() -> None:
    away = CYLINDER | {"t0": [-1, 0, 0], "n0": [0, 1, 0]}
    made = passage(away)
    assert "alpha-at-bound" in made.codes("construct", fatal=False)
    assert made.surface is not None


def test_a_strip_may_start_with_a_shape_that_is_found() -> None:
    made = passage({"kind": "quintic-strip", "first": CYLINDER, "next": [NEXT_PATCH]})
    assert made.value("construct", "join_continuity") == 2.0
    assert made.metric("verify", "max_warp_deg").value == 0.0


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (RULED | {"alpha0": 2}, 'given beside alpha = "auto"'),
        (RULED | {"beta1_hat": 2}, 'given beside alpha_hat = "auto"'),
        (CYLINDER | {"s0": 2}, 'given beside alpha = "auto"'),
        (CONE | {"alpha0": 1, "alpha1": 1, "beta0": 1, "beta1": 1}, 'given beside alpha = "auto"'),
        (CONE | {"guess": [1, 1, 1, 1]}, 'a guess beside alpha = "auto"'),
        ({k: v for k, v in EXAMPLE_2_PRINTED.items() if k != "beta0"}, "missing"),
        ({k: v for k, v in EXAMPLE_2_CYLINDER.items() if k != "s1"}, "missing"),
        ({k: v for k, v in EXAMPLE_1.items() if k != "alpha0_hat"}, "missing"),
    ],
)
def test_shapes_given_twice_or_not_at_all_are_refused(table: Table, said: str) -> None:
    assert troubles(table) == [said]


# The directrix as a geodesic

GEODESIC: Table = {
    "kind": "quintic-ruled", "directrix_geodesic": True, "half_width": 1.5, "alpha": "auto",
    "p0": [0, 0, 0], "p1": [80, 60, 30], "t0": [1, 0, 0], "t1": [0, "0.8", "0.6"],
    "n0": [0, 1, 0], "n1": [-1, 0, 0], "k0": 0.01, "k1": 0.012,
}  # fmt: skip


def directrix_of(table: Table) -> Bezier:
    """Return the first directrix with the shape that is found for it."""
    spec = read(table).surface
    assert isinstance(spec, QuinticRuled)
    start, end = ends_of(spec, "", normalise=False)
    found = least_energy(start, end)
    return directrix(
        replace(start, alpha=Fraction(found.alpha0), beta=Fraction(found.beta0)),
        replace(end, alpha=Fraction(found.alpha1), beta=Fraction(found.beta1)),
    )


def test_the_directrix_becomes_a_straight_line_in_the_middle_of_a_straight_strip() -> None:
    """Area 2 w L, and all points of the directrix on one line of the flat, as far apart as along the curve."""
    made = passage(GEODESIC)
    nodes, weights = np.polynomial.legendre.leggauss(64)
    length = float(weights @ np.linalg.norm(directrix_of(GEODESIC).jet((nodes + 1) / 2, 1)[1], axis=1)) / 2
    area = made.side("flat")["area"]
    assert isinstance(area, float)
    assert_relative([area], [2 * 1.5 * length], bound=1e-10, why="a straight strip: 2 w L")
    assert isinstance(made.surface, RuledSurface)
    (patch,) = made.surface.patches
    (piece,) = develop((patch,)).pieces
    flat = piece.positions(np.full(9, 0.5), np.linspace(0.0, 1.0, 9))
    along = flat[-1] - flat[0]
    assert_relative([float(np.hypot(*along))], [length], bound=1e-10, why="a geodesic keeps its length")
    off = cross2(flat - flat[0], along / np.hypot(*along))
    assert_near(off, np.zeros(9), bound=1e-10 * length, why="a geodesic is straight in the flat")


def test_a_helix_like_directrix_too_wide_for_its_torsion_is_refused_with_the_largest_width() -> None:
    made = passage(GEODESIC | {"half_width": 4000})
    assert made.refused_by == "construct"
    assert made.codes("construct", fatal=True) == ["strap-too-wide"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"half_width": None}, "missing"),
        ({"half_width": -1}, "-1"),
        ({"q0": [0, 0, 5]}, "given beside directrix_geodesic = true"),
        ({"directrix_geodesic": False, **{k: v for k, v in EXAMPLE_2_PRINTED.items() if "_hat" in k or k[0] == "q"}},
         "not used without directrix_geodesic = true"),
    ],
)  # fmt: skip
def test_half_a_description_of_the_geodesic_surface_is_refused(change: Table, said: str) -> None:
    assert troubles({k: v for k, v in (GEODESIC | change).items() if v is not None}) == [said]


def test_without_a_second_directrix_or_a_width_every_missing_key_is_named() -> None:
    bare = {k: v for k, v in GEODESIC.items() if k not in ("directrix_geodesic", "half_width")}
    assert set(troubles(bare)) == {"missing"}


def test_a_geodesic_patch_cannot_start_a_strip_of_theorem_3_1() -> None:
    strip: Table = {"kind": "quintic-strip", "first": GEODESIC, "next": [NEXT_PATCH]}
    assert "no patch of Theorem 3.1" in troubles(strip)
