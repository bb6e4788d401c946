import subprocess
import sys
from io import StringIO
from math import cos, pi, radians
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.document import Drawing
from ezdxf.entities import DXFEntity
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.geometry.curves.rigid import Rigid2, apply
from stages.geometry.paths import arcpath
from stages.geometry.paths.arcpath import ArcPath
from stages.model.cutfile import CutFile, Machine
from stages.model.pattern import FlatPattern
from stages.model.report import StageReport
from stages.model.sheet import Nesting, Placement, Sheet, SheetLayout
from stages.write import write
from stages.write.drawing import flat_drawing
from stages.write.dxf import dxf_text
from stages.write.readback import read
from tests.stages.write.patterns import CHORD_MM, contour, drop, nesting, pattern, plate, polygon_edges, sector, strip

GOLDEN = Path(__file__).parents[2] / "golden"
MACHINE = Machine()


def written(*patterns: FlatPattern, nest: Nesting | None = None) -> tuple[dict[str, str], StageReport]:
    outcome = write(patterns, nest, MACHINE)
    return {file.path: file.text for file in outcome.product}, outcome.report


def drawing(text: str) -> Drawing:
    return ezdxf.read(StringIO(text))


def on(layer: str, document: Drawing) -> list[DXFEntity]:
    return [entity for entity in document.modelspace() if entity.dxf.layer == layer]


def test_each_pattern_and_each_sheet_is_a_file_that_passes() -> None:
    files, report = written(plate(), sector(), strip(), drop(), nest=nesting())
    names = [
        "flat/plate.dxf",
        "flat/sector.dxf",
        "flat/strip.dxf",
        "flat/drop.dxf",
        "cut/stock-1.dxf",
        "cut/stock-2.dxf",
    ]
    assert list(files) == names
    assert report.passed
    assert report.findings == ()
    assert report.metric("max_deviation_mm").limit == CHORD_MM
    assert 0.0 < report.metric("max_deviation_mm").value <= CHORD_MM
    assert report.metric("closure_gap_mm").value <= 1e-12
    assert report.metric("length_error").value <= 1e-4
    assert report.metric("area_error").value <= 1e-3
    # flat: 5 + 1 + 2 + 1 paths and 4 labels; sheets: three plates of 5, 2 sectors, 2 outlines, and 5 labels
    assert report.metric("entities").value == (5 + 1 + 2 + 1) + 4 + (3 * 5 + 2 + 2) + 5


def test_lines_and_arcs_are_written_without_any_error() -> None:
    _, report = written(plate(), sector())
    assert report.metric("length_error").value <= 1e-12
    assert report.metric("area_error").value <= 1e-12


def test_figures_for_costing_are_those_of_the_plate() -> None:
    _, report = written(plate())
    figures = report.detail["files"]["flat/plate.dxf"]
    assert figures["pierces"] == 3.0
    assert figures["cut_length_mm"] == pytest.approx(320.0 + 28.0 * pi, rel=1e-12)


def test_the_order_is_mark_then_small_holes_then_large_then_the_outline() -> None:
    files, _ = written(plate())
    document = drawing(files["flat/plate.dxf"])
    entities = [entity for entity in document.modelspace() if entity.dxf.layer != "LABEL"]
    assert [e.dxf.layer for e in entities] == ["MARK", "MARK", "CUT_INNER", "CUT_INNER", "CUT_OUTER"]
    assert [e.dxftype() for e in entities] == ["LINE", "LWPOLYLINE", "CIRCLE", "CIRCLE", "LWPOLYLINE"]
    assert [e.dxf.radius for e in entities[2:4]] == [4.0, 10.0]


def test_units_extents_version_and_colours_are_explicit() -> None:
    files, _ = written(sector())
    document = drawing(files["flat/sector.dxf"])
    header = document.header
    assert document.dxfversion == "AC1015"
    assert (header["$INSUNITS"], header["$MEASUREMENT"], header["$LUNITS"]) == (4, 1, 2)
    assert header["$EXTMIN"] == pytest.approx((-50.0, 0.0, 0.0), abs=1e-9)
    assert header["$EXTMAX"] == pytest.approx((100.0, 100.0, 0.0), abs=1e-9)
    assert tuple(document.modelspace().dxf.extmax) == pytest.approx((100.0, 100.0, 0.0), abs=1e-9)
    assert document.audit().errors == []
    for entity in document.modelspace():
        assert entity.dxf.color == MACHINE.layers[entity.dxf.layer].colour
        assert document.layers.get(entity.dxf.layer).color == entity.dxf.color


