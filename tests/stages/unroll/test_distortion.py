"""Every metric of the unroll: nothing on an honest map, closed forms on known distortions, the same after a motion."""

from fractions import Fraction
from math import asinh, atan, degrees, sqrt

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

from stages.geometry.arrays import EPS, Array, dot, norm
from stages.geometry.curves.curves import bezier
from stages.geometry.flat.development import develop
from stages.geometry.ruled.ruled import RuledPatch, between, end_normals, frames
from stages.model.tolerances import STRAIN_LIMIT
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    QUINTIC_TANGENT,
    Table,
    aumann,
    patches,
)
from tests.rewritten import UNEVEN, exchanged, raised, reparametrised, turned_around
from tests.stages.unroll.maps import (
    HONEST,
    PLATE,
    SHAPES,
    changed,
    deformed,
    distortion,
    linear,
    of,
    value,
    where,
)
from tests.strategies import aumann_pairs, motions, moved, scaled, scales

# An honest map


@pytest.mark.parametrize("name", SHAPES)
def test_an_honest_map_shows_nothing(name: str) -> None:
    found = distortion(of(SHAPES[name]))
    assert value(found, "metric_error") <= HONEST
    assert value(found, "max_strain") <= 10 * HONEST, "the frame of ruling and across: up to 1000 times, at its edge"
    assert value(found, "strain_rms") <= 1e-13
    assert max(value(found, "length_error"), value(found, "area_error")) <= 1e-13
    assert value(found, "angle_error_deg") <= degrees(1e-12)
    assert value(found, "flat_gap_mm") == 0.0


DEGREE = 18
STENCIL = np.round(2048.0 * (1.0 - np.cos(np.pi * np.arange(27) / 26.0))) / 4096.0
"""27 near-Chebyshev places of a panel, in 4096ths: their v are exact where the panel's ends are."""


def derivatives(ways: Array, places: Array) -> Array:
    """Return d/dt at places (n,) of ways (n, 27, 2) at the stencil: a least-squares polynomial, by another basis."""
    fit = np.linalg.pinv(chebyshev.chebvander(2.0 * STENCIL - 1.0, DEGREE))
    series = chebyshev.chebder(np.einsum("ks,nsc->knc", fit, ways), axis=0)
    slopes: Array = 2.0 * np.einsum("nk,knc->nc", chebyshev.chebvander(2.0 * places - 1.0, DEGREE - 1), series)
    return slopes


@pytest.mark.parametrize("name", SHAPES)
def test_the_metric_is_right_at_ten_thousand_places_by_another_differentiation(name: str) -> None:
    """E, F, G at random places, from the vectors of a panel; and within their rounding from absolute positions."""
    random, count = np.random.default_rng(7), 10_000
    (piece,) = of(SHAPES[name]).pieces
    index = random.integers(0, piece.breaks.size - 1, count)
    low, width = piece.breaks[index], np.diff(piece.breaks)[index]
    u, t = random.uniform(0.0, 1.0, count), random.uniform(0.0, 1.0, count)
    stencil = [axis.ravel() for axis in np.broadcast_arrays(u[:, None], low[:, None] + width[:, None] * STENCIL)]
    v0 = np.repeat(low, STENCIL.size)
    v = low + t * width
    c0_d1, c1_d1 = (curve.jet(v, 1)[1] for curve in (piece.patch.c0, piece.patch.c1))
    s_u, s_v = piece.patch.p.jet(v, 0)[0], (1.0 - u)[:, None] * c0_d1 + u[:, None] * c1_d1
    zero = np.zeros(count)
    f_u = piece.chords(zero, v, zero + 1.0, v)
    f_v = derivatives(piece.chords(stencil[0], v0, *stencil).reshape(count, -1, 2), t) / width[:, None]
    E, G = dot(s_u, s_u), np.maximum(dot(c0_d1, c0_d1), dot(c1_d1, c1_d1))
    errors = [
        (dot(f_u, f_u) - E) / E,
        (dot(f_u, f_v) - dot(s_u, s_v)) / np.sqrt(E * G),
        (dot(f_v, f_v) - dot(s_v, s_v)) / G,
    ]
    assert_near(np.abs(errors).max(), 0.0, bound=HONEST, why="as asked")
    places = piece.positions(*stencil).reshape(count, -1, 2)
    rounded = 300 * 8 * EPS * float(norm(places).max()) / (width * np.sqrt(G))
    away = norm(derivatives(places - places[:, :1], t) / width[:, None] - f_v) / np.sqrt(G)
    assert (away <= HONEST + rounded).all(), "8 roundings of a position, times the squared degree"


NEEDLE = ["0.001", "0.1"]


def needle(lean: str) -> Table:
    """A cylinder of some 10 by 0.01 mm whose ruling and edge differ by down to 4e-5 rad: where w is mostly rounding."""
    return aumann([[10, 0, lean], [f"-{lean}", "0.002", "-0.002"], ["0.003", "-0.003", "0.004"],
                   ["-0.004", "0.005", "-0.005"]], [0, 0, 0], "-0.25", "-0.25")  # fmt: skip


