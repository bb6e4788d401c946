"""A known rectangle and a line of 100 mm in every flavour and version: each reader that knows units gives their size.

Readers take units from different places of a file ($INSUNITS, $MEASUREMENT, none), and those differ by version: a
factor of 25.4, of 10 or of 90 dpi would show here.  All files go to a reader in one go.
"""

from pathlib import Path

import numpy as np
import pytest

from stages.geometry.arrays import norm
from stages.model.cutfile import PROFILES, Flavour, Machine, Version
from stages.model.patternlayers import PATTERN_LAYERS
from stages.write import write
from stages.write.flavours import as_cut
from tests.near import assert_near
from tests.readers import freecad, gdal, inkscape, librecad, trimeshed
from tests.readers.drawings import kinds
from tests.readers.everyone import must_be_here
from tests.readers.reading import JOINED_MM, Piece, Reader, Reading
from tests.stages.write.patterns import contour, line_mark, pattern, polygon_edges

WIDE_MM, HIGH_MM, LINE_MM = 140.0, 60.0, 100.0
READERS = (inkscape.READER, freecad.READER, trimeshed.READER, librecad.READER, gdal.READER)


def text(flavour: Flavour, version: Version) -> str:
    """Return the drawing of a rectangle with a line on it."""
    layers = PATTERN_LAYERS if flavour == "aama" else PROFILES["planish"]
    machine = Machine(flavour=flavour, version=version, layers=layers)
    corners = ((0.0, 0.0), (WIDE_MM, 0.0), (WIDE_MM, HIGH_MM), (0.0, HIGH_MM))
    mark = line_mark((20.0, 20.0), (20.0 + LINE_MM, 20.0))
    part = as_cut(pattern("ruler", contour(polygon_edges(*corners)), (70.0, 45.0), marks=(mark,)), machine)
    outcome = write([part], None, machine)
    assert outcome.report.passed, outcome.report.findings
    return next(file.text for file in outcome.product if file.path == "flat/ruler.dxf")


def sizes(reading: Reading) -> tuple[float, float, float]:
    """Return width and height of all that was read, and of its straight pieces the length nearest to the line's."""
    every = np.concatenate([piece.points for piece in reading.pieces])
    wide, high = np.ptp(every, axis=0).tolist()
    long = [float(norm(piece.points[-1] - piece.points[0])) for piece in reading.pieces]
    return wide, high, min(long, key=lambda one: abs(one - LINE_MM))


@pytest.mark.readers
@pytest.mark.parametrize("reader", READERS, ids=[reader.name for reader in READERS])
def test_sizes_are_in_millimetres_in_every_flavour_and_version(reader: Reader, tmp_path: Path) -> None:
    must_be_here(reader)
    paths = {kind: tmp_path / f"{'-'.join(kind)}.dxf" for kind in kinds()}
    for kind, path in paths.items():
        path.write_text(text(*kind), "ascii")
    found = reader.read(list(paths.values()))
    bound = 2.0 * (reader.fineness.grid_mm + reader.fineness.stray_mm) + JOINED_MM
    for kind, path in paths.items():
        why = f"{reader.name} on {kind}: both ends lie on the reader's grid"
        assert_near(sizes(found[path.stem]), (WIDE_MM, HIGH_MM, LINE_MM), bound=bound, why=why)


def test_every_flavour_is_there_in_every_version_that_holds_it() -> None:
    versions = {version for _, version in kinds()}
    assert versions == {"R12", "R2000", "R2010", "R2018"}
    assert len(kinds()) == 3 * 3 + 2


def test_a_reading_in_inches_would_be_seen() -> None:
    rectangle = np.array([[0.0, 0.0], [WIDE_MM, 0.0], [WIDE_MM, HIGH_MM], [0.0, HIGH_MM], [0.0, 0.0]])
    line = np.array([[20.0, 20.0], [20.0 + LINE_MM, 20.0]])
    right, wrong = (
        sizes(Reading((Piece("CUT_OUTER", one * rectangle, True), Piece("MARK", one * line)))) for one in (1.0, 25.4)
    )
    assert right == (WIDE_MM, HIGH_MM, LINE_MM)
    assert min(abs(a - b) for a, b in zip(right, wrong, strict=True)) > HIGH_MM
