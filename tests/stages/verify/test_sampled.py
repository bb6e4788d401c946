"""Sampled figures against closed forms, and what is said of singular rulings where nothing can be proved."""

from dataclasses import replace
from fractions import Fraction
from math import atan, pi, sqrt

import numpy as np
import pytest

from stages.geometry.arrays import EPS
from stages.geometry.curves.curves import Circular
from stages.geometry.ruled.ruled import RuledPatch, between
from stages.model.surface import RuledSurface, whole_spans
from stages.verify import sampled
from stages.verify.bending import Sharpest, sharpest
from stages.verify.examined import examine
from stages.verify.findings import singular_findings
from tests.near import assert_near, assert_relative
from tests.parts import EXAMPLE_2_PRINTED, OBLIQUE_CONE, RIGHT_FRUSTUM, Table, part, patches

X, Y, Z = np.eye(3)
NONE = np.zeros(3)


def test_the_warp_of_example_2_is_that_of_40_digits() -> None:
    (patch,) = patches(EXAMPLE_2_PRINTED)
    warp = sampled.survey(patch, 0).warp
    assert_near(np.degrees(warp.value), 3.2849872165410022977, bound=1e-12, why="3 deg, dozens of roundings")
    assert_near(warp.v, 0.206364358832, bound=1e-7, why="the square root of rounding")


def helicoid(radius: float, height: float, turn: float) -> RuledPatch:
    """Return rulings from the axis z to the helix of that radius: |K| = (b / (b^2 + r^2))^2, b = height / turn."""
    rise = height / turn * Z
    return between(Circular(NONE, NONE, NONE, rise, 0.0, turn), Circular(NONE, radius * X, radius * Y, rise, 0.0, turn))


@pytest.mark.parametrize("turn", [0.5, 3.0, 12.0])
def test_a_helicoid_has_the_warp_and_curvature_of_its_closed_form(turn: float) -> None:
    """The normal (b sin, -b cos, r) turns by arctan(r / b) from the axis outwards; |K| is largest, 1 / b^2, there."""
    b = 7.0 / turn
    found = sampled.survey(helicoid(3.0, 7.0, turn), 4)
    assert_relative([found.warp.value, found.gaussian.value], [atan(3.0 / b), b**-2], bound=64 * EPS, why="closed form")
    assert_relative([found.ruling.value], [3.0], bound=16 * EPS, why="closed form")
    assert found.regular
    assert found.warp.piece == 4


def test_a_patch_without_any_normal_is_as_far_from_developable_as_can_be() -> None:
    """Both directrices run along one line, so that no ruling has a tangent plane: never "exact"."""
    line = Circular(NONE, X, NONE, NONE, 0.3, 1.0)
    found = sampled.survey(between(line, line.replace(U=2.0 * X)), 2)
    assert (found.warp.value, found.warp.piece) == (pi, 2)
    assert not found.regular
    assert found.normal.value == 0.0


def test_the_largest_curvature_of_a_frustum_is_at_its_smaller_end() -> None:
    (patch,) = patches(RIGHT_FRUSTUM)
    found = sampled.largest_curvature(patch, 0)
    assert found.u == 1.0
    assert_relative([found.value], [4.0 / (1.5 * sqrt(1.5**2 + 4.0**2))], bound=1e-12, why="closed form")


@pytest.mark.parametrize(("table", "regular"), [(OBLIQUE_CONE, True), (OBLIQUE_CONE | {"fraction": [0, 1]}, False)])
def test_an_apex_is_seen_and_its_absence_too(table: Table, regular: bool) -> None:
    assert sampled.survey(patches(table)[0], 0).regular is regular


@pytest.mark.parametrize(("last", "regular"), [(1e-3, True), (1e-9, False)])
def test_a_ruling_has_no_normal_if_it_is_nothing_beside_the_longest(last: float, regular: bool) -> None:
    """Rulings along z on an arc of radius 10, from 1 mm down to `last`: the normal is 10 times as long as they are."""
    shrinking = Circular(Z, NONE, NONE, (last - 1.0) * Z, 0.0, 1.0)
    arc = Circular(NONE, 10.0 * X, 10.0 * Y, NONE, 0.0, 1.0)
    found = sampled.survey(RuledPatch(arc, arc.replace(centre=Z, W=shrinking.W), shrinking), 0)
    assert found.regular is regular


def strip(profile: Circular) -> RuledSurface:
    """Return the cylinder along y over a curve in the plane of x and z."""
    patch = between(profile, profile.replace(centre=profile.centre + Y))
    return RuledSurface(part(EXAMPLE_2_PRINTED), (patch,), 10.0, whole_spans(1))


SINGULAR = {
    # x' = 1 - cos a stops at a = 2 pi and goes on; with z = cos a it is a cycloid, which turns back in a cusp
    "directrices-stop": (Circular(NONE, NONE, -X, X, 0.0, 4 * pi), False),
    "cusp": (Circular(NONE, Z, -X, X, 0.0, 4 * pi), True),
    # y turns with the profile: the edge runs along the ruling where x' = 0, and goes on or turns back
    "tangent-ruling": (Circular(NONE, NONE, -X, X + Y, 0.0, 4 * pi), False),
    "singular-ruling": (Circular(NONE, X, Y, NONE, -pi, 2 * pi), True),
}


@pytest.mark.parametrize("code", SINGULAR)
def test_singular_rulings_of_sampled_patches_are_named_for_what_they_are(code: str) -> None:
    profile, fatal = SINGULAR[code]
    surface = strip(profile)
    found = singular_findings(surface, [examine(patch, i) for i, patch in enumerate(surface.patches)])
    assert [(finding.code, finding.fatal) for finding in found] == [(code, fatal)]
    assert found[0].where is not None
    assert_near(found[0].where["v"], 0.5, bound=1e-5, why="where the middle normal is below 1e-6 of its size")


def test_a_regular_patch_has_no_singular_ruling() -> None:
    surface = strip(Circular(NONE, 3.0 * X, 2.0 * Z, NONE, 0.3, 5.0))
    assert singular_findings(surface, [examine(surface.patches[0], 0)]) == []


def test_the_turning_of_a_frustum_is_the_angle_of_its_sector() -> None:
    (patch,) = patches(RIGHT_FRUSTUM)
    assert_relative([abs(sampled.turning(patch))], [2 * pi * 1.5 / sqrt(1.5**2 + 16.0)], bound=1e-13, why="closed form")


def test_the_place_of_the_sharpest_bend_is_by_the_parts_v() -> None:
    """A face of a branched surface, whose v does not begin at 0, looked at without knowing how it turns."""
    quarter = Circular(NONE, 3.0 * X, 2.0 * Z, NONE, 0.0, pi / 2)
    surface = replace(strip(quarter), spans=((Fraction(7), Fraction(9)),))
    found = sharpest(surface, None)
    assert isinstance(found, Sharpest)
    assert_relative(
        [found.given_mm], [2.0**2 / 3.0], bound=1e-11, why="b^2 / a at the end of the long axis, to the search"
    )
    assert_near(found.where["v"], 7.0, bound=1e-6, why="an end, where the curvature is flat")
