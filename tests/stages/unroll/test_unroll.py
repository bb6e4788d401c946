"""The stage: both sides' figures against closed forms and 40 digits, distortion, overlap, marks."""

from math import cos, hypot, pi, sin, sqrt

import numpy as np
import pytest

from stages.geometry.arrays import norm
from stages.geometry.curves.contours import area, length
from stages.geometry.paths import arcpath
from stages.model.material import Material
from stages.model.tolerances import Tolerances
from tests.near import assert_near, assert_relative
from tests.parts import (
    AUMANN_CUBIC,
    CIRCLE,
    EXAMPLE_1,
    EXAMPLE_2_CYLINDER,
    EXAMPLE_2_PRINTED,
    EXAMPLE_3_PRINTED,
    MITRED_CYLINDER,
    OBLIQUE_CONE,
    QUINTIC_TANGENT,
    RIGHT_FRUSTUM,
    Passage,
    Table,
    passage,
)

FIGURES: dict[str, tuple[Table, dict[str, float]]] = {
    "Example 1": (EXAMPLE_1, {
        "area": 299.0982744480111135262917, "c0": 78.21368602419299362810307, "c1": 78.27151246658052083249767,
        "start": 4.0, "end": 4.0}),
    "Example 2 with Theorem 2.2": (EXAMPLE_2_CYLINDER, {
        "area": 29.12631958208396768991467, "c0": 4.808642122342345763750665, "c1": 6.370289698009901640539394,
        "start": 4.0, "end": 8.0}),
    "Example 3, parameters as printed": (EXAMPLE_3_PRINTED, {
        "area": 1.049287164118616137652212, "c0": 0.6981826568098649691910658,
        "start": 3.015033061178600077872928, "end": 3.035772455241005048407345}),
    "quintic tangent surface": (QUINTIC_TANGENT, {
        "area": 90615.41598019627067006, "c0": 611.2023245308895471166, "c1": 841.9757386235023361029,
        "start": 226.1222014752200310799, "end": 289.0177330199654029526}),
    "Aumann's cubic": (AUMANN_CUBIC, {
        "area": 1.5545913608008169701, "c0": 3.8494137877600431961, "c1": 2.9298904565127888168}),
    "right frustum: pi (r0 + r1) s": (RIGHT_FRUSTUM, {
        "area": 4.5 * pi * hypot(1.5, 4), "c0": 6 * pi, "c1": 3 * pi, "start": hypot(1.5, 4), "end": hypot(1.5, 4)}),
    "cone to its apex: pi r s": (RIGHT_FRUSTUM | {"radius1": 0}, {
        "area": 15 * pi, "c0": 6 * pi, "start": 5.0, "end": 5.0}),
    "cone from its apex": (RIGHT_FRUSTUM | {"radius0": 0, "radius1": 3}, {
        "area": 15 * pi, "c1": 6 * pi, "start": 5.0, "end": 5.0}),
    "cylinder: 2 pi r h": ({"kind": "cone", "radius0": 2, "radius1": 2, "height": 7, "sweep": 360}, {
        "area": 28 * pi, "c0": 4 * pi, "c1": 4 * pi, "start": 7.0, "end": 7.0}),
    "mitred cylinder: half a pipe of 10": (MITRED_CYLINDER, {
        "area": 20 * pi, "c0": 4 * pi, "c1": 13.555835225403539582, "start": 5 + 2 / sqrt(3), "end": 5 + 2 / sqrt(3)}),
    "plane ring": (RIGHT_FRUSTUM | {"height": 0}, {
        "area": 6.75 * pi, "c0": 6 * pi, "c1": 3 * pi, "start": 1.5, "end": 1.5}),
    "rectangle": ({"kind": "ruled", "c0": {"line": [[0, 0, 0], [3, 0, 4]]}, "c1": {"line": [[0, 2, 0], [3, 2, 4]]}}, {
        "area": 10.0, "c0": 5.0, "c1": 5.0, "start": 2.0, "end": 2.0}),
}  # fmt: skip
"""Areas and lengths: closed forms, and quadratures of the stated integrals at 30 to 45 digits."""


@pytest.fixture(scope="module", params=FIGURES)
def made(request: pytest.FixtureRequest) -> tuple[Passage, dict[str, float]]:
    table, figures = FIGURES[request.param]
    return passage(table), figures