@pytest.mark.parametrize("lean", NEEDLE)
def test_a_needle_whose_rulings_run_nearly_along_its_edges_is_unrolled_like_any_other(lean: str) -> None:
    found = distortion(of(needle(lean)))
    assert value(found, "metric_error") <= HONEST
    assert value(found, "area_error") <= 1e-12


@pytest.mark.parametrize("lean", NEEDLE)
def test_a_part_on_which_no_strain_is_defined_is_not_told_to_have_none(lean: str) -> None:
    """Twice as wide as it should be, and leaning: at no node do ruling and edge enclose an angle worth the name."""
    found = distortion(changed(of(needle(lean)), linear([[1.0, 0.0], [0.0, 2.0]])))
    metrics = {metric.name: metric for metric in found.metrics}
    for name in ("max_strain", "max_extension", "max_compression", "max_area_strain", "strain_rms"):
        assert metrics[name].value is None
    assert metrics["max_strain"].limit == STRAIN_LIMIT["fabrication"]
    assert found.energy_mm2 is None
    assert value(found, "area_error") > 0.5, "it is seen all the same"


# Known distortions

DERIVED = 4 * 22**2 * EPS
"""What a derivative at 22 nodes is off by, relative: the square of their number, and four roundings of a vector."""


def test_a_linear_map_is_measured_by_its_singular_values() -> None:
    found = deformed([[1.003, 0.0], [0.0, 0.996]])
    for name, expected in (
        ("max_strain", 4e-3), ("max_extension", 3e-3), ("max_compression", 4e-3), ("area_error", 1.003 * 0.996 - 1.0),
        ("max_area_strain", 1.003 * 0.996 - 1.0), ("strain_rms", 5e-3 / sqrt(2.0)), ("length_error", 4e-3),
        ("metric_error", 1.0 - 0.996**2), ("angle_error_deg", 0.0),
    ):  # fmt: skip
        assert_near(value(found, name), abs(expected), bound=DERIVED, why=f"closed form of {name}")


@pytest.mark.parametrize("name", ["plane, singular end rulings", "cone to its apex", "elliptic cylinder"])
def test_what_lies_beside_an_apex_is_strained_and_has_energy_like_the_rest(name: str) -> None:
    """All is shrunk alike: the energy is that of the whole area, and the least compression is no zero of the apex."""
    found = distortion(changed(of(SHAPES[name]), linear([[0.997, 0.0], [0.0, 0.997]])))
    assert found.energy_mm2 is not None
    energy = 2.0 * 3e-3**2 * found.surface_area
    assert_relative(found.energy_mm2, energy, bound=2.0 * DERIVED / 3e-3, why="the square of a strain of 3e-3")
    assert_near(value(found, "max_extension"), -3e-3, bound=2e3 * DERIVED, why="two derivatives, up to 1000 times")


def test_an_extension_is_told_from_a_compression() -> None:
    larger, smaller = (deformed([[1.0 + a, 0.0], [0.0, 1.0 + a]]) for a in (1e-3, -1e-3))
    assert_near(value(larger, "max_extension"), 1e-3, bound=DERIVED, why="both ways")
    assert_near(
        value(larger, "max_compression"), -1e-3, bound=DERIVED, why="extended by as much even where it is least"
    )
    assert_near(value(smaller, "max_compression"), 1e-3, bound=DERIVED, why="both ways")


def test_a_mirrored_pattern_is_no_isometry_of_the_side_that_is_seen() -> None:
    """Every length, angle and area is right, and the part would come out as its mirror image."""
    found = deformed([[1.0, 0.0], [0.0, -1.0]])
    assert value(found, "metric_error") <= HONEST
    assert_near(value(found, "max_compression"), 2.0, bound=DERIVED, why="a stretch of -1")
    assert value(found, "area_error") > 1.0
    assert_near(value(found, "angle_error_deg"), 180.0, bound=1e-9, why="90 deg against -90")


@pytest.mark.parametrize("amount", [1e-3, 1e-8])
def test_a_shear_shows_as_strain_of_half_its_size(amount: float) -> None:
    found = distortion(changed(of(EXAMPLE_2_CYLINDER), linear([[1.0, amount], [0.0, 1.0]])))
    assert_near(value(found, "max_strain"), amount / 2.0, bound=amount**2 + 1e-11, why="1 +- amount / 2 to first order")


def test_a_pattern_that_only_leans_is_seen_by_the_angle_between_its_directions() -> None:
    """Lengths along and across the rulings kept, the angle between them changed by 1e-6: F and the corners tell."""
    found = deformed([[1.0, np.sin(1e-6)], [0.0, np.cos(1e-6)]])
    assert_near(value(found, "metric_error"), np.sin(1e-6), bound=DERIVED, why="F over sqrt(E G) is the sine")
    assert_near(value(found, "angle_error_deg"), degrees(1e-6), bound=1e-11, why="the same angle")
    assert value(found, "length_error") <= 1e-13


