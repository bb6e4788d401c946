"""The parts of samples/auger have their closed forms; those of polynomial curves are proved developable."""

from itertools import pairwise
from math import cos, hypot, pi, radians, sin, sqrt

import pytest

from tests.near import assert_near
from tests.oracles import area, bezier, length
from tests.samples import assert_figures, made, proved, stage


@pytest.fixture(scope="module")
def auger() -> dict[str, dict]:
    return made("auger/job.toml")


def test_the_flight_unrolls_to_a_ring(auger: dict[str, dict]) -> None:
    """The edge of regression keeps its curvature a / c^2 in the flat: a circle, the rulings its tangents."""
    a, rise = 50.0, 120.0 / (2 * pi)
    c = hypot(a, rise)
    circle, turned = c**2 / a, 2 * pi * a / c
    inner, outer = hypot(circle, 30.3955), hypot(circle, 122.6376)
    expected = {
        "c0": inner * turned,
        "c1": outer * turned,
        "start": 122.6376 - 30.3955,
        "area": turned * (outer**2 - inner**2) / 2,
    }
    assert_figures(auger["flight"], expected)


def test_the_flight_runs_from_the_tube_to_the_casing(auger: dict[str, dict]) -> None:
    """In space the ends of the tangents are as far from the axis as the comment in the job says."""
    cosine = 50.0 / hypot(50.0, 120.0 / (2 * pi))
    for distance, radius in ((30.3955, 57.5), (122.6376, 125.0)):
        assert_near(hypot(50.0, distance * cosine), radius, bound=1e-4, why="given to 0.1 um, leaning less than 2")
    first, second, *_ = auger["flight"]["flat"]["corners"]
    assert_near(second[0] - first[0], 122.6376 - 30.3955, bound=1e-9, why="the first ruling lies along x")


def test_the_flare_is_flat_sides_and_two_quarter_cones(auger: dict[str, dict]) -> None:
    """Rulings of 150 mm at 50 deg: each corner of 100 mm becomes a quarter of a frustum."""
    reach = 150.0 * cos(radians(50.0))
    straight, corners = 100.0 + 400.0 + 100.0, pi
    expected = {
        "area": 150.0 * (straight + corners * (100.0 + reach / 2)),
        "c0": straight + corners * 100.0,
        "c1": straight + corners * (100.0 + reach),
        "start": 150.0,
        "end": 150.0,
    }
    assert_figures(auger["flare"], expected)


def test_each_corner_of_the_flare_is_bent_by_what_its_normal_turns(auger: dict[str, dict]) -> None:
    """The normal of a quarter cone at 50 deg turns on a circle of its own: by 90 deg times the sine, 69 deg."""
    hits = [row["angle_deg"] for row in stage(auger["flare"], "unroll")["detail"]["bends"]]
    assert_near(sum(hits), 2 * 90.0 * sin(radians(50.0)), bound=1e-9, why="closed form")
    assert max(hits) <= 8.0


def test_the_visor_is_aumanns_pair_and_proved(auger: dict[str, dict]) -> None:
    """d_{i+1} = (6 c_{i+1} - 5 c_i + 4 d_i) / 5."""
    c = [(-300, 0, 0), (-280, 220, 20), (0, 330, 40), (280, 220, 20), (300, 0, 0)]
    d = [(-330.0, 20.0, 180.0)]
    for here, there in pairwise(c):
        d.append(tuple((6 * y - 5 * x + 4 * z) / 5 for x, y, z in zip(here, there, d[-1], strict=True)))
    edges = bezier(c), bezier(d)
    expected = {"area": area(*edges), "c0": length(edges[0]), "c1": length(edges[1])}
    assert_figures(auger["visor"], expected, "quadrature")
    assert proved(auger["visor"])


def test_the_spout_is_a_cone_over_a_parabola_and_proved(auger: dict[str, dict]) -> None:
    """Half of a cone: three quarters of its area; the lower edge is half the upper one."""
    upper = bezier([(-200, 0, 0), (0, 400, 0), (200, 0, 0)])
    apex = bezier([(0, 0, -600)] * 3)
    c0 = length(upper)
    expected = {"area": area(upper, apex) * 3 / 4, "c0": c0, "c1": c0 / 2, "start": sqrt(100.0**2 + 300.0**2)}
    assert_figures(auger["spout"], expected, "quadrature")
    assert proved(auger["spout"])
