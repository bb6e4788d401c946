"""Every fault of a pattern file is found by itself, in a file that is otherwise good; good files have none."""

import re
from collections.abc import Callable
from dataclasses import replace

import pytest
from ezdxf.document import Drawing as Document
from ezdxf.entities import Point, Polyline

from stages.geometry.curves.plane import CircularArc
from stages.model.cutfile import CutFile
from stages.write.patternfiles import judged_patterns
from stages.write.piecedxf import pieces_text
from stages.write.pieces import flat_file, style_file
from stages.write.tracing import as_pattern
from tests.stages.write.patterns import sector
from tests.stages.write.pieces import MACHINE, flap
from tests.stages.write.plantedpieces import (
    FLAP,
    PLANTED,
    SECTOR,
    block,
    changed,
    codes,
    extents,
    good,
    layer_units,
    on,
    text_of,
    told,
    validation_off,
)


@pytest.mark.parametrize(("code", "change"), PLANTED, ids=[f"{code}-{i}" for i, (code, _) in enumerate(PLANTED)])
def test_a_planted_fault_is_found(code: str, change: Callable[[Document], None]) -> None:
    assert code in codes(changed(change))


def test_good_files_have_no_faults() -> None:
    assert codes(good()) == set()
    assert codes(changed(lambda _: None)) == set()
    assert told(good()) == set()
    assert codes(pieces_text(style_file([FLAP, SECTOR], MACHINE), MACHINE)) == set()


@pytest.mark.parametrize(("code", "change"), [("readback-units", layer_units), ("readback-extents", extents)])
def test_faults_of_any_drawing_are_found_in_a_pattern_file_too(code: str, change: Callable[[Document], None]) -> None:
    assert told(changed(change)) == {code}


def test_what_cannot_be_read_and_what_is_not_ascii_is_said() -> None:
    assert codes("no drawing") == {"readback-complaint"}
    assert codes(good().replace("Piece Name: flap", "Piece Name: fl\u00e4p")) == {"readback-complaint"}


@pytest.mark.parametrize("said", ["nan", "inf", "much"])
def test_a_tolerance_that_is_no_number_excuses_nothing(said: str) -> None:
    key = "Curve Tolerance: "
    assert codes(re.sub(f"{key}.*", f"{key}{said}", changed(validation_off))) == {"pattern-validation"}


def test_pieces_that_are_called_the_same_are_found() -> None:
    text = pieces_text(style_file([FLAP, SECTOR], MACHINE), MACHINE)
    assert codes(text.replace("Piece Name: sector", "Piece Name: flap")) == {"pattern-text"}


def scaled(found: Document) -> None:
    """Everything in its place on a piece that is larger by a millionth: only what was written tells."""
    for entity in block(found):
        if isinstance(entity, Polyline):
            for corner in entity.vertices:
                corner.dxf.location *= 1.000001
        elif isinstance(entity, Point):
            depth = entity.dxf.location.z
            entity.dxf.location = (entity.dxf.location * 1.000001).replace(z=depth)


def other_flag(found: Document) -> None:
    on(found, "3", Point)[0].dxf.layer = "2"


def other_quantity(found: Document) -> None:
    text_of(found, "Quantity").dxf.text = "Quantity: 7"


def deeper_notch(found: Document) -> None:
    point = on(found, "81", Point)[0]
    point.dxf.location += (0.0, 0.0, 1e-3)


def renamed(found: Document) -> None:
    found.blocks.rename_block("FLAP_M", "FLOP_M")
    found.modelspace().query("INSERT")[0].dxf.name = "FLOP_M"


@pytest.mark.parametrize("change", [scaled, other_flag, other_quantity, deeper_notch, renamed])
def test_a_file_that_is_good_by_itself_but_not_what_was_written_is_found(change: Callable[[Document], None]) -> None:
    text = changed(change)
    assert codes(text) == set()
    assert told(text) == {"readback-content"}


def test_an_outline_off_its_exact_edges_is_measured() -> None:
    """Written as it was asked for, but of edges that lie 0.05 mm elsewhere: the deviation tells, and does not pass."""
    aside = as_pattern(flap().replace(notches=()))
    edges = as_pattern(sector()).outer.edges
    wrong = aside.replace(outer=SECTOR.outer, inner=(), marks=(), drills=(), texts=(), axis_deg=None)
    grown = tuple(
        CircularArc(edge.centre, edge.radius + 0.05, edge.start_rad, edge.sweep_rad)
        if isinstance(edge, CircularArc)
        else edge
        for edge in edges
    )
    drawn = flat_file(wrong, MACHINE)
    told_of = wrong.replace(outer=replace(wrong.outer, edges=grown))
    text = CutFile("flat/flap.dxf", pieces_text(drawn, MACHINE))
    report = judged_patterns([text], [drawn], {"flap": told_of}, MACHINE)
    assert report.metric("max_deviation_mm").value > 0.05
    assert not report.metric("max_deviation_mm").passed
    assert judged_patterns([text], [drawn], {"flap": wrong}, MACHINE).passed
