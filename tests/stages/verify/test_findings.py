"""Where a refused surface is said to fold: on its own patch, by the part's v."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest

from stages.geometry.curves.curves import Circular
from stages.geometry.ruled.ruled import between
from stages.model.report import Metric
from stages.model.surface import RuledSurface
from stages.model.tolerances import Tolerances
from stages.verify.findings import rejection
from tests.parts import RIGHT_FRUSTUM, part

X, Y, Z = np.eye(3)
RIM = Circular(0.0 * X, 3.0 * X, 3.0 * Y, 0.0 * X, 0.0, pi)
BEYOND = [between(RIM, Circular(Z, end * X, end * Y, 0.0 * X, 0.0, pi)) for end in (-1.5, -3.0)]
"""Two cones that run on beyond their apexes: the edge of regression is at u = 3 / 4.5 and at u = 3 / 6."""


@pytest.mark.parametrize(("v", "u"), [(7.25, "0.6667"), (8.25, "0.5")])
def test_the_edge_of_regression_is_looked_for_on_the_patch_that_folds(v: float, u: str) -> None:
    spans = tuple((Fraction(first), Fraction(first + 1)) for first in (7, 8))
    surface = RuledSurface(part(RIGHT_FRUSTUM), tuple(BEYOND), 10.0, spans)
    found = rejection(surface, Metric("max_warp_deg", 180.0, "deg", "proved", 8.0, {"v": v}), Tolerances())
    assert found.code == "edge-of-regression"
    assert f"(at u = {u}, v = {v})" in found.message
