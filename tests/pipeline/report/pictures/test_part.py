"""Pictures of parts and sheets: what is seen on them, the same bytes for the same part, names as they are."""

import json
from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from io import BytesIO
from typing import Any

import msgspec
import numpy as np
import pytest
from PIL import Image

from pipeline.report.pictures import canvas as page
from pipeline.report.pictures.edges import corner_points, hole_text, rulings, side_area, side_length, sides
from pipeline.report.pictures.flat import pattern_room
from pipeline.report.pictures.flat_names import upright
from pipeline.report.pictures.net import frame_of, net, normals, ruling_places, view_direction
from pipeline.report.pictures.notes import in_columns, wrapped
from pipeline.report.pictures.part import arrangement, part_picture, sheet_picture
from stages.construct import construct
from stages.geometry.curves.rigid import Rigid2
from stages.model.material import Part
from stages.model.part import PartSpec
from stages.model.pattern import FlatPattern
from stages.model.sheet import Placement, Sheet, SheetLayout
from stages.model.surface import RuledSurface, Surface
from stages.model.tolerances import Tolerances
from stages.unroll import unroll
from stages.verify import verify
from tests.stages.write.patterns import plate

TOL = Tolerances()
FRUSTUM = {"kind": "cone", "radius0": 30, "radius1": 15, "height": 40}
CONE = {"kind": "cone", "radius0": 1, "radius1": 0, "height": "1/2", "sweep": 200}
CIRCLE = {"circle": {"center": [0, 0, 0], "radius": 300, "normal": [1, 0, 0]}}
PIPE = {"kind": "cylinder", "directrix": CIRCLE, "direction": [1, 0, 0], "length": 10000}
SADDLE = {
    "kind": "ruled",
    "c0": {"line": [[0, 0, 0], [100, 0, 0]]},
    "c1": {"line": [[0, 50, 0], [100, 50, 20]]},
}
SLENDER = {
    "kind": "quintic-planar",
    "p0": [1, 3, 2], "q0": [1, 3, 6], "p1": [3, 81, 2], "q1": [3, 81, 6],
    "alpha0": 2, "alpha1": 3, "beta0": 4, "beta1": 1,
    "alpha0_hat": 2, "alpha1_hat": 4, "beta0_hat": 1, "beta1_hat": 1,
}  # fmt: skip
OUTLINE = {"polyline": [[0, 0], [300, 0], [300, 200], [0, 200], [0, 0]]}
PLATE = {"kind": "flat", "outline": OUTLINE, "holes": [{"circle": {"center": [60, 60], "radius": 40}}]}
ZIGZAG = [[i, i % 2, 0] for i in range(9)]
FOLDED = {"kind": "ruled", "c0": {"polyline": ZIGZAG}, "c1": {"polyline": [[x, y, 9] for x, y, _ in ZIGZAG]}}
Made = tuple[Surface, FlatPattern | None]


def make(surface: Mapping[str, object], name: str = "part", **keys: object) -> Made:
    return _made_once(json.dumps({"name": name, "surface": surface, **keys}))


@lru_cache
def _made_once(part: str) -> Made:
    spec = msgspec.convert(json.loads(part), PartSpec, dec_hook=lambda kind, value: kind(Fraction(str(value))))
    built = construct(Part(spec), TOL).product
    assert built is not None
    certificate = verify(built, TOL).product
    return built, None if certificate is None else unroll(certificate, TOL).product


def made(surface: Mapping[str, object], name: str = "part", **keys: object) -> tuple[Surface, FlatPattern]:
    built, pattern = make(surface, name, **keys)
    assert pattern is not None
    return built, pattern


def pixels(png: bytes) -> np.ndarray[Any, np.dtype[np.uint8]]:
    return np.asarray(Image.open(BytesIO(png)))


def count(png: bytes, colour: str) -> int:
    """Return how many pixels have exactly this colour."""
    rgb = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return int((pixels(png) == rgb).all(axis=2).sum())


@pytest.mark.parametrize("kind", [CONE, PIPE, SLENDER, PLATE, FOLDED], ids=lambda kind: str(kind["kind"]))
def test_every_kind_of_part_is_drawn_at_full_size(kind: Mapping[str, object]) -> None:
    surface, pattern = made(kind)
    assert pixels(part_picture(surface, pattern, ["a note"])).shape == (726, 1320, 3)


def test_the_same_part_gives_the_same_bytes() -> None:
    first, second = (part_picture(*made(FRUSTUM), ["note"], None, "exact") for _ in range(2))
    assert first == second
    assert not any(word in first for word in (b"tEXt", b"tIME", b"atplotlib"))