@pytest.mark.parametrize("side", ["surface", "flat"])
def test_areas_and_lengths_of_both_sides_are_the_known_ones(made: tuple[Passage, dict[str, float]], side: str) -> None:
    found, figures = made
    edges = found.side(side)["edges"]
    assert isinstance(edges, dict)
    for name, value in figures.items():
        reached = found.side(side)["area"] if name == "area" else edges[name]
        assert_relative([reached], [value], bound=1e-12, why=f"as asked: {name} of the {side}")


def test_an_isometry_is_measured_as_one(made: tuple[Passage, dict[str, float]]) -> None:
    found, _ = made
    for name, bound, why in (
        ("length_error", 1e-13, "two quadratures of 1e-14"),
        ("area_error", 1e-13, "two quadratures of 1e-14"),
        ("metric_error", 1e-10, "positions to 1e-14, over panels of 1/64, where the speed is 1/100 of the largest"),
        ("max_strain", 7e-10, "positions to 1e-14, over panels of 1/64, where S_v is down to a thousandth"),
        ("angle_error_deg", 1e-6, "end slopes of 16 nodes: 1e-14 of 78 mm, times 256, over a slope of 2 mm per 1/64"),
        ("overlap_mm2", 0.0, "none overlaps"),
    ):
        assert_near(found.value("unroll", name), 0.0, bound=bound, why=why)


def test_the_exact_outline_closes_and_encloses_the_area(made: tuple[Passage, dict[str, float]]) -> None:
    found, figures = made
    assert found.pattern is not None
    edges = found.pattern.outer.edges
    ends = [edge.at(np.array([0.0, 1.0])) for edge in edges]
    size = sqrt(figures["area"])
    for a, b in zip(ends, [*ends[1:], ends[0]], strict=True):
        assert_near(a[1], b[0], bound=1e-13 * 10 * size, why="each edge begins where the one before ends")
    assert_relative([area(edges)], [figures["area"]], bound=1e-12, why="Green's theorem on the edges the writer gets")
    flat = found.side("flat")
    assert_relative([length(edges)], [flat["outline_length"]], bound=1e-12, why="the same edges")


def test_the_pattern_lies_in_its_frame(made: tuple[Passage, dict[str, float]]) -> None:
    """c0(0) at the origin, the first ruling along +x, outline counter-clockwise, label inside."""
    found, figures = made
    assert found.pattern is not None
    corners = found.pattern.corners
    assert_near(corners[0], [0.0, 0.0], bound=1e-12, why="the origin")
    assert corners[1, 0] > 0.0
    assert_near(corners[1, 1], 0.0, bound=1e-12 * corners[1, 0], why="along x")
    path = found.pattern.outer.path
    assert arcpath.area(path) > 0.0
    low_x, low_y, high_x, high_y = arcpath.bounds(path)
    assert low_x < found.pattern.label_at[0] < high_x
    assert low_y < found.pattern.label_at[1] < high_y
    slack = found.pattern.outer.chord_mm * length(found.pattern.outer.edges)
    assert_near(arcpath.area(path), figures["area"], bound=slack, why="a strip as wide as the chord along the outline")


# Shapes


def test_a_frustum_has_the_corners_of_its_sector() -> None:
    """Sector angle 2 pi 1.5 / s, radii 2 s and s about (2 s, 0); c0 (the outer arc) leaves upwards."""
    s = hypot(1.5, 4.0)
    a = 2 * pi * 1.5 / s
    assert_near(a, 2.2061736491945124417, bound=1e-15, why="closed form at 20 digits")
    pattern = passage(RIGHT_FRUSTUM).pattern
    assert pattern is not None
    expected = [[0, 0], [s, 0], [2 * s - s * cos(a), s * sin(a)], [2 * s - 2 * s * cos(a), 2 * s * sin(a)]]
    assert_near(pattern.corners, expected, bound=1e-13, why="1e-14 of 8 mm")


@pytest.mark.parametrize("sweep", [1, 90, 359])
@pytest.mark.parametrize("unit", [1e-1, 1.0, 1e3])
def test_part_of_a_cylinder_is_a_rectangle_from_a_millimetre_to_ten_metres(sweep: int, unit: float) -> None:
    table = {"kind": "cone", "radius0": 2 * unit, "radius1": 2 * unit, "height": 9 * unit, "sweep": sweep}
    found = passage(table)
    width = np.radians(sweep) * 2 * unit
    assert_relative([found.side("flat")["area"]], [width * 9 * unit], bound=1e-12, why="closed form")
    assert found.pattern is not None
    expected = np.array([[0, 0], [9 * unit, 0], [9 * unit, width], [0, width]])
    assert_near(found.pattern.corners, expected, bound=1e-13 * 15 * unit, why="1e-14 of the size")


