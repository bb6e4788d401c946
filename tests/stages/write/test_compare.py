"""A file against what was drawn and against the exact development."""

from collections.abc import Callable

import numpy as np
import pytest
from ezdxf.document import Drawing as Document

from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import CutFile
from stages.model.pattern import Contour
from stages.model.report import StageReport
from stages.write import judged, write
from stages.write.drawing import flat_drawing
from tests.stages.write.patterns import plate, sector
from tests.stages.write.planted import MACHINE, bulge, copy_hole, outline, with_change


def report_on(text: str) -> StageReport:
    part = plate()
    return judged([CutFile("flat/plate.dxf", text)], [flat_drawing(part, MACHINE)], {"plate": part})


@pytest.mark.parametrize(
    "change",
    [
        bulge(0.01),
        bulge(-0.01),
        copy_hole,
        lambda document: outline(document).translate(1e-6, 0.0, 0.0),
        lambda document: document.modelspace().delete_entity(next(iter(document.modelspace()))),
    ],
)
def test_a_file_that_is_not_what_was_drawn_is_found(change: Callable[[Document], None]) -> None:
    found = {finding.code for finding in report_on(with_change(change)).findings if finding.fatal}
    assert "readback-content" in found


def test_a_failed_readback_fails_the_report_but_keeps_the_files() -> None:
    report = report_on(with_change(bulge(0.01)))
    assert not report.passed
    assert report.metric("entities").value == 6.0
    assert report.metric("max_deviation_mm").value is None


def flipped(path: ArcPath) -> ArcPath:
    return ArcPath(path.vertices, path.bulges * np.where(np.arange(path.bulges.size) == 0, -1.0, 1.0), path.closed)


def test_a_flipped_bulge_in_the_pattern_itself_is_a_deviation() -> None:
    part = sector()
    wrong = part.replace(outer=Contour(part.outer.edges, flipped(part.outer.path), part.outer.chord_mm))
    outcome = write([wrong], None, MACHINE)
    assert not outcome.report.passed
    assert not outcome.report.metric("max_deviation_mm").passed
    assert outcome.report.metric("area_error").value > 0.1