def test_the_users_own_settings_change_nothing() -> None:
    import matplotlib

    plain = part_picture(*made(PLATE), [])
    with matplotlib.rc_context(
        {"font.family": "serif", "figure.facecolor": "red", "path.simplify": False, "text.antialiased": False}
    ):
        assert part_picture(*made(PLATE), []) == plain


@lru_cache
def drawn(height: int, name: str, note: str, reached: str, marks: int = 0) -> bytes:
    mark = [{"kind": "rulings", "count": marks}] if marks else []
    return part_picture(*made(FRUSTUM | {"height": height}, name, mark=mark), [note], None, reached)


CHANGES = ((41, "a", "b", "c"), (40, "x", "b", "c"), (40, "a", "x", "c"), (40, "a", "b", "x"), (40, "a", "b", "c", 3))


@pytest.mark.parametrize("change", CHANGES, ids=("shape", "name", "note", "class", "mark"))
def test_a_difference_in_the_part_is_seen(change: tuple[int, str, str, str]) -> None:
    assert drawn(*change) != drawn(40, "a", "b", "c")


def test_a_rejected_part_shows_its_worst_ruling_and_says_so() -> None:
    surface, pattern = make(SADDLE)
    assert pattern is None
    plain = part_picture(surface, None, ["warp 11 deg"])
    marked = part_picture(surface, None, ["warp 11 deg"], 0.5)
    assert count(plain, page.PURPLE) == 0
    assert count(marked, page.PURPLE) > 200
    assert count(plain, page.VERMILLION) > 1000, "the word REJECTED"


def test_a_rejected_plate_is_drawn() -> None:
    surface, _ = made(PLATE)
    assert count(part_picture(surface, None, []), page.VERMILLION) > 1000


def test_the_edges_have_one_colour_in_both_views() -> None:
    surface, pattern = made(FRUSTUM)
    image = part_picture(surface, pattern, [])
    assert all(count(image, colour) > 200 for colour in (page.BLUE, page.VERMILLION, page.GREEN))


@pytest.mark.parametrize("name", ["$x_^{", "Überlänge 日本 \N{SNOWMAN}", "line\nbreak\t\x07", "100 % $5$"])
def test_any_name_is_written_as_it_is(name: str) -> None:
    surface, pattern = made(PLATE, name)
    layout = SheetLayout(Sheet(name, 400.0, 300.0), 1, (Placement(name, 1, Rigid2()),), 0.5)
    part_picture(surface, pattern, [name * 9] * 40)
    sheet_picture(layout, {name: pattern})


def test_signs_without_a_shape_become_boxes_and_long_names_keep_their_ends() -> None:
    assert page.shown("a日\nü$") == f"a{page.BOX_SIGN} ü$"
    assert page.shortened("left-hand-side-panel-42", 11) == "left-…el-42"


def test_notes_that_do_not_fit_are_counted() -> None:
    lines = wrapped([f"note {i}" for i in range(30)], 40, 5)
    assert len(lines) == 5
    assert "26 more" in lines[-1]


def test_lengths_and_areas_of_a_frustum_are_those_of_the_closed_form() -> None:
    _, pattern = made(FRUSTUM)
    slant = float(np.hypot(15.0, 40.0))
    lengths = {name: side_length(edges) for name, edges in sides(pattern).items()}
    wanted = {"start": slant, "c1": 30.0 * np.pi, "end": slant, "c0": 60.0 * np.pi}
    assert lengths == pytest.approx(wanted, rel=1e-9)
    assert side_area(pattern.outer.edges) == pytest.approx(np.pi * 45.0 * slant, rel=1e-9)


def test_the_edge_at_an_apex_has_no_length_and_a_plate_no_named_edges() -> None:
    assert side_length(sides(made(CONE)[1])["c1"]) < 1e-12
    assert sides(made(PLATE)[1]) == {}


def test_rulings_lie_at_the_same_v_in_both_views() -> None:
    surface, pattern = made(FOLDED)
    assert isinstance(surface, RuledSurface)
    shape = net(surface)
    places = ruling_places(len(surface.patches))
    assert shape.v[shape.rulings] == pytest.approx(places)
    formed = np.linalg.norm(shape.points[shape.rulings, -1] - shape.points[shape.rulings, 0], axis=1)
    flat = [np.linalg.norm(line[1] - line[0]) for line in rulings(pattern, places)]
    assert flat == pytest.approx(formed)
    assert len(places) == 25


@pytest.mark.parametrize("patches", [1, 2, 5, 23, 24, 25, 59, 1000])
def test_rulings_are_few_for_any_number_of_patches(patches: int) -> None:
    places = ruling_places(patches)
    assert 12 <= places.size <= 25
    assert places[0] == 0.0
    assert places[-1] <= patches


