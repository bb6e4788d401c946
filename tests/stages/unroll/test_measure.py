"""The measurement of distortion must see every fault of the map: planted ones, one by one."""

from collections.abc import Callable

import numpy as np
import pytest

from stages.geometry import development, quadrature
from stages.geometry.arrays import Array
from stages.geometry.development import Development, develop
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


def test_a_pattern_of_a_different_size_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = development.positions

    def larger(piece: object, u: Array, v: Array) -> Array:
        return honest(piece, u, v) * (1.0 + 1e-8)

    monkeypatch.setattr(measure, "positions", larger)
    monkeypatch.setattr(outline, "positions", larger)
    assert distortion(develop(patches(QUINTIC_TANGENT))) > SEEN


def sheared(amount: float) -> Callable[[object, Array, Array], Array]:
    honest = development.positions

    def positions(piece: object, u: Array, v: Array) -> Array:
        points = honest(piece, u, v)
        return points + amount * np.stack([points[:, 1], 0.0 * u], axis=1)

    return positions


@pytest.mark.parametrize("amount", [1e-3, 1e-8])
def test_a_shear_shows_as_strain_of_half_its_size(amount: float, monkeypatch: pytest.MonkeyPatch) -> None:
    (patch,) = patches(EXAMPLE_2_CYLINDER)
    made = develop((patch,))
    monkeypatch.setattr(measure, "positions", sheared(amount))
    strain = measure.largest_strain(made, [measure.at_nodes(made.pieces[0])]).value
    assert_near(strain, amount / 2.0, bound=amount**2 + 1e-10, why="singular values 1 +- amount / 2 to first order")


def test_a_pattern_that_only_leans_is_seen_by_the_angle_between_its_directions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lengths along and across the rulings kept, the angle between them changed by 1e-6: F alone tells."""
    made = develop(patches({"kind": "cone", "radius0": 2, "radius1": 2, "height": 3, "sweep": 90}))
    honest = development.positions

    def leaning(piece: object, u: Array, v: Array) -> Array:
        points = honest(piece, u, v)
        return points @ np.array([[1.0, 0.0], [np.sin(1e-6), np.cos(1e-6)]])

    monkeypatch.setattr(measure, "positions", leaning)
    found = measure.metric_error(made, [measure.at_nodes(made.pieces[0])]).value
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


def test_a_corner_angle_that_changes_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    (patch,) = patches(QUINTIC_TANGENT)
    made = develop((patch,))
    assert_near(measure.corner_angles(made, [measure.at_nodes(made.pieces[0])]), 0.0, bound=1e-9, why="end slopes")
    monkeypatch.setattr(measure, "positions", sheared(1e-3))
    assert measure.corner_angles(made, [measure.at_nodes(made.pieces[0])]) > 1e-5


def test_a_ruling_or_an_edge_of_no_length_has_no_angle() -> None:
    triangle = {"kind": "ruled", "c0": {"line": [[0, 0, 0], [3, 0, 0]]}, "c1": {"line": [[0, 0, 0], [3, 4, 0]]}}
    made = develop(patches(triangle))
    nodes = [measure.at_nodes(piece) for piece in made.pieces]
    assert_near(measure.corner_angles(made, nodes), 0.0, bound=1e-9, why="end slopes of the other corners")
