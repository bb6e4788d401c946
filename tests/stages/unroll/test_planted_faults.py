"""A flat map that is wrong must show it: for every metric of the unroll, faults as a program could have them."""

from math import degrees, sqrt

import pytest

from stages.geometry.arrays import Array
from stages.geometry.flat import development
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development
from stages.geometry.numeric import quadrature
from stages.geometry.numeric.quadrature import beginnings
from tests.near import assert_near
from tests.parts import EXAMPLE_1, QUINTIC_TANGENT, patches
from tests.rewritten import in_pieces
from tests.stages.unroll.maps import (
    FAULTY,
    HONEST,
    SEEN,
    SHAPES,
    Change,
    changed,
    distortion,
    linear,
    of,
    value,
    where,
)


@pytest.mark.parametrize("name", FAULTY)
@pytest.mark.parametrize("entry", [(0, 0), (1, 0), (0, 1), (2, 1), (1, 2), (3, 2), (2, 3), (5, 4), (4, 5), (16, 6)])
def test_one_wrong_entry_of_the_antiderivative_is_seen(
    name: str, entry: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = quadrature.ANTIDERIVATIVE.copy()
    wrong[entry] += 1e-3
    monkeypatch.setattr(development, "ANTIDERIVATIVE", wrong)
    assert value(distortion(of(SHAPES[name])), "metric_error") > SEEN


@pytest.mark.parametrize("name", [name for name in SHAPES if name not in {"cone from its apex"}])
@pytest.mark.parametrize("channels", [1, 2])
def test_a_dropped_offset_of_a_panel_is_seen(name: str, channels: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The last panel begins where the first one does, or with its angle."""

    def dropped(local: Array, start: Array) -> Array:
        begun = beginnings(local, start)
        if local.shape[2] == channels:
            begun[-1] = begun[0]
        return begun

    made = of(SHAPES[name]).pieces[0]
    turns = bool(made.phi[-1, 0] != made.phi[0, 0])
    assert made.breaks.size > 2, "the test needs more than one panel"
    monkeypatch.setattr(development, "beginnings", dropped)
    assert (value(distortion(of(SHAPES[name])), "metric_error") > SEEN) is (turns or channels == 2)


@pytest.mark.parametrize("name", FAULTY)
@pytest.mark.parametrize("channel", [0, 1, 2, 3, 4])
@pytest.mark.parametrize("factor", [-1.0, 1.0 + 1e-6])
def test_a_wrong_sign_or_a_small_wrong_factor_of_a_rate_is_seen(
    name: str, channel: int, factor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Channel 0 is phi': the angle that the rulings turn by."""
    honest = development._rates

    def wrong(patch: object, scale: float, v: Array) -> Array:
        rates = honest(patch, scale, v)
        rates[:, channel] *= factor
        return rates

    monkeypatch.setattr(development, "_rates", wrong)
    assert value(distortion(of(SHAPES[name])), "metric_error") > SEEN


WRONG: dict[str, Change] = {
    "larger": linear([[1.0 + 1e-8, 0.0], [0.0, 1.0 + 1e-8]]),
    "sheared": linear([[1.0, 1e-8], [0.0, 1.0]]),
    "bent": lambda points: points + 1e-12 * points**2,
}


@pytest.mark.parametrize("only", ["positions", "chords"])
@pytest.mark.parametrize("fault", WRONG)
def test_vectors_that_are_not_the_differences_of_positions_are_seen(fault: str, only: str) -> None:
    """The writer receives positions, the derivatives come from vectors: a fault of one alone is a fault."""
    made = of(QUINTIC_TANGENT)
    assert value(distortion(made), "metric_error") <= HONEST
    assert value(distortion(changed(made, WRONG[fault], only)), "metric_error") > HONEST


@pytest.mark.parametrize(
    "metric",
    ["length_error", "area_error", "angle_error_deg", "metric_error", "max_strain", "max_area_strain", "strain_rms"],
)
def test_each_metric_shows_a_pattern_that_is_stretched_across(metric: str) -> None:
    found = distortion(changed(of(QUINTIC_TANGENT), linear([[1.0, 0.0], [0.0, 1.0 + 1e-6]])))
    assert value(found, metric) > SEEN * 1e3


def test_one_panel_out_of_place_is_seen_though_every_length_is_right() -> None:
    piece = of(EXAMPLE_1).pieces[0]
    assert piece.breaks.size > 4, "the test needs inner panels"
    moved_away = piece.starts.copy()
    moved_away[1, 0] += 1e-9
    torn = distortion(Development((piece.replace(starts=moved_away),)))
    assert value(torn, "length_error") <= 1e-13, "moved, not stretched"
    assert value(torn, "metric_error") > SEEN


def test_a_torn_pattern_shows_the_gap_between_its_pieces() -> None:
    halves = in_pieces(patches(QUINTIC_TANGENT)[0], 2)
    made = develop(halves)
    assert_near(value(distortion(made), "flat_gap_mm"), 0.0, bound=1e-11, why="1e-14 of 840 mm")
    starts = made.pieces[1].starts.copy()
    starts[:, 0] += 0.25
    torn = Development((made.pieces[0], made.pieces[1].replace(starts=starts)))
    assert_near(value(distortion(torn), "flat_gap_mm"), 0.25 * sqrt(2.0), bound=1e-11, why="a quarter in x and y")


def test_a_corner_without_a_direction_has_no_angle() -> None:
    triangle = {"kind": "ruled", "c0": {"line": [[0, 0, 0], [3, 0, 0]]}, "c1": {"line": [[0, 0, 0], [3, 4, 0]]}}
    found = distortion(of(triangle))
    assert value(found, "angle_error_deg") <= degrees(1e-12)
    assert where(found, "angle_error_deg")["v"] == 1.0
