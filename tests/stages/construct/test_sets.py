"""Elbows: gores as blanks, mitre ellipses and areas in closed form, edges that meet in space, seams of one length."""

from itertools import pairwise

import numpy as np
import pytest
from mpmath import ellipe, mp, mpf

from stages.construct import construct
from stages.construct.sets import Edges, Seam, parts_of, seams_of
from stages.geometry.arrays import EPS
from stages.geometry.ruled.ruled import RuledPatch
from stages.model.material import Part
from stages.model.surface import RuledSurface
from stages.unroll import unroll
from stages.verify import verify
from tests.near import assert_near, assert_relative
from tests.parts import DEFAULT, RIGHT_FRUSTUM, Table, part, troubles

ELBOW: Table = {"kind": "elbow", "diameter": 200, "angle": 90, "gores": 5, "bend_radius": 300}
SHORT: Table = {"kind": "elbow", "diameter": 2, "angle": 37.5, "gores": 2, "bend_radius": 1.25, "seam": "heel"}
LONG: Table = {"kind": "elbow", "diameter": 813, "angle": 180, "gores": 4, "bend_radius": 9000, "seam": "throat"}
EVERY = pytest.mark.parametrize("table", [ELBOW, SHORT, LONG])


def gore_patches(table: Table) -> list[RuledPatch]:
    made = [construct(blank, DEFAULT).product for blank in parts_of(part(table))]
    return [surface.patches[0] for surface in made if isinstance(surface, RuledSurface)]


def mitre(table: Table) -> mpf:
    return mp.radians(mpf(str(table["angle"]))) / (2 * (int(str(table["gores"])) - 1))


def flat(blank: Part) -> dict[str, object]:
    """Return the figures of a blank's flat pattern."""
    surface = construct(blank, DEFAULT).product
    assert surface is not None
    certificate = verify(surface, DEFAULT).product
    assert certificate is not None and certificate.reached == "exact"
    figures = unroll(certificate, DEFAULT).report.detail["flat"]
    assert isinstance(figures, dict)
    return figures


def test_a_part_of_one_blank_stays_itself_and_has_no_seams() -> None:
    whole = part(RIGHT_FRUSTUM)
    assert parts_of(whole) == (whole,)
    assert seams_of(whole) == ()


def test_gores_are_named_and_numbered_and_each_is_welded_to_the_next() -> None:
    elbow = part(ELBOW | {"gores": 3}, quantity=4)
    assert [blank.name for blank in parts_of(elbow)] == ["part.1", "part.2", "part.3"]
    assert {blank.spec.quantity for blank in parts_of(elbow)} == {4}
    assert seams_of(elbow) == (
        Seam(Edges("part.1", ("c1",)), Edges("part.2", ("c0",))),
        Seam(Edges("part.2", ("c1",)), Edges("part.3", ("c0",))),
    )


@EVERY
def test_flat_gores_have_the_edges_and_areas_of_their_closed_forms(table: Table) -> None:
    radius, turn = mpf(str(table["diameter"])) / 2, mitre(table)
    circle, ellipse = 2 * mp.pi * radius, 4 * radius / mp.cos(turn) * ellipe(mp.sin(turn) ** 2)
    half = circle * mpf(str(table["bend_radius"])) * mp.tan(turn)
    blanks = parts_of(part(table))
    for k, blank in enumerate(blanks):
        figures = flat(blank)
        ends = [k == 0, k == len(blanks) - 1]
        wanted = [float(circle if end else ellipse) for end in ends]
        edges = figures["edges"]
        assert isinstance(edges, dict)
        assert_relative([edges["c0"], edges["c1"]], wanted, bound=1e-13, why="circle, and ellipse of the mitre plane")
        area = float(half if any(ends) else 2 * half)
        assert_relative(figures["area"], area, bound=1e-13, why="circumference times the length of the axis")


@EVERY
def test_the_seam_is_in_the_throat_or_at_the_heel_as_asked(table: Table) -> None:
    diameter, bend = float(str(table["diameter"])), float(str(table["bend_radius"]))
    sorts = {"throat": [-1.0, -1.0], "heel": [1.0, 1.0], "staggered": [-1.0, 1.0]}[str(table.get("seam", "staggered"))]
    made = gore_patches(table)
    for k, patch in enumerate(made):
        seam = float(np.linalg.norm(patch.p.jet(np.zeros(1), 0)[0]))
        whole = 1.0 if k in (0, len(made) - 1) else 2.0
        wanted = whole * (bend + sorts[k % 2] * diameter / 2.0) * float(mp.tan(mitre(table)))
        assert_relative(seam, wanted, bound=1e-13, why="distance from the bend's axis times tan(mitre)")


@EVERY
def test_edges_that_are_welded_together_are_one_curve_in_space(table: Table) -> None:
    v = np.linspace(0.0, 1.0, 9)
    step = 0.5 if table.get("seam", "staggered") == "staggered" else 0.0
    size = float(str(table["bend_radius"])) + float(str(table["diameter"]))
    for one, other in pairwise(gore_patches(table)):
        here, there = one.c1.jet(v, 0)[0], other.c0.jet((v + step) % 1.0, 0)[0]
        assert_near(here, there, bound=32 * EPS * size, why="two mitre planes in floats, a few roundings of the size")


@EVERY
def test_the_first_and_last_edge_are_circles_square_to_the_ends_of_the_bend(table: Table) -> None:
    made = gore_patches(table)
    bend, angle = float(str(table["bend_radius"])), np.radians(float(str(table["angle"])))
    v = np.linspace(0.0, 1.0, 9)
    size = bend + float(str(table["diameter"]))
    along = np.array([np.sin(angle), 0.0, np.cos(angle)])
    middle = bend * np.array([1.0 - np.cos(angle), 0.0, np.sin(angle)])
    assert_near(made[0].c0.jet(v, 0)[0][:, 2], np.zeros(9), bound=8 * EPS * size, why="the plane z = 0")
    off = (made[-1].c1.jet(v, 0)[0] - middle) @ along
    assert_near(off, np.zeros(9), bound=32 * EPS * size, why="the plane across the end of the bend")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"diameter": 0}, ["0"]),
        ({"angle": 0}, ["0 deg"]),
        ({"angle": 181}, ["181 deg"]),
        ({"angle": 180, "gores": 2}, ["2 gores for 180 deg"]),
        ({"bend_radius": 100}, ["100 mm"]),
    ],
)
def test_elbows_that_cannot_be_are_errors_of_the_job_file(change: Table, message: list[str]) -> None:
    assert troubles(ELBOW | change) == message


def test_a_hole_in_a_set_does_not_say_which_blank_is_meant() -> None:
    spec = part(ELBOW, hole=[{"kind": "drill", "at": [0.5, 0.5], "diameter": 5}]).spec
    assert [trouble.key for trouble in spec.troubles()] == ["hole"]