def test_extents_of_a_pattern_at_the_origin_are_not_dropped() -> None:
    files, _ = written(plate())
    header = drawing(files["flat/plate.dxf"]).header
    assert tuple(header["$EXTMIN"]) == (0.0, 0.0, 0.0)
    assert tuple(header["$EXTMAX"]) == (100.0, 60.0, 0.0)


def test_no_arc_is_over_a_quarter_and_every_contour_is_flagged_closed() -> None:
    files, _ = written(sector(), strip(), nest=None)
    for text in files.values():
        for polyline in (e for e in drawing(text).modelspace() if e.dxftype() == "LWPOLYLINE"):
            assert polyline.closed
            assert max(abs(b) for (b,) in polyline.get_points("b")) <= MACHINE.max_bulge * (1.0 + 1e-12)


def test_arcs_stay_arcs_in_the_nest_and_marks_and_labels_move_along() -> None:
    """Measure W14: the placed copy is the flat one, moved, vertex by vertex."""
    files, _ = written(plate(), sector(), nest=nesting())
    flat, sheet = read(files["flat/sector.dxf"]).entities, read(files["cut/stock-1.dxf"])
    motion = nesting().layouts[0].placements[2].motion
    outline = next(e.path for e in flat if e.layer == "CUT_OUTER")
    outlines = [e.path for e in sheet.entities if e.layer == "CUT_OUTER"]
    assert outline is not None and outlines[2] is not None and outlines[3] is not None
    assert outlines[2].bulges == pytest.approx(outline.bulges, abs=1e-13)
    assert outlines[2].vertices == pytest.approx(apply(motion, outline.vertices), abs=1e-9)
    # the mirrored copy runs the other way round, so that it is still counter-clockwise
    assert outlines[3].bulges.size == outline.bulges.size
    assert arcpath.area(outlines[3]) == pytest.approx(arcpath.area(outline), rel=1e-12)
    document = drawing(files["cut/stock-1.dxf"])
    marks = [e for e in on("MARK", document) if e.dxftype() == "LINE"]
    assert tuple(marks[1].dxf.start)[:2] == pytest.approx((250.0 - 10.0, 10.0 + 20.0))
    labels = on("LABEL", document)
    assert [label.dxf.text for label in labels] == ["plate", "plate", "sector", "sector"]
    assert labels[2].dxf.rotation == 33.0
    assert labels[2].dxf.align_point.x == pytest.approx(
        120.0 + 37.5 * cos(radians(33.0)) - 65.0 * np.sin(radians(33.0)), abs=1e-9
    )


def test_the_label_stays_inside_the_part() -> None:
    for part in ("p", "a-long-name-for-a-small-part-0123456789"):
        long = pattern(part, contour(polygon_edges((0.0, 0.0), (40.0, 0.0), (40.0, 4.0), (0.0, 4.0))), (20.0, 2.0))
        (label,) = flat_drawing(long, MACHINE).labels
        half = np.hypot(label.height_mm * len(part), label.height_mm) / 2.0
        assert 0.1 <= half <= 2.0


def test_a_label_that_a_dxf_cannot_hold_is_refused() -> None:
    with pytest.raises(ValueError, match="ASCII"):
        write([plate("Löffel")], None, MACHINE)


def test_a_number_that_is_not_finite_never_reaches_a_file() -> None:
    """The values refuse it already; the gate is tried with a path that was broken behind their back."""
    good = flat_drawing(plate(), MACHINE)
    path = good.items[-1].path
    broken = object.__new__(ArcPath)
    for name, value in (("vertices", path.vertices * np.nan), ("bulges", path.bulges), ("closed", True)):
        object.__setattr__(broken, name, value)
    object.__setattr__(good.items[-1], "path", broken)
    with pytest.raises(ValueError, match="finite"):
        dxf_text(good, MACHINE)


