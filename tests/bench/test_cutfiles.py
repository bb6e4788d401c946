"""The table of the measures of a cut file: what is wrong in a file is seen, and what is missed is called so."""

from collections.abc import Callable

import ezdxf
import pytest
from ezdxf.entities.lwpolyline import LWPolyline

from stages.model.cutfile import Machine
from stages.model.patternlayers import PATTERN_LAYERS
from stages.write.flavours import as_cut
from stages.write.piecedxf import pieces_text
from stages.write.pieces import flat_file
from tests.bench.cutfiles.contents import flaws
from tests.bench.cutfiles.figures import errors, unlike_d6673
from tests.bench.cutfiles.rows import Worst, counted, limited, shown
from tests.stages.write.patterns import plate

SQUARE = [(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (10.0, 10.0, 0.0), (0.0, 10.0, 0.0)]


def drawn(points: list[tuple[float, float, float]], *, closed: bool = True) -> LWPolyline:
    return ezdxf.new("R2000").modelspace().add_lwpolyline(points, format="xyb", close=closed)


def test_a_whole_contour_has_no_flaw_and_each_flaw_is_seen() -> None:
    assert [*flaws(drawn(SQUARE), short=False)] == []
    assert [*flaws(ezdxf.new("R2000").modelspace().add_circle((0, 0), 3), short=False)] == []
    broken: list[tuple[LWPolyline, str]] = [
        (drawn(SQUARE, closed=False), "no closed polyline"),
        (drawn([*SQUARE, SQUARE[-1]]), "a piece of 0 mm"),
        (drawn([*SQUARE, (0.0, 9.99, 0.0)]), "a piece of 0.01 mm"),
        (drawn([*SQUARE[:-1], (0.0, 10.0, 1.1)]), "more than half a circle"),
    ]
    for entity, said in broken:
        (flaw,) = flaws(entity, short=False)
        assert said in flaw
    (arc,) = flaws(ezdxf.new("R2000").modelspace().add_arc((0, 0), 3, 0, 90), short=False)
    assert arc == "ARC is no closed polyline"


def test_a_pattern_file_is_one_and_what_is_not_of_it_is_seen() -> None:
    machine = Machine(flavour="aama", version="R12", layers=PATTERN_LAYERS)
    text = pieces_text(flat_file(as_cut(plate(), machine), machine), machine)
    assert [*unlike_d6673(text)] == []
    changes: list[Callable[[str], str]] = [
        lambda good: good.replace("INSERT\n  8\n1\n  2\n", "INSERT\n  8\n1\n  2\nX", 1),
        lambda good: good.replace("LINE\n  8\n8\n", "LINE\n  8\n99\n", 1),
    ]
    for change in changes:
        assert change(text) != text
        assert [*unlike_d6673(change(text))] != []


def test_errors_are_relative_and_a_layer_that_is_missing_is_infinitely_off() -> None:
    assert [*errors({"CUT_OUTER": (101.0, 40.0)}, {"CUT_OUTER": (100.0, 40.0)})] == pytest.approx([0.01, 0.0])
    assert max(errors({}, {"CUT_OUTER": (100.0, 40.0)})) == 1.0
    assert max(errors({"CUT_INNER": (1.0, 1.0)}, {})) == float("inf")


def test_what_is_above_its_limit_or_was_not_looked_at_is_missed() -> None:
    found = [Worst(0.1, "here"), Worst(0.3, "there")]
    assert limited("W0", "a figure", (0.3, "mm"), found, "how").right
    high = limited("W0", "a figure", (0.2, "mm"), found, "how")
    assert (high.right, high.where) == (False, "there")
    assert not limited("W0", "a figure", (0.2, "mm"), [], "how").right
    assert not counted("W0", "files", ["one"], 3, "how").right
    assert not counted("W0", "files", [], 0, "how").right
    assert shown(high) == "| W0 a figure | <= 0.2 mm | 0.3 mm (2 looked at) | NO | sampled | how | there |"
