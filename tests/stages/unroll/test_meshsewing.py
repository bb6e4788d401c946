"""Patterns of stretched meshes: kept lengths, sides of cuts, the strain field; and each of them wrong on purpose."""

from fractions import Fraction

import numpy as np
import pytest

from stages.construct import construct
from stages.geometry.curves import contours
from stages.model.scalars import Length
from stages.model.surface import Certificate, MeshSurface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.unroll.meshdistortion import strain_field
from stages.verify import verify
from tests.caps import RADIUS, cap, on_cap, part, pole_strain
from tests.meshes import square_saddle
from tests.near import assert_near

HALF = 0.35
TOL = Tolerances("leather", chord_mm=0.05)
CUT = tuple(on_cap(polar, 0.7) for polar in np.linspace(HALF, 0.02, 4))


def judged(**keys: object) -> Certificate:
    made = construct(part(cap(HALF, cells=24), **keys), TOL).product
    assert made is not None
    found = verify(made, TOL)
    assert found.product is not None, found.report.findings
    return found.product


@pytest.fixture(scope="module")
def sewn() -> Certificate:
    return judged(keep="outline", cuts=(CUT,))


def moved(certificate: Certificate, vertices: np.ndarray, by: np.ndarray) -> Certificate:
    flat = certificate.flat
    assert flat is not None
    positions = flat.positions.copy()
    positions[vertices] += by
    return Certificate(certificate.surface, "leather", proved=False, flat=flat.replace(positions=positions))


def test_kept_lengths_and_sides_of_cuts_are_as_long_as_they_should_be(sewn: Certificate) -> None:
    outcome = unroll(sewn, TOL)
    assert outcome.product is not None, outcome.report
    assert float(outcome.report.metric("kept_length_error").value or 0.0) <= 1e-12
    assert float(outcome.report.metric("overlap_mm2").value or 0.0) == 0.0
    # the sides are equal edge by edge along a zigzag; straightened they differ by its width times the strain's change
    assert float(outcome.report.metric("seam_difference_mm").value or 0.0) <= 0.1
    rim = 2.0 * np.pi * RADIUS * np.sin(HALF)
    legs = contours.length(outcome.product.outer.edges) - rim
    assert_near(legs, 2.0 * RADIUS * (HALF - 0.02), bound=0.04 * RADIUS * HALF, why="strain of the legs, edges of 3 mm")


def test_a_kept_length_stretched_by_a_millionth_is_found(sewn: Certificate) -> None:
    surface, flat = sewn.surface, sewn.flat
    assert isinstance(surface, MeshSurface)
    assert flat is not None
    a, b = surface.kept[7]
    wrong = unroll(moved(sewn, np.array([b]), 1e-6 * (flat.positions[b] - flat.positions[a])), TOL)
    metric = wrong.report.metric("kept_length_error")
    assert_near(float(metric.value or 0.0), 1e-6, bound=3e-7, why="its neighbour changes as well, by a cosine of it")
    assert not metric.passed
    assert wrong.product is None
    assert metric.where is not None


def test_a_side_of_a_cut_that_is_longer_shows(sewn: Certificate) -> None:
    surface, flat = sewn.surface, sewn.flat
    assert isinstance(surface, MeshSurface)
    assert flat is not None
    ((one, _),) = surface.slits
    along = flat.positions[one[0]] - flat.positions[one[-1]]
    wrong = unroll(moved(sewn, one[:1], 0.5 * along / np.linalg.norm(along)), TOL)
    right = unroll(sewn, TOL)
    change = [float(outcome.report.metric("seam_difference_mm").value or 0.0) for outcome in (right, wrong)]
    assert_near(change[1], 0.5, bound=change[0] + 0.02, why="the mouth moved by half a millimetre")


def test_the_strain_field_is_that_of_the_closed_form() -> None:
    certificate = judged()
    surface, flat = certificate.surface, certificate.flat
    assert isinstance(surface, MeshSurface)
    assert flat is not None
    field = {name: np.array(column) for name, column in strain_field(surface, flat).items()}
    assert 100 <= len(field["x"]) <= 2000
    middle = np.array([field["x"], field["y"]]).T - flat.positions.mean(axis=0)
    at = int(np.argmin(np.linalg.norm(middle, axis=1)))
    wanted = pole_strain(HALF)
    # off the pole by some mm of 35, over which the strain falls by the square of that share; triangles of 1/12 besides
    for name in ("most", "least"):
        assert_near(float(field[name][at]), wanted, bound=0.15 * abs(wanted), why=name)
    rim = np.linalg.norm(middle, axis=1) > 0.85 * np.linalg.norm(middle, axis=1).max()
    turn = np.degrees(np.arctan2(middle[rim, 1], middle[rim, 0]))
    off = np.abs((field["direction_deg"][rim] - turn) % 180.0 - 90.0)
    assert float(np.median(off)) <= 5.0, "a rim is stretched along itself"


def test_the_extremes_are_told_with_their_places() -> None:
    certificate = judged()
    report = unroll(certificate, TOL).report
    longest, shortest = (report.metric(name).where or {} for name in ("max_extension", "max_compression"))
    assert np.hypot(float(longest["x"]), float(longest["y"])) >= 0.8 * RADIUS * np.sin(HALF), "hoops of the rim"
    assert np.hypot(float(shortest["x"]), float(shortest["y"])) <= RADIUS * np.sin(HALF)
    assert {"flat_x", "flat_y"} <= set(longest)


def _nearest(vertices: np.ndarray, place: np.ndarray) -> np.ndarray:
    return vertices[int(np.argmin(np.linalg.norm(vertices[:, :2] - place, axis=1)))]


def test_a_cut_in_a_saddle_overlaps_and_a_gusset_is_asked_for() -> None:
    mesh = square_saddle(45.0, 2, 20)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle = (low + high)[:2] / 2.0
    edge, middle = (_nearest(mesh.vertices, place) for place in (np.array([low[0], middle[1]]), middle))
    cut = tuple(tuple(Length(Fraction(float(x))) for x in place) for place in (edge, middle))
    made = construct(part(mesh, cuts=(cut,)), TOL).product
    assert made is not None
    found = verify(made, TOL)
    assert found.product is not None, found.report.findings
    outcome = unroll(found.product, TOL)
    assert outcome.product is None
    (finding,) = (one for one in outcome.report.findings if one.fatal)
    assert finding.code == "flat-overlap"
    assert "gusset" in finding.message
