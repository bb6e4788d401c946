"""The strain field of a flat map: closed form, against the map's own derivatives, and the classes it decides."""

import json

import numpy as np
import pytest

from stages.geometry.arrays import Array
from stages.geometry.flat.development import develop
from stages.geometry.flat.flatmap import Development
from stages.geometry.flat.relaxed import relaxed
from stages.geometry.flat.relaxedmap import RelaxedMap
from stages.geometry.flat.relaxedmap import principal as of_displacement
from stages.model.surface import RuledSurface, whole_spans
from stages.model.tolerances import Class, Tolerances, class_by_strain
from stages.unroll import strain
from stages.unroll.distortion import measure
from stages.unroll.strain import StrainField, as_detail, strain_field
from tests.near import assert_near, assert_relative
from tests.parts import EXAMPLE_2_PRINTED, OBLIQUE_CONE, RIGHT_FRUSTUM, part, patches
from tests.warped import CONE_AND_WARPED, POINTED, Strip, saddle


def surface(strip: Strip) -> RuledSurface:
    return RuledSurface(part(EXAMPLE_2_PRINTED), strip, 1.0, whole_spans(len(strip)))


def field(strip: Strip, made: Development) -> StrainField:
    return strain_field(surface(strip), made, 9, 32)


class Stretched:
    """A map of a plane square onto one that is stretched by 1 + a along the direction `turn`, by 1 + b across it."""

    def __init__(self, a: float, b: float, turn: float) -> None:
        (self.honest,) = develop(patches({"kind": "ruled", "c0": {"line": [[0, 0, 0], [0, 1, 0]]},
                                          "c1": {"line": [[1, 0, 0], [1, 1, 0]]}})).pieces  # fmt: skip
        c, s = np.cos(turn), np.sin(turn)
        turned = np.array([[c, -s], [s, c]])
        self.matrix = turned @ np.diag([1.0 + a, 1.0 + b]) @ turned.T
        self.patch, self.breaks = self.honest.patch, self.honest.breaks

    def positions(self, u: Array, v: Array) -> Array:
        return self.honest.positions(u, v) @ self.matrix.T

    def chords(self, u0: Array, v0: Array, u: Array, v: Array) -> Array:
        return self.honest.chords(u0, v0, u, v) @ self.matrix.T

    def velocities(self, u: Array, v: Array) -> Array:
        return self.honest.velocities(u, v) @ self.matrix.T


@pytest.mark.parametrize(("a", "b"), [(0.02, -0.01), (1e-6, 0.0), (-1e-3, -3e-3)])
@pytest.mark.parametrize("turn", [0.0, 0.7, -1.2, np.pi / 2.0])
def test_an_even_stretch_has_its_strains_and_its_direction_everywhere(a: float, b: float, turn: float) -> None:
    piece = Stretched(a, b, turn)
    found = strain_field(surface((piece.patch,)), Development((piece,)), 5, 4)
    assert found.most.shape == (4, 5)
    assert_near(found.most, np.full((4, 5), a), bound=2e-13, why="derivatives at 20 nodes")
    assert_near(found.least, np.full((4, 5), b), bound=2e-13, why="derivatives at 20 nodes")
    off = np.sin(found.direction - turn)
    assert_near(off, np.zeros((4, 5)), bound=1e-12 / (a - b), why="derivatives over the difference of strains")


def test_the_energy_is_the_integral_of_both_squares_on_the_positions() -> None:
    """Of the unit square (a^2 + b^2); and twice what was made least, which is half of it."""
    piece = Stretched(0.02, -0.01, 0.7)
    found = measure(surface((piece.patch,)), Development((piece,)), Tolerances())
    assert_relative([found.energy_mm2], [0.02**2 + 0.01**2], bound=1e-10, why="strains of 1e-2 to 13 digits")
    strip = saddle(10.0)
    made = relaxed(strip, accuracy=1e-5)
    again = measure(surface(strip), made.development, Tolerances()).energy_mm2
    assert_relative([again], [2.0 * made.energy], bound=1e-6, why="another quadrature of the same map")


