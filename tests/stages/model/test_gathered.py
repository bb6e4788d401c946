"""Figures of one blank from those of its faces."""

import pytest

from stages.model.gathered import Rule, gathered
from stages.model.report import Metric
from stages.unroll.branched import RULES


@pytest.mark.parametrize(
    ("rule", "value", "face"),
    [("largest", -3.0, 2), ("most", 2.0, 3), ("least", -3.0, 2), ("sum", 0.0, None), ("alike", None, 1)],
)
def test_the_value_that_stands_for_all_and_the_face_that_it_is_from(
    rule: Rule, value: float | None, face: int | None
) -> None:
    reports = [(Metric("x", one, where={"v": one}),) for one in (1.0, -3.0, 2.0)]
    (found,) = gathered(reports, (1, 2, 3), {"x": rule})
    assert found.value == value
    assert (found.where or {}).get("face") == face


def test_what_is_beyond_all_numbers_on_one_face_is_so_on_the_whole() -> None:
    reports = [(Metric("x", 1.0),), (Metric("x", None, where={"v": 0.5}),)]
    for rule in ("largest", "most"):
        (found,) = gathered(reports, (1, 2), {"x": rule})
        assert (found.value, found.where) == (None, {"v": 0.5, "face": 2})


@pytest.mark.parametrize("name", ["max_extension", "max_compression"])
def test_strain_of_a_blank_is_that_of_the_face_that_is_strained_most(name: str) -> None:
    """Each is positive where there is some: a face that is compressed everywhere has a negative extension."""
    reports = [(Metric(name, 1e-4),), (Metric(name, -3e-4),)]
    (found,) = gathered(reports, (1, 2), RULES)
    assert found.value == 1e-4
