"""Tables of parts: planes are told apart exactly, and no table changes once it is read."""

from collections.abc import Iterator
from fractions import Fraction
from importlib import import_module
from inspect import Parameter, signature
from pkgutil import iter_modules

import pytest

from stages import model
from stages.model.curves import Table
from stages.model.part import Plane

HERE = (Fraction(1), Fraction(2), Fraction(3))
NORMAL = (Fraction(2), Fraction(-3), Fraction(5))


@pytest.mark.parametrize("factor", [1, 7, -1, Fraction(-1, 3)])
def test_a_plane_is_the_same_from_any_of_its_points_whatever_the_length_and_sense_of_its_normal(
    factor: Fraction,
) -> None:
    x, y, z = HERE
    there = (x + 3 - 5, y + 2, z + 2)  # (3, 2, 0) and (-5, 0, 2) lie along the plane
    other = Plane(point=there, normal=tuple(factor * n for n in NORMAL))
    assert Plane(point=HERE, normal=NORMAL).is_same(other)


@pytest.mark.parametrize("axis", range(3))
def test_a_plane_that_is_shifted_or_turned_in_one_coordinate_is_another(axis: int) -> None:
    plane = Plane(point=HERE, normal=NORMAL)
    shifted = tuple(x + (k == axis) for k, x in enumerate(HERE))
    turned = tuple(n + (k == axis) * Fraction(1, 10**9) for k, n in enumerate(NORMAL))
    assert not plane.is_same(Plane(point=shifted, normal=NORMAL))
    assert not plane.is_same(Plane(point=HERE, normal=turned))


def tables(base: type[Table] = Table) -> Iterator[type[Table]]:
    for one in base.__subclasses__():
        yield one
        yield from tables(one)


def test_no_table_of_a_job_file_can_be_changed_or_made_by_the_order_of_its_fields() -> None:
    for module in iter_modules(model.__path__):
        import_module(f"{model.__name__}.{module.name}")
    assert [one.__name__ for one in tables() if not one.__struct_config__.frozen] == []
    kinds = {one.__name__: {given.kind for given in signature(one).parameters.values()} for one in tables()}
    assert [name for name, sorts in kinds.items() if not sorts <= {Parameter.KEYWORD_ONLY}] == []