def test_the_cut_contour_stays_within_its_chord() -> None:
    for chord in (0.5, 0.05, 0.005):
        pattern = passage(QUINTIC_TANGENT, Tolerances(chord_mm=chord)).pattern
        assert pattern is not None
        ring = arcpath.polygon(pattern.outer.path, accuracy=chord / 100)
        for edge in pattern.outer.edges:
            points = edge.at(np.linspace(0.0, 1.0, 41))
            following = np.roll(ring, -1, axis=0)
            step = following - ring
            along = np.einsum("pij,ij->pi", points[:, None] - ring, step) / np.maximum((step**2).sum(axis=1), 1e-300)
            foot = ring + np.clip(along, 0.0, 1.0)[..., None] * step
            away = norm(points[:, None] - foot).min(axis=1).max()
            assert away <= 1.01 * chord


# Distortion and refusals


def test_example_2_as_printed_is_of_class_metal_with_the_least_strain_it_can_have() -> None:
    """Along the rulings its ends would be strained by 1 - cos(W / 2) at least: 4.1e-4.  Least strain: 6.2e-5."""
    found = passage(EXAMPLE_2_PRINTED, Tolerances(accept="metal"))
    assert found.refused_by is None
    half = np.radians(3.2849872165410023) / 2.0
    strain = found.value("unroll", "max_strain")
    assert isinstance(strain, float)
    assert_relative([strain], [6.2e-5], bound=0.02, why="two digits are known")
    assert strain < (1.0 - cos(half)) / 6.0
    assert found.value("unroll", "strain_rms") < strain / 2.0
    assert found.value("unroll", "flattening_error") <= 1e-7
    assert passage(EXAMPLE_2_PRINTED).refused_by == "verify"


def long_saddle(warp_deg: float) -> Table:
    """Return a strip ten times as long as wide, of that warp in the middle, where it is as good as a helicoid."""
    rise = 1000.0 * np.tan(np.radians(warp_deg) / 2.0)
    return {
        "kind": "ruled",
        "c0": {"bezier": [[-1000, -100, rise], [1000, -100, -rise]]},
        "c1": {"bezier": [[-1000, 100, -rise], [1000, 100, rise]]},
    }


@pytest.mark.parametrize("warp_deg", [0.1, 3.0])
def test_a_long_twisted_strip_is_strained_by_a_twelfth_of_its_warp_squared(warp_deg: float) -> None:
    """An edge at distance w/2 of a strip twisted by k a length is longer by k2 w2 / 8; the middle of all, by a third.

    What is left is k2 w2 / 12, and the warp across is k w.
    """
    found = passage(long_saddle(warp_deg), Tolerances(accept="leather"))
    expected = np.radians(warp_deg) ** 2 / 12.0
    assert_relative([found.value("unroll", "max_strain")], [expected], bound=0.02, why="twist falls off along x, W4")


@pytest.mark.parametrize(("warp_deg", "refused_by"), [(6.0, None), (6.6, "unroll"), (8.1, "verify")])
def test_a_part_whose_strain_is_worse_than_its_warp_is_refused_by_unroll(
    warp_deg: float, refused_by: str | None
) -> None:
    """W2 / 12 passes 1e-3 at W = 6.28 deg, the warp of class metal ends at 8."""
    found = passage(long_saddle(warp_deg), Tolerances(accept="metal"))
    assert found.refused_by == refused_by
    if refused_by == "unroll":
        assert found.codes("unroll", fatal=True) == ["strain"]


def test_a_sector_beyond_a_full_turn_overlaps_itself_and_is_refused_with_the_area() -> None:
    """A polyline cone of eight triangles of 62 deg each at the apex: 496 deg; the last 136 deg cover twice."""
    zigzag = [[10, 0, 0], [5, 5, 8], [0, 10, 0], [-5, 5, -8], [-10, 0, 0], [-5, -5, 8], [0, -10, 0], [5, -5, -8],
              [10, 0, 0]]  # fmt: skip
    found = passage({"kind": "cone", "apex": [0, 0, 0], "directrix": {"polyline": zigzag}})
    assert found.refused_by == "unroll"
    assert found.codes("unroll") == ["flat-overlap"]
    angle = np.degrees(np.arccos(50.0 / (10.0 * sqrt(114.0))))
    assert_relative([found.value("verify", "turn_deg")], [8 * angle], bound=1e-12, why="eight triangles")
    triangle = 0.5 * 10.0 * sqrt(114.0) * np.sin(np.radians(angle))
    overlap = found.value("unroll", "overlap_mm2")
    assert 1.5 * triangle < overlap < 3 * triangle, "136 deg of 496 are two of eight triangles and a bit"