def test_no_quad_comes_out_of_rounding() -> None:
    surface, _ = made(FRUSTUM)
    assert isinstance(surface, RuledSurface)
    shape = net(surface, worst_v=1.0 / 3.0)
    area = np.linalg.norm(normals(shape)[shape.joined], axis=-1)
    assert area.min() > 0.05 * area.max()
    assert shape.worst is not None
    assert shape.v[shape.worst] == pytest.approx(1.0 / 3.0)


@pytest.mark.parametrize("kind", [FRUSTUM, CONE, PIPE, SLENDER, SADDLE])
def test_no_surface_is_seen_edge_on(kind: Mapping[str, object]) -> None:
    surface, _ = make(kind)
    assert isinstance(surface, RuledSurface)
    shape = net(surface)
    frame = view_direction(shape)
    area = normals(shape).reshape(-1, 3)
    assert np.abs(area @ frame[2]).sum() > 0.5 * np.linalg.norm(area, axis=1).sum()
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-12)
    assert frame[0, 2] == 0.0, "z stays upright"


def test_a_viewer_in_front_sees_x_to_the_right() -> None:
    assert frame_of(-90.0, 0.0) == pytest.approx(np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]), abs=1e-15)


def test_a_slender_pattern_is_shown_long() -> None:
    _, pattern = made(SLENDER)
    wide = page.Box(0.0, 0.0, 11.0, 3.0)
    assert pattern_room(pattern, turned=True).shown_in(wide) > 6.0
    assert pattern_room(pattern, turned=False).shown_in(wide) < 2.0


@pytest.mark.parametrize("turned", [False, True])
def test_a_pattern_with_its_dimensions_stays_in_its_box(*, turned: bool) -> None:
    _, pattern = made(SLENDER)
    box = page.Box(1.0, 2.0, 9.0, 6.0)
    placed = pattern_room(pattern, turned=turned).fit(box).place(corner_points(pattern))
    assert (placed.min(axis=0) > [box.left, box.bottom]).all()
    assert (placed.max(axis=0) < [box.right, box.top]).all()


def test_text_never_stands_on_its_head() -> None:
    assert [upright(angle) for angle in (0.0, 90.0, -90.0, 180.0, 135.0, 271.0)] == [0.0, 90.0, 90.0, 0.0, -45.0, -89.0]


def test_a_round_hole_is_named_by_its_diameter() -> None:
    _, pattern = made(PLATE)
    assert hole_text(pattern.inner[0].path) == "⌀80.00"
    assert hole_text(pattern.outer.path) == "300.00 × 200.00"
    assert [page.length_text(mm) for mm in (0.5, 1e4)] == ["0.500", "10000.0"]


def test_a_wide_surface_stands_over_its_pattern_and_a_tall_one_beside_it() -> None:
    around = page.Box(0.0, 0.0, 10.0, 6.0)
    wide, tall = (arrangement(around, seen, plate()) for seen in ((10.0, 1.0), (1.0, 10.0)))
    assert (wide.formed.width, wide.flat.top) == (10.0, wide.formed.bottom)
    assert (tall.formed.height, tall.flat.left) == (6.0, tall.formed.right)
    assert wide.formed.height < tall.formed.height
    assert tall.formed.width < wide.formed.width


@pytest.mark.parametrize(
    ("notes", "left"),
    [
        ([], 0),
        (["one"], 1),
        (["one", "two"], 1),
        (["one", "two " * 60, "three"], 4),
        (["one " * 60, "two"], 3),
        (["one", "two", "three " * 60], 2),
        (["one " * 200], 10),
    ],
)
def test_a_note_stays_in_its_column(notes: list[str], left: int) -> None:
    """Lines are of 92 signs: the long notes take three, the longest ten."""
    lines = wrapped(notes, 92, 10)
    first, second = in_columns(lines)
    assert [*first, *second] == lines
    assert len(first) == left
    assert not "".join(second[:1]).startswith(" ")


def test_a_picture_says_the_size_that_the_report_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sampled along its circle a pipe of 300 mm would be 299.98 mm wide."""
    said: list[str] = []
    monkeypatch.setattr("pipeline.report.pictures.surface.caption", lambda *words: said.append(words[-1]))
    arc = {"arc": {"center": [0, 0, 0], "radius": 150, "normal": [1, 0, 0], "start": 7, "end": 353}}
    surface, pattern = made({"kind": "cylinder", "directrix": arc, "direction": [1, 0, 0], "length": 80})
    part_picture(surface, pattern, ())
    (words,) = said
    assert "300.00" in words.split()
    assert "80.00" in words.split()
