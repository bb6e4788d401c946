"""Contours that lie half a beam beside the nominal ones in cut files, as read again, also where parts share cuts."""

from dataclasses import replace
from io import StringIO

import ezdxf
import numpy as np
import pytest

from stages.geometry.paths.arcpath import area
from stages.model.cutfile import CutFile, Machine
from stages.model.report import StageReport
from stages.model.sheet import Nesting
from stages.write import judged
from stages.write.dxf import dxf_text
from stages.write.helps import helped
from stages.write.kerf import beam_patterns
from stages.write.sheets import cut_drawings
from tests.near import assert_near
from tests.stages.write.helpcases import LEADS, OFFSET, ROUNDING, codes, first_sheet, machine, made, usual
from tests.stages.write.patterns import contour, nesting, pattern, plate, polygon_edges, sector
from tests.stages.write.test_commonlines import KERF_MM, PARTS, grid


def test_offset_contours_follow_steiner_and_say_so_in_their_layers() -> None:
    how = machine(OFFSET)
    found = [abs(area(one.path)) for one in first_sheet(how) if one.layer == "CUT_OUTER" and one.path is not None]
    grown = 6000.0 + 320.0 * 0.1 + np.pi * 0.01
    assert_near(found[:2], [grown, grown], bound=1e-6, why="A + L d + pi d^2, rounded coordinates times the length")
    text = {file.path: file.text for file in usual(OFFSET).product}["cut/stock-1.dxf"]
    names = {layer.dxf.name for layer in ezdxf.read(StringIO(text)).layers}
    assert {"CUT_OUTER_OFFSET", "CUT_INNER_OFFSET"} <= names
    assert not {"CUT_OUTER", "CUT_INNER"} & names


def test_how_far_contours_are_offset_is_measured_on_the_files() -> None:
    report = usual(OFFSET).report
    off = report.metric("kerf_offset_error_mm")
    assert off.passed
    assert_near(float(off.value or 0.0), 0.0, bound=ROUNDING, why="rounding of the file")
    assert "kerf-compensated" in {finding.code for finding in report.findings}


@pytest.mark.parametrize("wrong", [0.19, 0.21, 0.2002])
def test_a_wrong_offset_in_the_file_is_found(wrong: float) -> None:
    """The files are written for another kerf than the one that they are judged by."""
    good, bad = machine(OFFSET), machine(replace(OFFSET, beam_mm=wrong))
    report = rejudged(bad, good)
    assert not report.metric("kerf_offset_error_mm").passed


def rejudged(written: Machine, wanted: Machine) -> StageReport:
    """Return the report on files of one machine as judged by the drawings of another, but for their helps."""
    parts = {one.part: one for one in (plate(), sector())}
    beams = {one.part: one for one in beam_patterns(tuple(parts.values()), written)[0]}
    drawings = [
        replace(helped(one, written), helps=wanted.helps) for one in cut_drawings(nesting().layouts, beams, written)
    ]
    files = [CutFile(one.path, dxf_text(one, written.of_file(one.path))) for one in drawings]
    return judged(files, drawings, parts, wanted)


def test_a_slot_narrower_than_the_kerf_is_refused_with_its_place() -> None:
    slot = polygon_edges(
        (0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (20.15, 30.0), (20.15, 10.0), (20.0, 10.0), (20.0, 30.0), (0.0, 30.0)
    )
    part = pattern("plate", contour(slot), (5.0, 5.0))
    outcome = made(machine(OFFSET), (part, sector()))
    (found,) = [finding for finding in outcome.report.findings if finding.code == "narrower-than-kerf"]
    assert found.fatal
    assert found.where is not None
    assert 20.0 <= float(found.where["x"]) <= 20.15


def test_offset_common_lines_close_again() -> None:
    how = replace(machine(OFFSET), common_kerf_mm=KERF_MM)
    outcome = made(how, tuple(PARTS), Nesting((grid(3),)))
    assert outcome.report.passed, outcome.report.findings
    (told,) = [one for one in outcome.report.findings if one.code == "common-lines"]
    assert told.where is not None
    assert_near(
        float(told.where["length_mm"]), 6.0 * 50.0 + 6.0 * 30.0, bound=ROUNDING, why="12 sides, corners rounded"
    )


def test_beside_common_lines_holes_keep_their_leads_and_the_rest_is_said() -> None:
    how = replace(machine(LEADS), common_kerf_mm=KERF_MM)
    outcome = made(how, tuple(PARTS), Nesting((grid(2),)))
    assert outcome.report.passed, outcome.report.findings
    assert {"leads", "helps-and-common-lines"} <= codes(outcome)
    (leads,) = [one for one in outcome.report.findings if one.code == "leads"]
    assert leads.where is not None
    assert leads.where["leads"] == 2 * 4
