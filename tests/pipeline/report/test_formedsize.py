"""The size of a formed part: where its edges reach furthest, not where they were sampled."""

from fractions import Fraction
from itertools import pairwise
from math import cos, radians, sin

import numpy as np
import pytest

from pipeline.report.formedsize import formed_entry
from stages.construct import construct
from stages.geometry.arrays import Array
from stages.geometry.curves.curves import Bezier, Circular, Curve, bezier, rational
from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.ruled.backwards import Backwards
from stages.geometry.ruled.ruled import at, between
from stages.model.surface import MeshSurface, RuledSurface, Surface, Trim, whole_spans
from stages.model.tolerances import Tolerances
from tests import caps
from tests.near import assert_near
from tests.parts import Table, part, passage

PLATE: Table = {"kind": "flat", "outline": {"polyline": [[0, 0], [30, 0], [30, 20], [0, 20], [0, 0]]}}
UP = np.array([0.0, 0.0, 1.0])


def told(surface: Surface) -> tuple[list[float], str]:
    """Return the size and its evidence."""
    entry = formed_entry(surface)
    assert entry is not None
    size = entry["size_mm"]
    assert isinstance(size, list)
    return size, str(entry["evidence"])


def strip_of(*rails: tuple[Curve, Curve], trim: Trim | None = None) -> RuledSurface:
    patches = tuple(between(*pair) for pair in rails)
    return RuledSurface(part(PLATE), patches, 1.0, whole_spans(len(patches)), trim=trim)


def dense(surface: RuledSurface) -> Array:
    """Return the size of what 20001 places of each directrix show."""
    v = np.linspace(0.0, 1.0, 20001)
    shown = np.concatenate([at(one, np.full_like(v, u), v) for one in surface.patches for u in (0.0, 1.0)])
    return np.asarray(np.ptp(shown, axis=0))


def arc(start: float, sweep: float, height: float, radius: float = 150.0) -> Circular:
    """Return an arc about z, degrees."""
    x, y = radius * np.eye(3)[0], radius * np.eye(3)[1]
    return Circular(height * UP, x, y, np.zeros(3), radians(start), radians(sweep))


@pytest.mark.parametrize("start", [0.0, 1.7, 33.0, -200.0])
@pytest.mark.parametrize("sweep", [360.0, -360.0])
def test_a_pipe_is_as_large_as_its_circle_wherever_its_seam_is(start: float, sweep: float) -> None:
    size, evidence = told(strip_of((arc(start, sweep, 0.0), arc(start, sweep, 40.0))))
    assert evidence == "proved"
    assert_near(size, (300.0, 300.0, 40.0), bound=1e-12, why="closed form")


def test_an_arc_that_ends_before_the_axis_is_as_large_as_its_chord() -> None:
    size, _ = told(strip_of((arc(10.0, 60.0, 0.0), arc(10.0, 60.0, 5.0))))
    x, y = (150.0 * abs(f(radians(70.0)) - f(radians(10.0))) for f in (cos, sin))
    assert_near(size, (x, y, 5.0), bound=1e-12, why="its ends")


def test_a_sloping_helix_turns_where_its_rise_meets_its_circle() -> None:
    """Along x it is 100 cos(a) + 30 a: highest where sin(a) = 0.3, in the last turn."""
    rise = np.array([30.0, 0.0, 0.0])
    helix = Circular(np.zeros(3), 100.0 * np.eye(3)[0], 100.0 * np.eye(3)[1], rise, 0.0, 4.0 * np.pi)
    turn = np.arcsin(0.3)
    top = 100.0 * np.cos(turn) + 30.0 * (turn + 2.0 * np.pi)
    end = 100.0 + 120.0 * np.pi
    low = -100.0 * np.cos(turn) + 30.0 * (np.pi - turn)
    size, evidence = told(strip_of((helix, helix)))
    assert evidence == "proved"
    assert_near(size[0], max(top, end) - low, bound=1e-12 * end, why="closed form")


def test_a_parabola_is_as_high_as_its_vertex() -> None:
    """z = 120 v - 180 v^2 is greatest at 1/3, where it is 20."""
    points = [[Fraction(0)] * 3, [Fraction(50), Fraction(0), Fraction(60)], [Fraction(100), Fraction(0), Fraction(-60)]]
    curve = bezier(points)
    size, evidence = told(strip_of((curve, curve)))
    assert evidence == "proved"
    assert_near(size, (100.0, 0.0, 80.0), bound=1e-12, why="closed form")


