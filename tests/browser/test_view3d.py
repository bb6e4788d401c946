"""The view of the formed part in chromium: with WebGL and without, places on screen, cursor, colours, rolling up.

The page (`view3d.html`) acts on the view as a person would and writes down what it finds; it is held here against the
surface itself.  A policy in its head makes every request an error.
"""

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from pipeline.report.html import LIBRARY, SCRIPTS
from pipeline.report.pictures.net import net, view_direction
from pipeline.report.view.formed import ruled_part
from stages.geometry.arrays import Array
from stages.geometry.ruled.ruled import at, curvature
from stages.model.surface import RuledSurface
from tests.browser.chromium import WITH_WEBGL, WITHOUT_WEBGL, needs_chromium, opened
from tests.near import assert_near, assert_relative
from tests.parts import passage

ASSETS = files("pipeline") / "data" / "report"
OWN = tuple(name for name in SCRIPTS if name.startswith("view3d"))
HERE = Path(__file__).parent
DRILLED = {"name": "fix", "kind": "drill", "at": [0.5, 0.5], "diameter": 60}
SHEET = {"kind": "cone", "radius0": 300, "radius1": 150, "height": 400, "sweep": 100}
U = np.array([0.0, 0.0, 0.0, 0.25, 0.75, 0.6])
V = np.array([0.2, 0.5, 0.9, 0.25, 0.8, 0.5])
ON_EDGE = 3
"""The places looked at: the first ones on the edge c0."""
IN_HOLE = np.array([0.5, 0.5])
BLUE = np.array([0, 114, 178])
PIXEL = 1.0
COVERED = 230
"""Of 255: where triangles meet on a canvas, ground shines through a little."""
WINDOW = (600.0, 430.0)


def part() -> tuple[RuledSurface, dict[str, object], Array]:
    """Return a drilled piece of a cone, its document, and the points looked at: the last one is in the hole."""
    made = passage(SHEET, hole=[DRILLED])
    assert isinstance(made.surface, RuledSurface)
    assert made.pattern is not None
    u, v = np.append(U, IN_HOLE[0]), np.append(V, IN_HOLE[1])
    return made.surface, ruled_part(made.surface, made.pattern, None), at(made.surface.patches[0], u, v)


def page(document: dict[str, object], points: Array, places: list[object], *, library: bool) -> str:
    """Return the page that looks at these places."""
    scripts = [(ASSETS / name).read_text("utf-8") for name in ((LIBRARY, *OWN) if library else OWN)]
    text = (HERE / "view3d.html").read_text("utf-8")
    text = text.replace("<!--SCRIPTS-->", "".join(f"<script>{script}</script>" for script in scripts))
    for name, value in (("PART", document), ("POINTS", points.tolist()), ("PLACES", places)):
        text = text.replace(f"/*{name}*/", json.dumps(value))
    return text


WAYS = {
    "webgl": (True, WITH_WEBGL, "webgl"),
    "no WebGL": (True, WITHOUT_WEBGL, "canvas"),
    "no library": (False, WITH_WEBGL, "canvas"),
}


