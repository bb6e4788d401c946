"""Curves out of drawings: exact, in the right unit, chained, and refused in words."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import ezdxf
import pytest
from ezdxf.layouts import Modelspace

from pipeline.jobfile import ReadJob, read
from stages.errors import BadInputError
from stages.model.curves import CurveSpec
from stages.model.part import Cylinder, Flat
from tests.pipeline.jobs import write_job

JOB = """\
schema = 1
[[part]]
name = "a"
[part.surface]
kind = "flat"
outline = { file = "a.dxf", layer = "A" }
"""
RAIL = JOB.replace('"flat"', '"cylinder"').replace("outline", "direction = [0, 0, 1]\nlength = 5\ndirectrix")
LAYER = {"layer": "A"}


def draw(folder: Path, fill: Callable[[Modelspace], object], units: int = 4) -> None:
    drawing = ezdxf.new("R2000")
    drawing.header["$INSUNITS"] = units
    fill(drawing.modelspace())
    drawing.saveas(folder / "a.dxf")


def outline(folder: Path, job: str = JOB) -> CurveSpec:
    surface = read(write_job(folder, job)).tables.part[0].surface
    assert isinstance(surface, Flat | Cylinder)
    return surface.outline if isinstance(surface, Flat) else surface.directrix


def complaint(folder: Path, job: str = JOB) -> str:
    with pytest.raises(BadInputError) as caught:
        read(write_job(folder, job))
    return str(caught.value).replace(f"{folder}/", "")


def four_loose_lines(space: Modelspace) -> None:
    for a, b in [((0, 30), (0, 0)), ((40, 0), (40, 30)), ((40, 0), (0, 0)), ((40, 30), (0, 30))]:
        space.add_line(a, b, dxfattribs=LAYER)


def test_loose_lines_become_one_closed_outline_that_runs_as_the_first(tmp_path: Path) -> None:
    draw(tmp_path, four_loose_lines)
    curve = outline(tmp_path)
    assert curve.chain is not None
    corners = [tuple(map(float, piece.line[0][:2])) for piece in curve.chain if piece.line]
    assert corners == [(0, 30), (0, 0), (40, 0), (40, 30)]


@pytest.mark.parametrize(("code", "mm"), [(1, "25.4"), (2, "304.8"), (4, "1"), (5, "10"), (6, "1000")])
def test_the_unit_is_that_of_the_drawing(tmp_path: Path, code: int, mm: str) -> None:
    draw(tmp_path, lambda space: space.add_circle((0.1, 0), 0.2, dxfattribs=LAYER), code)
    circle = outline(tmp_path).circle
    assert circle is not None
    assert (circle.center[0], circle.radius) == (Fraction(mm) / 10, Fraction(mm) / 5)


def test_a_drawing_without_a_unit_has_that_of_the_job_and_that_is_noted(tmp_path: Path) -> None:
    draw(tmp_path, lambda space: space.add_circle((0, 0), 2, dxfattribs=LAYER), 0)
    job: ReadJob = read(write_job(tmp_path, 'units = "in"\n' + JOB))
    surface = job.tables.part[0].surface
    assert isinstance(surface, Flat)
    assert surface.outline.circle is not None
    assert surface.outline.circle.radius == Fraction(254, 5)
    assert job.notes == ("a.dxf states no unit ($INSUNITS = 0): taken as in, the unit of the job",)


def test_bulges_become_arcs_that_join(tmp_path: Path) -> None:
    corners = [(0, 0, 0), (40, 0, 1), (40, 30, -0.5), (0, 30, 0)]
    draw(tmp_path, lambda space: space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs=LAYER))
    curve = outline(tmp_path)
    assert curve.chain is not None
    assert [piece.sorts()[0] for piece in curve.chain] == ["line", "arc", "arc", "line"]
    outward, inward = (piece.arc for piece in curve.chain[1:3])
    assert outward is not None
    assert inward is not None
    assert outward.end > outward.start
    assert inward.end < inward.start


def test_an_arc_seen_from_below_keeps_its_normal(tmp_path: Path) -> None:
    draw(tmp_path, lambda space: space.add_arc((5, 0), 3, 10, 80, dxfattribs=LAYER | {"extrusion": (0, 0, -1)}))
    arc = outline(tmp_path, RAIL).arc
    assert arc is not None
    assert (arc.normal[2], arc.center[0], arc.start, arc.end) == (-1, -5, 10, 80)


def test_splines_and_parts_of_ellipses_are_splines_and_ellipses_are_ellipses(tmp_path: Path) -> None:
    draw(tmp_path, lambda space: space.add_open_spline([(0, 0), (1, 2), (3, 2), (4, 0)], dxfattribs=LAYER))
    spline = outline(tmp_path, RAIL).bspline
    assert spline is not None
    assert (spline.degree, [float(x) for x in spline.points[1]], spline.weights) == (3, [1, 2, 0], None)
    draw(tmp_path, lambda space: space.add_ellipse((0, 0), (4, 0), 0.5, 0, 2, dxfattribs=LAYER))
    part = outline(tmp_path, RAIL).bspline
    assert part is not None
    assert part.weights is not None
    draw(tmp_path, lambda space: space.add_ellipse((0, 0), (4, 0), 0.5, dxfattribs=LAYER))
    ellipse = outline(tmp_path).ellipse
    assert ellipse is not None
    assert [float(x) for x in ellipse.minor] == [0, 2, 0]
    # a full turn as programs write it
    draw(tmp_path, lambda space: space.add_ellipse((0, 0), (4, 0), 0.5, 0, 6.283185, dxfattribs=LAYER))
    assert outline(tmp_path).ellipse == ellipse


def test_holes_are_all_closed_contours_of_their_layer(tmp_path: Path) -> None:
    def fill(space: Modelspace) -> None:
        four_loose_lines(space)
        for x in (10, 20, 30):
            space.add_circle((x, 15), 3, dxfattribs={"layer": "H"})

    draw(tmp_path, fill)
    for holes in ('{ file = "a.dxf", layer = "h" }', '[{ file = "a.dxf", layer = "H" }]'):
        surface = read(write_job(tmp_path, f"{JOB}holes = {holes}\n")).tables.part[0].surface
        assert isinstance(surface, Flat)
        assert [hole.circle.center[0] for hole in surface.holes if hole.circle] == [10, 20, 30]


REFUSED: dict[str, tuple[Callable[[Modelspace], object], str]] = {
    "an open outline": (
        lambda space: space.add_line((0, 0), (1, 1), dxfattribs=LAYER),
        "the curve from (0, 0) to (1, 1) mm is open, its ends 1.414 mm apart (close the contour in the drawing)",
    ),
    "two curves": (
        lambda space: [space.add_circle((x, 0), 1, dxfattribs=LAYER) for x in (0, 9)],
        "2 separate curves where one belongs (give each a layer of its own, or make their ends meet within 0.01 mm)",
    ),
    "lines that nearly meet": (
        lambda space: [space.add_line(a, b, dxfattribs=LAYER) for a, b in [((0, 0), (9, 0)), ((9.03, 0), (20, 9))]],
        "2 separate curves where one belongs: the nearest ends are 0.03 mm apart (give each a layer of its own, or "
        "make their ends meet within 0.01 mm)",
    ),
    "branching lines": (
        lambda space: [space.add_line((0, 0), end, dxfattribs=LAYER) for end in [(1, 0), (0, 1), (1, 1)]],
        "a.dxf: 3 ends meet at (0, 0, 0) mm (remove doubled or branching lines)",
    ),
    "text": (
        lambda space: space.add_text("hello", dxfattribs=LAYER | {"handle": "FF"}),
        "a.dxf: TEXT #FF on the layer A is no curve (LINE, ARC, CIRCLE, ELLIPSE, SPLINE, LWPOLYLINE and POLYLINE are "
        "read; move or explode it)",
    ),
    "a line without length": (
        lambda space: space.add_line((1, 1), (1, 1), dxfattribs=LAYER | {"handle": "FF"}),
        "a.dxf: LINE #FF on the layer A has no length (remove it from the drawing)",
    ),
    "another layer": (
        lambda space: space.add_circle((0, 0), 1, dxfattribs={"layer": "OUTLINE"}),
        'a.dxf has nothing on the layer "A" (only "OUTLINE")',
    ),
    "coordinates that are not finite": (
        lambda space: space.add_circle((float("nan"), 0), 1, dxfattribs=LAYER),
        'a.dxf: nan is not a finite number (a length such as 12.5, "12.5 mm" or "1/8 in")',
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_drawing_that_does_not_fit_is_refused_with_the_key(tmp_path: Path, name: str) -> None:
    fill, wanted = REFUSED[name]
    draw(tmp_path, fill)
    assert complaint(tmp_path) == f"job.toml:6:37: part[0].surface.outline.layer: {wanted}"


def test_a_missing_or_broken_file_is_an_error_of_the_job_file(tmp_path: Path) -> None:
    place = "job.toml:6:20: part[0].surface.outline.file: "
    assert complaint(tmp_path) == f"{place}there is no file a.dxf (looked for a.dxf)"
    (tmp_path / "a.dxf").write_text("this is no drawing")
    assert complaint(tmp_path) == f"{place}a.dxf cannot be read: it is no DXF file"
    (tmp_path / "a.dxf").write_text("0\nSECTION\n2\nENTITIES\n0\nLINE\nx\ny\n")
    assert complaint(tmp_path).startswith(f"{place}a.dxf is no drawing that can be read: ")


def test_an_unknown_unit_is_refused(tmp_path: Path) -> None:
    draw(tmp_path, four_loose_lines, 3)
    assert "a.dxf has the unit $INSUNITS = 3 (units read here: 1 = in, 2 = ft" in complaint(tmp_path)
