"""Texts that reach over the outline or a hole: boxes of known size on plates and discs."""

from math import hypot, pi

import numpy as np
import pytest

from stages.geometry.curves.plane import CircularArc
from stages.model.pattern import Contour, Text
from stages.unroll.outline import contour
from stages.unroll.texts import text_box, text_findings
from tests.near import assert_near
from tests.parts import RIGHT_FRUSTUM, passage
from tests.stages.unroll.test_onpart import hole, plate

EIGHT = "GUARD-17"
DISC: Contour = contour((CircularArc(np.zeros(2), 30.0, 0.0, 2.0 * pi),), 0.01, "disc")


def text(x: float, y: float, height: float, angle: float = 0.0) -> Text:
    return Text("number", EIGHT, np.array([x, y], dtype=np.float64), float(height), angle)


def codes(one: Text, outer: Contour, *inner: Contour) -> list[str]:
    return [finding.code for finding in text_findings([one], outer, inner)]


def test_the_box_is_one_height_a_letter_and_turns_with_the_text() -> None:
    assert_near(text_box(text(5, 6, 2)), [[-3, 5], [13, 5], [13, 7], [-3, 7]], bound=1e-12, why="8 letters of 2 mm")
    assert_near(text_box(text(0, 0, 2, 90.0))[0], [1.0, -8.0], bound=1e-12, why="a quarter turn")


@pytest.mark.parametrize("angle", [0.0, 33.0, 90.0, -120.0])
def test_on_a_disc_what_counts_is_the_diagonal(angle: float) -> None:
    """Half the diagonal is h / 2 sqrt(65): 30 mm at h = 7.442."""
    limit = 60.0 / hypot(8.0, 1.0)
    assert codes(text(0, 0, limit - 0.01, angle), DISC) == []
    (found,) = text_findings([text(0, 0, limit + 0.01, angle)], DISC, ())
    assert (found.code, found.fatal) == ("text-outside", False)
    assert f"a height of {limit:.3g}" in found.message


def test_a_text_over_a_hole_beside_it_around_it_or_in_it_is_told() -> None:
    assert codes(text(50, 30, 5), plate(), hole(50, 40, 7.4)) == []
    assert codes(text(50, 30, 5), plate(), hole(50, 40, 7.6)) == ["text-over-hole"]
    assert codes(text(50, 30, 5), plate(), hole(50, 30, 1)) == ["text-over-hole"]
    assert codes(text(50, 30, 1), plate(), hole(50, 30, 20)) == ["text-over-hole"]
    assert codes(text(50, 30, 20), plate(), hole(50, 30, 1)) == ["text-outside", "text-over-hole"]


def test_a_text_beside_the_part_has_no_height_that_would_do() -> None:
    (found,) = text_findings([text(200, 30, 5)], plate(), ())
    assert found.code == "text-outside"
    assert "off the part" in found.message


def test_a_text_larger_than_its_part_is_told_and_the_part_is_made() -> None:
    frustum = RIGHT_FRUSTUM | {"radius0": 30, "radius1": 15, "height": 40, "sweep": 90}
    mark = {"kind": "text", "at": ["0.5", "0.5"], "text": EIGHT}
    assert passage(frustum, mark=[mark | {"height": 4}]).codes("unroll") == []
    large = passage(frustum, mark=[mark | {"height": 40}])
    assert large.codes("unroll", fatal=False) == ["text-outside"]
    assert large.refused_by is None