def test_rulings_bent_in_the_plane_are_measured_as_the_curves_they_are() -> None:
    """(x, y) -> (x, y + k x^2): area and the edges along v keep their size, both end rulings become parabolas."""
    k = 0.02
    found = distortion(changed(of(PLATE), lambda at: np.stack([at[:, 0], at[:, 1] + k * at[:, 0] ** 2], axis=1)))
    slope = 2.0 * k * 4.0
    parabola = (slope * sqrt(1.0 + slope**2) + asinh(slope)) / (4.0 * k)
    assert_near([found.flat.start, found.flat.end], [parabola, parabola], bound=DERIVED, why="closed form")
    assert_near([found.flat.c0, found.flat.c1], [3.0, 3.0], bound=DERIVED, why="moved as they are")
    assert_near(found.flat_area, 12.0, bound=DERIVED, why="a shear that varies keeps areas")
    assert_near(value(found, "max_area_strain"), 0.0, bound=DERIVED, why="at every place")
    assert_near(value(found, "angle_error_deg"), degrees(atan(slope)), bound=1e-10, why="at c1's corners")
    assert where(found, "length_error")["edge"] in {"start", "end"}
    assert where(found, "max_strain")["u"] == 1.0, "the parabola is steepest there"


def test_the_extremes_are_where_they_are() -> None:
    """x^2 / 1000 more along x: extended most at u = 1; x y / 1000 more along y: at u = 1 and the last v."""
    found = distortion(changed(of(PLATE), lambda at: at + np.stack([at[:, 0] ** 2, 0.0 * at[:, 1]], axis=1) / 1e3))
    assert_near(value(found, "max_extension"), 8e-3, bound=DERIVED, why="2 x / 1000 at x = 4")
    assert where(found, "max_extension")["u"] == 1.0
    twisted = distortion(
        changed(of(PLATE), lambda at: at + np.stack([0.0 * at[:, 0], at[:, 0] * at[:, 1]], axis=1) / 1e3)
    )
    assert where(twisted, "max_strain")["u"] == 1.0
    assert where(twisted, "max_strain")["v"] > 0.99


# Invariance


WARPED = EXAMPLE_2_PRINTED
SAME = {
    "the other way round": turned_around, "edges exchanged": exchanged, "a higher degree": raised,
    "another parameter": lambda patch: reparametrised(patch, UNEVEN),
}  # fmt: skip


@pytest.mark.parametrize("way", SAME)
def test_the_strain_of_a_warped_patch_does_not_depend_on_how_it_is_written(way: str) -> None:
    (patch,) = patches(WARPED)
    before, after = (distortion(develop((each,))) for each in (patch, SAME[way](patch)))
    for name in ("strain_rms", "area_error", "length_error"):
        assert_near(value(after, name), value(before, name), bound=1e-11, why=f"{name}: integrals over the same map")
    bound = 0.02 * value(before, "max_strain")
    assert_near(value(after, "max_strain"), value(before, "max_strain"), bound=bound, why="the nodes lie elsewhere")


@settings(max_examples=10, deadline=None)
@given(st.sampled_from([QUINTIC_TANGENT, AUMANN_CUBIC, EXAMPLE_2_PRINTED]), motions(), scales())
def test_motion_and_scale_change_no_metric(table: Table, motion: object, factor: object) -> None:
    (patch,) = patches(table)
    before, after = (distortion(develop((each,))) for each in (patch, scaled(moved(patch, motion), factor)))
    for name in ("metric_error", "max_strain", "strain_rms", "length_error", "area_error"):
        assert_near(value(after, name), value(before, name), bound=FAR, why="control points rounded at up to 1.7 m")


FAR = 1e-9
"""4 mm at 1.7 m from the origin: control points rounded to 2e-13 mm, 1e-13 of the part, times the degrees and 1000."""


def is_regular(patch: RuledPatch) -> bool:
    """Return whether the normals at both ends of every ruling are of one sign and nowhere short."""
    n0, n1 = end_normals(frames(patch, np.linspace(0.0, 1.0, 401)))
    longest = max(norm(n0).max(), norm(n1).max())
    return bool((dot(n0, n1) > 0.0).all() and min(norm(n0).min(), norm(n1).min()) > 1e-2 * longest)


@settings(
    max_examples=25, deadline=None, phases=(Phase.generate,), suppress_health_check=(HealthCheck.filter_too_much,)
)
@given(aumann_pairs())
def test_any_regular_developable_pair_is_unrolled_without_distortion(table: Table) -> None:
    c0, c1 = (bezier([[Fraction(x) for x in point] for point in table[key]["bezier"]]) for key in ("c0", "c1"))
    patch = between(c0, c1)
    assume(is_regular(patch))
    found = distortion(develop((patch,)))
    assert value(found, "metric_error") <= HONEST
    assert max(value(found, "length_error"), value(found, "area_error")) <= 1e-12