@pytest.mark.parametrize("where", ["outline", "hole"])
def test_a_plate_with_a_contour_across_itself_is_refused(where: str) -> None:
    bow = [[0, 0], [10, 10], [10, 0], [0, 15], [0, 0]]
    frame = [[-50, -50], [50, -50], [50, 50], [-50, 50], [-50, -50]]
    table = {"kind": "flat", "outline": {"polyline": bow if where == "outline" else frame}}
    found = passage(table | ({"holes": [{"polyline": bow}]} if where == "hole" else {}))
    assert found.refused_by == "unroll"
    assert found.codes("unroll") == ["contour-crosses-itself"]
    # the lines cross at 6 mm: lobes of 6 * 15 / 2 and 4 * 10 / 2 mm2, and the smaller one is inside out
    assert_near(found.value("unroll", "overlap_mm2"), 20.0, bound=1e-12, why="closed form")
    assert found.metric("unroll", "overlap_mm2").evidence == "sampled", "only that nothing overlaps is proved"
    plain = passage({"kind": "flat", "outline": {"polyline": frame}})
    assert plain.metric("unroll", "overlap_mm2").evidence == "proved"


@pytest.mark.parametrize(
    ("holes", "code"),
    [
        ([{"circle": {"center": [90, 0], "radius": 20}}], "hole-outside"),
        ([{"circle": {"center": [0, 0], "radius": 9}}, {"circle": {"center": [10, 0], "radius": 9}}], "holes-cross"),
    ],
)
def test_holes_outside_or_across_each_other_are_refused(holes: list[Table], code: str) -> None:
    frame = {"polyline": [[-100, -50], [100, -50], [100, 50], [-100, 50], [-100, -50]]}
    found = passage({"kind": "flat", "outline": frame, "holes": holes})
    assert code in found.codes("unroll", fatal=True)


def test_a_plate_keeps_its_figures() -> None:
    outline_ = {"chain": [{"line": [[0, 0], [40, 0]]}, {"arc": {"center": [40, 10], "radius": 10, "start": -90,
                "end": 90}}, {"polyline": [[40, 20], [0, 20], [0, 0]]}]}  # fmt: skip
    found = passage({"kind": "flat", "outline": outline_, "holes": [{"circle": {"center": [40, 10], "radius": 4}}]})
    flat = found.side("flat")
    assert_relative([flat["area"]], [800 + 50 * pi - 16 * pi], bound=1e-12, why="closed form")
    assert_relative([flat["outline_length"]], [100 + 10 * pi], bound=1e-12, why="closed form")
    assert_near([flat["width"], flat["height"]], [50, 20], bound=1e-12, why="closed form")
    (hole,) = flat["holes"]
    assert_relative([hole["area"], hole["x"], hole["y"]], [16 * pi, 40.0, 10.0], bound=1e-12, why="closed form")
    assert found.reports["unroll"].metric("metric_error").value == 0.0


# Marks


# What is handed on


def test_the_pattern_carries_what_nesting_and_writing_need() -> None:
    material = Material(thickness_mm=2.0, density_kg_m3=7850.0)
    pattern = passage(OBLIQUE_CONE, material=material, quantity=3, rotations=[0, 90]).pattern
    assert pattern is not None
    assert (pattern.part, pattern.quantity, pattern.rotations) == ("part", 3, (0.0, 90.0))
    assert (pattern.thickness_mm, pattern.density_kg_m3) == (2.0, 7850.0)
    with pytest.raises(ValueError, match="read-only"):
        pattern.corners[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        pattern.outer.path.vertices[0] = 1.0


def test_the_same_part_gives_the_same_numbers_to_the_last_bit() -> None:
    first, second = passage(QUINTIC_TANGENT), passage(QUINTIC_TANGENT)
    assert first.pattern is not None
    assert second.pattern is not None
    assert first.reports == second.reports
    assert first.pattern.outer.path.vertices.tobytes() == second.pattern.outer.path.vertices.tobytes()


def test_a_circle_s_seam_does_not_change_the_area() -> None:
    turned = {"arc": {"center": [0, 0, 0], "radius": 2, "start": 37, "end": 397}}
    areas = [passage(OBLIQUE_CONE | {"directrix": curve}).side("flat")["area"] for curve in (CIRCLE, turned)]
    assert_relative([areas[1]], [areas[0]], bound=1e-12, why="one cone, cut elsewhere")
