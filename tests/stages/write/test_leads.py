"""Leads in cut files: beside their contours, on the waste, clear of neighbours, or elsewhere, or left out and said."""

from dataclasses import replace

import numpy as np

from stages.geometry.paths.arcpath import length
from stages.geometry.paths.clearance import pieces
from stages.geometry.paths.enclosed import inside
from stages.model.helps import Lead
from stages.model.sheet import Nesting, Sheet
from stages.write.chains import Entity
from stages.write.readback import read
from tests.near import assert_near
from tests.stages.write.helpcases import LEADS, NONE, codes, first_sheet, machine, made, usual
from tests.stages.write.test_commonlines import PARTS, laid


def test_leads_stand_beside_their_contours_in_the_order_of_cutting() -> None:
    layers = [one.layer for one in first_sheet(machine(LEADS)) if one.layer in ("LEAD", "CUT_INNER", "CUT_OUTER")]
    assert [layers[k : k + 3][::2] for k in range(0, len(layers), 3)] == [["LEAD", "LEAD"]] * 8


def test_a_lead_into_a_neighbour_makes_the_contour_begin_elsewhere() -> None:
    """Beside the middle of the long sides lie neighbours, 2 mm off: a lead of 3 mm fits the short sides alone."""
    bare = [one.replace(inner=(), marks=()) for one in PARTS]
    row = laid(*(("a", 20.0, 20.0 + 32.0 * k) for k in range(3)))
    helps = replace(NONE, lead_in=Lead("line", 3.0, 90.0), start="line")
    outcome = made(machine(helps), tuple(bare), Nesting((row,)))
    assert outcome.report.passed, outcome.report.findings
    (leads,) = [one for one in outcome.report.findings if one.code == "leads"]
    assert leads.where is not None
    assert (leads.where["leads"], leads.where["moved"]) == (3, 2)


def test_a_lead_along_the_chord_of_its_arc_is_as_good_as_any() -> None:
    """At 45 degrees to a quarter of a circle it begins on the chord: nothing is in its way, however the part lies."""
    for sheet in usual(LEADS).product[2:]:
        (told,) = [
            one for one in usual(LEADS).report.findings
            if one.code == "leads" and one.where is not None and one.where["file"] == sheet.path
        ]  # fmt: skip
        assert told.where is not None
        assert told.where["moved"] == 0


def test_where_no_lead_fits_that_is_said_and_the_part_is_cut() -> None:
    tight = Sheet("stock", 54.0, 34.0)
    bare = [one.replace(inner=(), marks=()) for one in PARTS]
    outcome = made(machine(LEADS), tuple(bare), Nesting((laid(("a", 2.0, 2.0), sheet=tight),)))
    assert outcome.report.passed, outcome.report.findings
    assert "lead-left-out" in codes(outcome)


def cut_length(entities: list[Entity]) -> float:
    return sum(length(one.path) for one in entities if one.layer.startswith("CUT_") and one.path is not None)


def test_leads_change_no_contour() -> None:
    assert_near(cut_length(first_sheet(machine(LEADS))), cut_length(first_sheet(machine(NONE))), bound=1e-7, why="same")


OFF_CHORDS = np.array([1e-3, 2e-3])
"""Points on the chord of an arc may count either way."""


def test_a_mirrored_copy_keeps_its_leads_on_the_waste() -> None:
    """Of the second sheet, which holds a mirrored plate with its holes: none begins on the part."""
    texts = {file.path: file.text for file in usual(LEADS).product}
    entities = read(texts["cut/stock-2.dxf"]).entities
    ways = [one.path for one in entities if one.layer == "LEAD" and one.path is not None]
    contours = [pieces(one.path) for one in entities if one.layer.startswith("CUT_") and one.path is not None]
    ends = np.stack([way.vertices[0 if number % 2 == 0 else -1] for number, way in enumerate(ways)])
    held = sum(inside(ends + OFF_CHORDS, contour).astype(int) for contour in contours)
    assert len(ways) == 6
    assert set(held.tolist()) == {0, 2}