def test_the_same_stretch_every_way_has_no_direction() -> None:
    piece = Stretched(0.01, 0.01, 0.3)
    found = strain_field(surface((piece.patch,)), Development((piece,)), 3, 3)
    assert (found.direction == 0.0).all()


@pytest.mark.parametrize("strip", [saddle(10.0), CONE_AND_WARPED, patches(EXAMPLE_2_PRINTED)])
def test_the_field_measured_on_positions_is_that_of_the_displacement(strip: Strip) -> None:
    made = relaxed(strip, accuracy=1e-5).development
    found = field(strip, made)
    count = found.v.size // len(strip)
    for index, piece in enumerate(made.pieces):
        assert isinstance(piece, RelaxedMap)
        u, v = np.tile(found.u, count), np.repeat(np.linspace(0.0, 1.0, count), found.u.size)
        expected = of_displacement(piece, u, v)
        rows = slice(index * count, (index + 1) * count)
        most, least = found.most[rows].ravel(), found.least[rows].ravel()
        defined = np.isfinite(most) & (np.abs(expected).max(axis=1) > 0.0)
        assert defined.sum() > 0.8 * defined.size
        both = np.stack([most, least], axis=1)[defined]
        assert_near(both, expected[defined], bound=2e-10, why="derivatives of positions; 1e-13 over CLEAR")


def test_a_developable_part_has_no_strain_and_an_apex_no_number() -> None:
    for table in (OBLIQUE_CONE, RIGHT_FRUSTUM | {"radius1": 0}):
        strip = patches(table)
        found = field(strip, develop(strip))
        defined = np.isfinite(found.most)
        assert defined[:, :-1].all()
        assert np.abs(found.most[defined]).max() < 1e-11
        assert np.abs(found.least[defined]).max() < 1e-11
    assert not defined[:, -1].any()


def test_places_are_those_of_the_part_and_the_pattern() -> None:
    made = relaxed(CONE_AND_WARPED, accuracy=1e-3).development
    found = field(CONE_AND_WARPED, made)
    assert found.v[[0, 15, 16, 31]].tolist() == [0.0, 1.0, 1.0, 2.0]
    last = made.pieces[1].positions(found.u, np.ones(9))
    assert_near(np.stack([found.x[-1], found.y[-1]], axis=1), last, bound=0.0, why="the same positions")


def test_the_report_holds_lists_and_null_for_what_is_not_defined() -> None:
    detail = as_detail(field(POINTED, relaxed(POINTED, accuracy=1e-3).development))
    again = json.loads(json.dumps(detail, allow_nan=False))
    assert set(again) == {"u", "v", "x", "y", "most", "least", "direction_deg"}
    assert len(again["most"]) == len(again["v"]) == 32
    assert again["most"][-1] == [None] * 9
    assert None not in again["most"][0]


@pytest.mark.parametrize(
    ("strip", "expected", "along"),
    [(saddle(10.0), "leather", "leather"), (patches(EXAMPLE_2_PRINTED), "metal", "metal"),
     (saddle(7.0), "metal", "leather"), (saddle(0.7), "fabrication", "metal")],
)  # fmt: skip
def test_least_strain_decides_the_class(strip: Strip, expected: Class, along: Class) -> None:
    def reached(made: Development) -> Class | None:
        metrics = {metric.name: metric.value for metric in measure(surface(strip), made, Tolerances()).metrics}
        return class_by_strain(float(metrics["max_strain"]))

    assert reached(relaxed(strip, accuracy=1e-5).development) == expected
    assert reached(develop(strip)) == along


@pytest.mark.parametrize("fault", ["along", "across", "surface"])
def test_a_fault_in_the_measurement_is_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    honest = strain.slopes

    def wrong(*arguments: object) -> tuple[Array, Array]:
        by_u, by_v = honest(*arguments)
        if fault == "along":
            return by_u * (1.0 + 1e-9), by_v
        return (by_u, by_v * (1.0 + 1e-9)) if fault == "across" else (by_u, by_v + 1e-9 * by_u)

    monkeypatch.setattr(strain, "slopes", wrong)
    with pytest.raises(AssertionError):
        test_an_even_stretch_has_its_strains_and_its_direction_everywhere(0.02, -0.01, 0.7)