def test_two_processes_write_the_same_bytes() -> None:
    program = (
        "import sys; sys.path.insert(0, '.')\n"
        "from hashlib import sha256\n"
        "from stages.model.cutfile import Machine\n"
        "from stages.write import write\n"
        "from tests.stages.write.patterns import drop, nesting, plate, sector, strip\n"
        "files = write([plate(), sector(), strip(), drop()], nesting(), Machine()).product\n"
        "print([sha256(f.text.encode('ascii')).hexdigest() for f in files])\n"
    )
    outputs = {
        subprocess.run(
            [sys.executable, "-c", program],
            capture_output=True,
            check=True,
            cwd=Path(__file__).parents[3],
            env={"PYTHONHASHSEED": seed, "TZ": zone},
        ).stdout
        for seed, zone in (("1", "UTC"), ("2", "Asia/Tokyo"))
    }
    assert len(outputs) == 1


def test_nothing_of_the_clock_or_the_user_is_in_a_file() -> None:
    files, _ = written(plate())
    text = files["flat/plate.dxf"]
    assert ezdxf.__version__ not in text
    assert text.isascii()
    lines = text.splitlines()
    for name in ("$TDCREATE", "$TDUPDATE", "$TDUCREATE", "$TDUUPDATE"):
        assert name not in lines or lines[lines.index(name) + 2] == "2451545.0"
    for name in ("$FINGERPRINTGUID", "$VERSIONGUID"):
        assert name not in lines or set(lines[lines.index(name) + 2]) == set("{}0-")


def test_the_plate_is_the_golden_file() -> None:
    """To renew it: write `flat/plate.dxf` of `plate()` anew and look at the difference."""
    files, _ = written(plate())
    assert differing_lines(files["flat/plate.dxf"], (GOLDEN / "plate.dxf").read_text()) == []


def test_one_changed_digit_is_seen_by_the_golden_comparison() -> None:
    golden = (GOLDEN / "plate.dxf").read_text()
    assert len(differing_lines(golden.replace("\n100.0\n", "\n100.1\n", 1), golden)) == 1


def differing_lines(a: str, b: str) -> list[tuple[str, str]]:
    """Return the lines that differ; all of them from where one text ends."""
    first, second = a.splitlines(), b.splitlines()
    longest = max(len(first), len(second))
    pad = [""] * longest
    pairs = zip((first + pad)[:longest], (second + pad)[:longest], strict=True)
    return [(x, y) for x, y in pairs if x != y]


@settings(max_examples=15, deadline=None)
@given(
    st.builds(Rigid2, st.floats(-500.0, 500.0), st.floats(-500.0, 500.0), st.floats(0.0, 360.0), st.booleans()),
    st.sampled_from([plate(), sector(), drop()]),
)
def test_a_placed_part_keeps_its_length_and_area_in_the_file(motion: Rigid2, part: FlatPattern) -> None:
    sheet = Sheet("big", 2000.0, 2000.0)
    nest = Nesting((SheetLayout(sheet, 1, (Placement(part.part, 1, motion),), 0.1),))
    outcome = write([part], nest, MACHINE)
    assert outcome.report.passed, outcome.report.findings
    flat, cut = (read(file.text) for file in outcome.product)
    kept = [e for e in cut.entities if e.layer != "SHEET"]
    for before, after in zip(flat.entities, kept, strict=True):
        assert before.layer == after.layer
        if before.path is not None and after.path is not None:
            assert arcpath.length(after.path) == pytest.approx(arcpath.length(before.path), rel=1e-10)


def test_a_whole_job_is_quick() -> None:
    """Ten parts and three sheets: about 0.5 s; ten times that would be a defect, not a slow computer."""
    from time import process_time

    parts = [strip(f"part-{i}") for i in range(10)]
    sheet = Sheet("plate", 3000.0, 1500.0)
    places = tuple(
        Placement(f"part-{i}", 1, Rigid2(10.0 + 640.0 * (i % 4), 10.0 + 310.0 * (i // 4))) for i in range(10)
    )
    start = process_time()
    outcome = write(parts, Nesting(tuple(SheetLayout(sheet, k, places, 0.5) for k in (1, 2, 3))), MACHINE)
    assert process_time() - start < 25.0
    assert outcome.report.passed
    assert isinstance(outcome.product[0], CutFile)
