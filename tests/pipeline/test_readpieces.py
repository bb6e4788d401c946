"""A pattern comes back from its pattern file, with what the file says of it, and is written again as it was."""

from functools import cache

import numpy as np
import pytest

from pipeline.readpatterns import NoPatternError, read_pattern
from stages.model.pattern import FlatPattern
from stages.model.patternlayers import PATTERN_LAYERS
from stages.write import write
from stages.write.tracing import as_pattern
from tests.near import assert_near
from tests.stages.write.patterns import CHORD_MM, plate
from tests.stages.write.pieces import MACHINE, flap

DECIMALS = 0.5e-10
"""Half of the last decimal of a drawing, mm."""


FLAP = as_pattern(flap())


@cache
def flap_text() -> str:
    return drawn(FLAP)


def drawn(part: FlatPattern, path: str = "flat/flap.dxf") -> str:
    return next(file.text for file in write([part], None, MACHINE).product if file.path == path)


def back() -> FlatPattern:
    return read_pattern(flap_text(), CHORD_MM, PATTERN_LAYERS)


def test_contours_come_back_with_their_turn_points_and_finer_curves() -> None:
    found, meant = back(), FLAP
    assert (found.part, found.quantity, len(found.inner)) == ("flap", 1, len(meant.inner))
    for one, other in zip((found.outer, *found.inner), (meant.outer, *meant.inner), strict=True):
        assert_near(one.path.vertices, other.path.vertices, bound=DECIMALS, why="decimals of the drawing")
        assert one.traced is not None
        assert other.traced is not None
        assert one.traced.turns == other.traced.turns
        assert_near(one.traced.finer.vertices, other.traced.finer.vertices, bound=DECIMALS, why="decimals")


def test_notches_drill_holes_and_texts_come_back() -> None:
    found, meant = back(), FLAP
    assert [(one.kind, one.depth_mm, one.width_mm) for one in found.notches] == [
        ("v", 3.0, 2.0), ("castle", 4.0, 3.0), ("slit", 4.0, 0.0),
    ]  # fmt: skip
    for one, other in zip(found.notches, meant.notches, strict=True):
        assert_near(one.at, other.at, bound=DECIMALS, why="decimals of the drawing")
        assert_near(one.inward, other.inward, bound=1e-11, why="decimals of an angle in degrees")
    assert [(one.diameter_mm, one.at.tolist()) for one in found.drills] == [(1.0, [10.0, 30.0])]
    assert [one.text for one in found.texts] == ["front"]
    assert_near(found.label_at, meant.label_at, bound=1e-9, why="sums of heights of texts")
    assert [one.layer for one in found.marks] == ["MARK", "SEW", "CUT_SLIT"]


def test_what_came_back_is_written_again_with_the_same_pieces() -> None:
    wished = back().replace(axis_deg=30.0, thickness_mm=1.6, quantity=3, pair=True)
    once, again = flap_text(), drawn(wished)
    assert [line for line in once.splitlines() if ":" in line] == [line for line in again.splitlines() if ":" in line]
    assert read_pattern(again, CHORD_MM, PATTERN_LAYERS).outer.path.vertices.tolist() == (
        read_pattern(once, CHORD_MM, PATTERN_LAYERS).outer.path.vertices.tolist()
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda _: "no drawing", "cannot be read"),
        (lambda text: text.replace("Piece Name: flap", "flap"), "1 outlines and 6 texts"),
    ],
)
def test_what_is_no_pattern_of_one_piece_is_refused(change, words) -> None:
    with pytest.raises(NoPatternError, match=words):
        read_pattern(change(flap_text()), CHORD_MM, PATTERN_LAYERS)


def test_a_file_of_several_pieces_is_no_pattern() -> None:
    text = write([FLAP, plate()], None, MACHINE).product[2].text
    with pytest.raises(NoPatternError, match="2 pieces"):
        read_pattern(text, CHORD_MM, PATTERN_LAYERS)


def test_a_plate_has_no_notches_and_no_drill_holes() -> None:
    found = read_pattern(drawn(plate(), "flat/plate.dxf"), CHORD_MM, PATTERN_LAYERS)
    assert (found.notches, found.drills, len(found.inner)) == ((), (), 2)
    assert np.isfinite(found.label_at).all()
