"""The finding: where a part passes through itself, by the part's own v; and that such a part goes no further."""

from math import hypot, pi

import pytest

from tests.near import assert_near
from tests.parts import OBLIQUE_CONE, Table, passage

FIGURE_EIGHT: Table = {
    "bezier": [[0, 0, 0], [10, 6, 0], [-6, 6, 0], [4, 0, 0]],
}
BOW: Table = {"polyline": [[0, 0, 0], [4, 4, 0], [4, 0, 0], [0, 3, 0]]}


@pytest.mark.parametrize("surface", [
    {"kind": "cylinder", "directrix": FIGURE_EIGHT, "direction": [0, "0.2", 1], "length": 50},
    {"kind": "cone", "directrix": FIGURE_EIGHT, "apex": [2, 2, 40], "fraction": [0, 0.5]},
    {"kind": "cylinder", "directrix": BOW, "direction": [0, 0, 1], "length": 5},
])  # fmt: skip
def test_a_part_that_passes_through_itself_is_refused(surface: Table) -> None:
    made = passage(surface)
    assert made.refused_by == "verify"
    assert made.codes("verify", fatal=True) == ["self-crossing"]


def test_the_place_is_given_on_both_sheets_and_in_space() -> None:
    """Line y = x crosses the line from (4, 0) to (0, 3) at 12/7: at 3/7 of piece 0 and at 4/7 of piece 2."""
    made = passage({"kind": "cylinder", "directrix": BOW, "direction": [0, 0, 1], "length": 5})
    (finding,) = [f for f in made.reports["verify"].findings if f.fatal]
    where = finding.where
    assert where is not None
    found = [float(where[key]) for key in ("v", "v2", "x", "y")]
    assert_near(found, [3 / 7, 2 + 4 / 7, 12 / 7, 12 / 7], bound=1e-9, why="closed form; v counts over the pieces")
    assert_near(float(where["z"]), 5 * float(where["u"]), bound=1e-9, why="the point of u on both")
    assert where["u"] == pytest.approx(where["u2"], abs=1e-9)


def test_a_part_that_does_not_is_not() -> None:
    assert "self-crossing" not in passage(OBLIQUE_CONE).codes("verify")


def test_a_part_that_lies_on_itself_is_told_and_not_refused() -> None:
    """A pipe of radius 10 wound twice: v and v + 1/2 of its 62.8 mm rounds are one ruling; touching is no crossing."""
    twice = {"center": [0, 0, 0], "radius": 10, "normal": [0, 0, 1], "start": 0, "end": 720}
    made = passage({"kind": "cylinder", "directrix": {"arc": twice}, "direction": [0, 0, 1], "length": 20})
    (finding,) = [f for f in made.reports["verify"].findings if f.code == "lies-on-itself"]
    assert not finding.fatal
    where = finding.where
    assert where is not None
    assert hypot(float(where["x"]), float(where["y"])) == pytest.approx(10.0, abs=1e-9), "the place is on the pipe"
    apart = abs(float(where["v2"]) - float(where["v"]) - 0.5) * 40 * pi
    assert apart <= 2.0 * float(where["cell_mm"]), "both sheets meet there, to the cells that were left"