def test_a_rational_arc_of_120_degrees_reaches_its_radius() -> None:
    """The middle of its three points has the weight cos 60 = 1/2 and lies 2 high: the arc is highest there, at 1."""
    end, half, one, no = (
        Fraction(866025403784438646763723170752936183, 10**36),
        Fraction(1, 2),
        Fraction(1),
        Fraction(0),
    )
    curve = rational([[-end, no, half, one], [no, no, one, half], [end, no, half, one]])
    size, evidence = told(strip_of((curve, curve)))
    assert evidence == "proved"
    assert_near(size, (2.0 * float(end), 0.0, 0.5), bound=1e-14, why="radius 1, cos 60 = 1/2")


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 9])
@pytest.mark.parametrize("far", [0, 10**6])
def test_no_place_of_a_random_directrix_is_outside(degree: int, far: int) -> None:
    chosen = np.random.default_rng(degree)
    for _ in range(10):
        rows = [[Fraction(int(x)) + far for x in row] for row in chosen.integers(-99, 99, (degree + 1, 3))]
        weights = [Fraction(int(w), 10) for w in chosen.integers(3, 30, degree + 1)]
        weighted = rational([[*(x * w for x in row), w] for row, w in zip(rows, weights, strict=True)])
        for curve in (bezier(rows), weighted):
            surface = strip_of((curve, curve))
            size, evidence = told(surface)
            assert evidence == "proved"
            # places 5e-5 apart miss a vertex by half the square of half of that times the bend, some n^2 of the size
            bound = 0.5 * 2.5e-5**2 * 200.0 * degree**2 * 100.0 + 8e-16 * far
            assert_near(size, dense(surface), bound=bound, why="steps of the places")
            assert (np.array(size) >= dense(surface) - 4e-16 * far).all()


def test_any_other_edge_is_searched_and_said_to_be_sampled() -> None:
    size, evidence = told(strip_of((Backwards(arc(1.7, 360.0, 0.0)), Backwards(arc(1.7, 360.0, 40.0)))))
    assert evidence == "sampled"
    assert_near(size, (300.0, 300.0, 40.0), bound=300.0 * 1e-9, why="as the module says")


def test_a_trimmed_face_is_as_large_as_its_outline() -> None:
    """A disc of radius 0.3 of u and v on a plane of 100 x 70: an ellipse with these half axes."""
    face = strip_of(
        (bezier([[Fraction(0)] * 3, [Fraction(0), Fraction(70), Fraction(0)]]),
         bezier([[Fraction(100), Fraction(0), Fraction(0)], [Fraction(100), Fraction(70), Fraction(0)]])),
        trim=Trim((CircularArc(np.array([0.5, 0.5]), 0.3, 0.1, 2.0 * np.pi),)),
    )  # fmt: skip
    size, evidence = told(face)
    assert evidence == "sampled"
    assert_near(size, (60.0, 42.0, 0.0), bound=60.0 * 1e-9, why="as the module says")


def test_a_trim_across_patches_finds_the_ridge_between_them() -> None:
    """Two planes meet in a ridge at v = 1, 10 high; the outline crosses it on straight edges at no sample."""
    corners = [(0, 0), (37, 10), (80, 0)]

    def rail(i: int, x: int) -> Bezier:
        return bezier([[Fraction(x), Fraction(y), Fraction(z)] for y, z in corners[i : i + 2]])

    loop = np.array([[0.1, 0.3], [0.9, 0.3], [0.9, 1.6], [0.1, 1.6], [0.1, 0.3]])
    trim = Trim(tuple(Segment(a, b) for a, b in pairwise(loop)))
    size, _ = told(strip_of(*((rail(i, 0), rail(i, 50)) for i in (0, 1)), trim=trim))
    assert_near(size, (40.0, 37.0 * 0.7 + 43.0 * 0.6, 10.0 - 3.0), bound=50.0 * 1e-7, why="a kink is met to a step")


def test_a_mesh_is_its_vertices() -> None:
    made = construct(caps.part(caps.cap(0.4, cells=8)), Tolerances("leather")).product
    assert isinstance(made, MeshSurface)
    size, evidence = told(made)
    assert evidence == "proved"
    assert size == np.ptp(made.mesh.vertices, axis=0).tolist()


def test_a_plate_is_not_formed() -> None:
    plate = passage(PLATE).surface
    assert plate is not None
    assert formed_entry(plate) is None


def test_a_bow_of_a_job_is_as_wide_as_its_radius_says() -> None:
    """What 33 places of its arc showed as 299.92 mm is 300 mm."""
    bow = {"center": [0, 0, 0], "radius": 150, "normal": [1, 0, 0], "start": 7, "end": 353}
    table: Table = {"kind": "cylinder", "directrix": {"arc": bow}, "direction": [1, 0, 0], "length": 80}
    surface = passage(table).surface
    assert surface is not None
    wide = 150.0 * (1.0 + cos(radians(7.0)))
    assert_near(sorted(told(surface)[0]), (80.0, wide, 300.0), bound=1e-12, why="closed form")
