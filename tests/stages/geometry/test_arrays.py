"""Values that own arrays are read-only, checked, and stay so through a pickle."""

import copy
import pickle
from fractions import Fraction

import numpy as np
import pytest

from stages.geometry.arrays import (
    Array,
    ArrayValue,
    cross2,
    diagonal,
    dot,
    float_rows,
    floats,
    norm,
    similarities,
    unit,
)
from stages.geometry.curves.curves import Bezier, rational
from stages.geometry.curves.plane import CircularArc, Segment
from stages.geometry.curves.rigid import Rigid2
from stages.geometry.flat.development import develop
from stages.geometry.ruled.ruled import frames
from tests.near import assert_near
from tests.parts import EXAMPLE_1, MITRED_CYLINDER, RIGHT_FRUSTUM, patches

PATCH = patches(EXAMPLE_1)[0]
VALUES: dict[str, ArrayValue] = {
    "bezier": PATCH.c0,
    "rational": rational([[Fraction(1)] * 4] * 3),
    "circular": patches(RIGHT_FRUSTUM)[0].c0,
    "along": patches(MITRED_CYLINDER)[0].p,
    "patch": PATCH,
    "frames": frames(PATCH, np.linspace(0.0, 1.0, 3)),
    "flat piece": develop((PATCH,)).pieces[0],
    "segment": Segment(np.zeros(2), np.ones(2)),
    "arc": CircularArc(np.zeros(2), 1.0, 0.0, 1.0),
    "motion": Rigid2(1.0, 2.0, 3.0),
}


def arrays_of(value: object) -> list[Array]:
    """Return every array in a value and in the values it holds."""
    if isinstance(value, np.ndarray):
        return [value]
    if isinstance(value, ArrayValue):
        return [array for name in value.__dataclass_fields__ for array in arrays_of(getattr(value, name))]
    return []


@pytest.mark.parametrize("name", VALUES)
@pytest.mark.parametrize("through", [lambda v: v, lambda v: pickle.loads(pickle.dumps(v)), copy.copy, copy.deepcopy])
def test_no_array_of_a_value_can_be_written_to_even_after_a_pickle(name: str, through: object) -> None:
    value = through(VALUES[name])
    assert isinstance(value, ArrayValue)
    assert arrays_of(value) or name == "motion"
    for array in arrays_of(value):
        assert not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


@pytest.mark.parametrize("name", VALUES)
def test_no_field_of_a_value_can_be_set(name: str) -> None:
    field = next(iter(VALUES[name].__dataclass_fields__))
    with pytest.raises(AttributeError):
        setattr(VALUES[name], field, None)


def test_a_value_keeps_its_own_copy_of_an_array() -> None:
    mine = np.zeros(2)
    value = Segment(mine, np.ones(2))
    mine[0] = 7.0
    assert value.start[0] == 0.0


def test_a_pickle_runs_the_check_again() -> None:
    arc = CircularArc(np.zeros(2), 1.0, 0.0, 1.0)
    broken = pickle.dumps(arc).replace(np.float64(1.0).tobytes()[::-1], np.float64(-1.0).tobytes()[::-1])
    with pytest.raises(ValueError, match="radius"):
        pickle.loads(broken)


def test_a_bezier_curve_of_no_points_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one"):
        Bezier((), np.zeros((0, 3)))


def test_replacing_a_field_checks_the_new_value() -> None:
    with pytest.raises(ValueError, match="finite"):
        Rigid2().replace(x=np.inf)


def test_products_and_lengths_go_along_the_last_axis() -> None:
    a, b = np.arange(6.0).reshape(2, 3), np.ones((2, 3))
    assert dot(a, b).tolist() == [3.0, 12.0]
    assert_near(norm(a), np.sqrt([5.0, 50.0]), bound=1e-15, why="one rounding")
    assert cross2(np.array([[1.0, 2.0]]), np.array([[3.0, 5.0]])).tolist() == [-1.0]


def test_a_zero_vector_has_no_direction_and_stays_zero() -> None:
    assert unit(np.array([[3.0, 0.0, 4.0], [0.0, 0.0, 0.0]])).tolist() == [[0.6, 0.0, 0.8], [0.0, 0.0, 0.0]]


def test_the_diagonal_of_a_box_does_not_depend_on_where_it_lies() -> None:
    corners = np.array([[0.0, 0.0], [3.0, 1.0], [1.0, 4.0]])
    assert diagonal(corners) == diagonal(corners - 7.0) == 5.0


def test_similarities_add_up_to_the_singular_values() -> None:
    """Against numpy's, on matrices that turn, mirror, shear and flatten."""
    every = np.random.default_rng(3).normal(size=(50, 2, 2))
    every[0] = [[0.0, -2.0], [2.0, 0.0]]
    every[1] = [[1.0, 0.0], [0.0, -3.0]]
    every[2] = [[1.0, 2.0], [2.0, 4.0]]
    similar, mirrored = similarities(every[..., 0], every[..., 1])
    found = np.stack([similar + mirrored, np.abs(similar - mirrored)], axis=1)
    assert_near(found, np.linalg.svd(every)[1], bound=1e-14, why="some ten roundings of numbers up to 5")


def test_exact_numbers_are_rounded_once() -> None:
    """0.1 + 0.2 as fractions is 3/10, which is not the sum of two doubles."""
    tenth = Fraction(1, 10)
    assert floats(iter([tenth + 2 * tenth, Fraction(1, 3)])).tolist() == [0.3, 1 / 3]
    assert float_rows([[tenth + 2 * tenth], [Fraction(2)]]).tolist() == [[0.3], [2.0]]
    assert floats([]).shape == (0,)
