"""The bands and panels of samples/cladding: areas that do not depend on how they are bent, and closed forms."""

from math import hypot, pi

import pytest

from tests.near import assert_relative
from tests.oracles import bezier, length
from tests.samples import LAST_DIGITS, assert_figures, figure, made, proved


@pytest.fixture(scope="module")
def cladding() -> dict[str, dict]:
    return made("cladding/job.toml")


def test_the_guard_band_is_a_straight_strip_as_long_as_the_rail(cladding: dict[str, dict]) -> None:
    """A geodesic unrolls to a line: both edges run parallel to it, 100 mm apart."""
    rail = float(length(bezier([(0, 0, 0), (500, 0, 0), (1000, 400, 150), (1300, 1200, 600)])))
    band = cladding["handrail-band"]
    assert_figures(band, {"area": 100.0 * rail})
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = band["flat"]["corners"]
    sides = [hypot(x3 - x0, y3 - y0), hypot(x2 - x1, y2 - y1)]
    edges = band["flat"]["edges"]
    assert_relative([edges["c0"], edges["c1"]], sides, bound=LAST_DIGITS, why="straight edges")
    assert_relative(sum(sides) / 2, rail, bound=LAST_DIGITS, why="the middle line of a trapezium")


def test_the_joint_band_has_its_width_times_the_length_of_its_curve(cladding: dict[str, dict]) -> None:
    """What a band gains on the outer side of a flat bend it loses on the inner one: half its width on either side."""
    curve = bezier([(0, 0, 0), (500, 0, 150), (900, 400, 300), (900, 900, 450)])
    assert_figures(cladding["joint-band"], {"area": 120 * length(curve)})


def test_the_swan_neck_is_a_straight_strip_along_the_papers_quintic(cladding: dict[str, dict]) -> None:
    """(2.2) with alpha = 800, beta = 0, k = 0.003: 5 (P1 - P0) = alpha T,  20 (P2 - 2 P1 + P0) = k alpha^2 N."""
    quintic = [(0, 0, 0), (160, 0, 0), (320, 96, 0), (504, 192.8, 110.4), (600, 346.4, 155.2), (600, 500, 200)]
    neck = cladding["swan-neck"]
    assert_figures(neck, {"area": 80 * length(bezier(quintic))})
    widest = figure(neck, "construct", "half_width_max_mm")["value"]
    assert widest > 40.0, "short of the edge of regression"


def test_the_normals_of_the_wall_are_square_to_the_joint(cladding: dict[str, dict]) -> None:
    assert figure(cladding["joint-band"], "construct", "normal_lean_deg")["value"] < 1e-9


def test_the_fascia_is_half_a_quarter_cone_a_rectangle_and_a_rolled_return(cladding: dict[str, dict]) -> None:
    """The middle of 1.5 mm sheet lies 0.75 mm inside the given face; the flat front is the same on both."""
    given = next(s for s in cladding["fascia"]["stages"] if s["stage"] == "unroll")["detail"]["given"]
    profile = bezier([(720, 800, 0), (720, 1000, 0), (600, 1120, 0)])

    def squeezed(v: object) -> object:
        """Seen along the rulings, x counts by the cosine 4 / 5 of its slope."""
        return tuple((row[0] * 4 / 5, row[1], row[2]) for row in profile(v))

    cone = pi / 4 * 720.0 * 1200.0 * 3 / 4
    area = cone + 800.0 * 600.0 + 600.0 * float(length(squeezed))
    c0 = pi / 2 * 720.0 + 800.0 + float(length(profile))
    c1 = pi / 2 * 360.0 + 800.0 + float(length(profile))
    reached = [given["area"], given["edges"]["c0"], given["edges"]["c1"]]
    assert_relative(reached, [area, c0, c1], bound=LAST_DIGITS, why="closed forms and a quadrature")


def test_what_has_polynomial_or_rational_directrices_is_proved(cladding: dict[str, dict]) -> None:
    assert [name for name, part in cladding.items() if proved(part)] == ["fascia", "wave"]


def test_the_wave_is_a_rectangle_that_joins_with_equal_curvature(cladding: dict[str, dict]) -> None:
    wave = cladding["wave"]
    edges = wave["flat"]["edges"]
    assert_relative([edges["start"], edges["end"]], [500.0, 500.0], bound=LAST_DIGITS, why="given")
    assert_relative(edges["c0"], edges["c1"], bound=LAST_DIGITS, why="moved by the ruling")
    assert_figures(wave, {"area": 500.0 * edges["c0"]})
    assert edges["c0"] > 2 * hypot(300.0, 60.0) + 300.0, "no shorter than the chords between its points"
    for name in ("join_gap_mm", "join_curvature_jump"):
        assert abs(figure(wave, "construct", name)["value"]) <= LAST_DIGITS, name