@pytest.fixture(scope="module", params=WAYS.values(), ids=WAYS)
def seen(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict:
    library, flags, kind = request.param
    surface, document, points = part()
    places = [{"u": 0.25, "v": 0.5}, None]
    folder = tmp_path_factory.mktemp("page")
    file = folder / "page.html"
    file.write_text(page(document, points, places, library=library), "utf-8")
    with opened(file, folder / "profile", *flags) as shown:
        found = shown.ask("check()")
        assert isinstance(found, dict)
        found |= {"told": shown.told, "requests": shown.requests}
    assert found["kind"] == kind
    return found | {"surface": surface, "points": points, "document": document}


@needs_chromium
def test_nothing_is_asked_of_a_network_and_nothing_is_left(seen: dict) -> None:
    assert seen["requests"] == []
    assert seen["told"] == []
    assert seen["left"] == 0
    assert seen["silent"]


@needs_chromium
def test_points_stand_where_they_are_projected(seen: dict) -> None:
    expected = projected(seen["surface"], seen["points"])
    assert_near(seen["projected"], expected, bound=PIXEL, why="the view is parallel")
    assert_near(seen["again"], expected, bound=PIXEL, why="Home is the first view")


def projected(surface: RuledSurface, points: Array) -> Array:
    """Return where points stand in the first view: in the middle, as large as there is room for."""
    shape = net(surface)
    frame = view_direction(shape)
    corners = shape.points.reshape(-1, 3) @ frame.T
    low, high = corners.min(axis=0), corners.max(axis=0)
    room = np.array([WINDOW[0] - 84.0, WINDOW[1] - 124.0])
    scale = float((room / (high - low)[:2]).min())
    away = (points @ frame.T - (low + high) / 2.0)[:, :2] * scale
    return away * [1.0, -1.0] + [WINDOW[0] / 2.0, WINDOW[1] / 2.0 - 9.5]


@needs_chromium
def test_an_edge_is_drawn_within_a_pixel_of_its_projection(seen: dict) -> None:
    for around in seen["near"][:ON_EDGE]:
        away = np.abs(np.array(around)[:, :3] - BLUE).max(axis=1)
        assert away.min() <= 8, around


@needs_chromium
def test_a_hole_is_seen_through(seen: dict) -> None:
    *sheet, hole = seen["near"]
    assert np.array(hole)[:, 3].max() == 0
    assert np.array(sheet)[ON_EDGE:, :, 3].min() >= COVERED


@needs_chromium
def test_the_cursor_tells_the_place_it_is_over(seen: dict) -> None:
    *found, none = seen["cursors"]
    assert none is None
    inside = found[ON_EDGE:]
    assert_near([one["u"] for one in inside], U[ON_EDGE:], bound=5e-3, why="a pixel is 1 mm of 400")
    assert_near([one["v"] for one in inside], V[ON_EDGE:], bound=5e-3, why="a pixel is 1 mm of 260")


@needs_chromium
def test_the_flat_place_of_the_cursor_is_that_of_the_pattern(seen: dict) -> None:
    reach = [np.hypot(one["x"], one["y"]) for one in seen["cursors"][ON_EDGE:-1]]
    start = at(seen["surface"].patches[0], np.zeros(1), np.zeros(1))
    chord = np.linalg.norm(seen["points"][ON_EDGE:-1] - start, axis=1)
    assert (np.array(reach) >= chord - 2.0).all()
    assert (np.array(reach) <= np.pi / 2.0 * chord + 2.0).all()


@needs_chromium
def test_a_place_of_the_flat_view_is_shown_with_its_value(seen: dict) -> None:
    shown, gone = seen["notes"]
    assert shown.startswith("u 0.250   v 0.500   x ")
    assert gone == ""


@needs_chromium
def test_dragging_and_keys_move_the_view(seen: dict) -> None:
    first, turned, zoomed = (np.array(seen[name]) for name in ("projected", "turned", "zoomed"))
    assert np.abs(turned - first).max() > 10.0
    spread = [np.ptp(one, axis=0).max() for one in (turned, zoomed)]
    assert_relative(spread[1], 1.2 * spread[0], bound=1e-9, why="one step of zoom")


@needs_chromium
def test_the_scale_is_locked_and_colours_are_of_curvature(seen: dict) -> None:
    scale, _ = seen["ends"]
    blue, orange, white = [0, 114, 178], [213, 94, 0], [255, 255, 255]
    half = [[(a + b) / 2 for a, b in zip(end, white, strict=True)] for end in (blue, orange)]
    assert scale == [blue, blue, half[0], white, half[1], orange]
    red, green, sky, alpha = seen["field"]
    assert alpha >= COVERED
    assert red != sky
    assert (red > sky) == (curvature(seen["surface"].patches[0], np.array([0.5]), 0.5)[0] > 0.0)
    assert min(red, sky) <= green <= max(red, sky)


@needs_chromium
def test_the_part_is_rolled_out_without_strain(seen: dict) -> None:
    _, rolled = seen["ends"]
    size = seen["surface"].size_mm
    assert rolled["plane"] <= 1e-4 * size
    for pose in rolled["poses"]:
        assert_relative(pose, rolled["flat"], bound=1e-3, why="chords of 120 pieces against their arcs")
