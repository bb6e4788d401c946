"""The measurement of distortion must see every fault of the map: planted ones, one by one."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from stages.geometry import development, quadrature
from stages.geometry.arrays import Array
from stages.geometry.development import develop
from stages.geometry.flatmap import Development, FlatPiece
from stages.geometry.ruled import RuledPatch
from stages.unroll import measure, outline
from tests.near import assert_near
from tests.parts import AUMANN_CUBIC, EXAMPLE_1, EXAMPLE_2_CYLINDER, OBLIQUE_CONE, QUINTIC_TANGENT, Table, patches

SEEN = 1e-9
"""A fault must show above this; an honest map stays below, also where the end rulings run along the edges."""
SHAPES: dict[str, Table] = {
    "tangent surface": QUINTIC_TANGENT, "aumann": AUMANN_CUBIC, "oblique cone": OBLIQUE_CONE,
    "cylinder": EXAMPLE_2_CYLINDER, "plane": EXAMPLE_1,
}  # fmt: skip


def distortion(made: Development) -> float:
    """Return the largest of metric, length, area error and strain of a map, all relative."""
    surfaces = tuple(piece.patch for piece in made.pieces)
    nodes = [measure.at_nodes(piece) for piece in made.pieces]
    corners = outline.corners(made)
    before, after = measure.surface_edges(surfaces), measure.flat_edges(nodes, corners)
    lengths = [abs(b / a - 1.0) for a, b in zip(before.values(), after.values(), strict=True)]
    area = abs(measure.flat_area(nodes, corners) / measure.surface_area(surfaces) - 1.0)
    found = measure.metric_error(made, nodes).value, measure.largest_strain(made, nodes).value
    return max(*lengths, area, *found)


@pytest.mark.parametrize("name", SHAPES)
def test_an_honest_map_shows_nothing(name: str) -> None:
    assert_near(distortion(develop(patches(SHAPES[name]))), 0.0, bound=SEEN / 1.5, why="1e-14 over 1/64 and 1e-3")


@pytest.mark.parametrize("name", ["tangent surface", "aumann", "oblique cone"])
@pytest.mark.parametrize("entry", [(0, 0), (1, 0), (0, 1), (2, 1), (1, 2), (3, 2), (2, 3), (5, 4), (4, 5)])
def test_one_wrong_entry_of_the_antiderivative_is_seen(
    name: str, entry: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = quadrature.ANTIDERIVATIVE.copy()
    wrong[entry] += 1e-3
    monkeypatch.setattr(development, "ANTIDERIVATIVE", wrong)
    assert distortion(develop(patches(SHAPES[name]))) > SEEN


@pytest.mark.parametrize("name", SHAPES)
def test_a_dropped_offset_of_a_panel_is_seen(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def dropped(local: Array, start: Array) -> Array:
        chained = honest(local, start)
        if local.shape[0] > 1:
            chained[-1, 0] -= local[:-1].sum(axis=(0, 1))
        return chained

    honest = development._chained
    (patch,) = patches(SHAPES[name])
    assert develop((patch,)).pieces[0].breaks.size > 2, "the test needs more than one panel"
    monkeypatch.setattr(development, "_chained", dropped)
    assert distortion(develop((patch,))) > SEEN


@pytest.mark.parametrize("name", ["tangent surface", "aumann", "oblique cone"])
@pytest.mark.parametrize("channel", [0, 1, 2])
def test_a_wrong_sign_or_a_small_wrong_factor_of_a_rate_is_seen(
    name: str, channel: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    honest = development._rates
    for factor in (-1.0, 1.0 + 1e-6):

        def wrong(patch: object, scale: float, v: Array, factor: float = factor) -> Array:
            rates = honest(patch, scale, v)
            rates[:, channel] *= factor
            return rates

        monkeypatch.setattr(development, "_rates", wrong)
        assert distortion(develop(patches(SHAPES[name]))) > SEEN


@dataclass(frozen=True, slots=True)
class Changed:
    """A flat map whose positions are changed by a function of the plane."""

    honest: FlatPiece
    change: Callable[[Array], Array]

    @property
    def patch(self) -> RuledPatch:
        return self.honest.patch

    @property
    def breaks(self) -> Array:
        return self.honest.breaks

    def positions(self, u: Array, v: Array) -> Array:
        return self.change(self.honest.positions(u, v))

    def velocities(self, u: Array, v: Array) -> Array:
        return self.honest.velocities(u, v)


def changed(made: Development, matrix: Array) -> Development:
    """Return the flat map followed by a linear map of the plane."""
    return Development(tuple(Changed(piece, lambda points: points @ matrix.T) for piece in made.pieces))


def test_a_pattern_of_a_different_size_is_seen() -> None:
    assert distortion(changed(develop(patches(QUINTIC_TANGENT)), (1.0 + 1e-8) * np.eye(2))) > SEEN


@pytest.mark.parametrize("amount", [1e-3, 1e-8])
def test_a_shear_shows_as_strain_of_half_its_size(amount: float) -> None:
    made = changed(develop(patches(EXAMPLE_2_CYLINDER)), np.array([[1.0, amount], [0.0, 1.0]]))
    strain = measure.largest_strain(made, [measure.at_nodes(made.pieces[0])]).value
    assert_near(strain, amount / 2.0, bound=amount**2 + 1e-10, why="singular values 1 +- amount / 2 to first order")


def test_a_pattern_that_only_leans_is_seen_by_the_angle_between_its_directions() -> None:
    """Lengths along and across the rulings kept, the angle between them changed by 1e-6: F alone tells."""
    made = develop(patches({"kind": "cone", "radius0": 2, "radius1": 2, "height": 3, "sweep": 90}))
    leaning = changed(made, np.array([[1.0, np.sin(1e-6)], [0.0, np.cos(1e-6)]]))
    found = measure.metric_error(leaning, [measure.at_nodes(leaning.pieces[0])]).value
    assert_near(found, np.sin(1e-6), bound=1e-11, why="F over sqrt(E G) is the sine")


def test_one_panel_out_of_place_is_seen_though_every_length_is_right() -> None:
    (patch,) = patches(EXAMPLE_1)
    made = develop((patch,))
    piece = made.pieces[0]
    assert piece.breaks.size > 4, "the test needs inner panels"
    shifted = piece.q.copy()
    shifted[1, 0] += 1e-6
    torn = Development((piece.replace(q=shifted),))
    nodes = [measure.at_nodes(p) for p in torn.pieces]
    corners = outline.corners(torn)
    lengths = measure.flat_edges(nodes, corners).values()
    assert_near(lengths, measure.surface_edges((patch,)).values(), bound=1e-11, why="moved, not stretched")
    assert measure.metric_error(torn, nodes).value > SEEN


def test_a_torn_pattern_shows_the_gap_between_its_pieces() -> None:
    from fractions import Fraction

    from stages.geometry.ruled import part

    (patch,) = patches(QUINTIC_TANGENT)
    halves = part(patch, Fraction(0), Fraction(1, 2)), part(patch, Fraction(1, 2), Fraction(1))
    made = develop(halves)
    assert_near(outline.piece_gap(made), 0.0, bound=1e-11, why="1e-14 of 840 mm")
    torn = Development((made.pieces[0], made.pieces[1].replace(q=made.pieces[1].q + np.eye(17)[0][:, None] * 0.25)))
    assert_near(outline.piece_gap(torn), 0.25 * 2**0.5, bound=1e-11, why="moved by a quarter in x and y")


def test_a_corner_angle_that_changes_is_seen() -> None:
    (patch,) = patches(QUINTIC_TANGENT)
    made = develop((patch,))
    assert_near(measure.corner_angles(made, [measure.at_nodes(made.pieces[0])]), 0.0, bound=1e-9, why="end slopes")
    sheared = changed(made, np.array([[1.0, 1e-3], [0.0, 1.0]]))
    assert measure.corner_angles(sheared, [measure.at_nodes(piece) for piece in sheared.pieces]) > 1e-5


def test_a_ruling_or_an_edge_of_no_length_has_no_angle() -> None:
    triangle = {"kind": "ruled", "c0": {"line": [[0, 0, 0], [3, 0, 0]]}, "c1": {"line": [[0, 0, 0], [3, 4, 0]]}}
    made = develop(patches(triangle))
    nodes = [measure.at_nodes(piece) for piece in made.pieces]
    assert_near(measure.corner_angles(made, nodes), 0.0, bound=1e-9, why="end slopes of the other corners")
