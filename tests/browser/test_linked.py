"""Both views of a part on the whole page: colours, cursor, choice of colours; with WebGL, without, and on a phone."""

import base64
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from pipeline.report.document import Document
from stages.geometry.arrays import Array
from tests.browser.chromium import WITH_WEBGL, WITHOUT_WEBGL, Page, needs_chromium, opened
from tests.browser.linked import ALLOWED, made
from tests.browser.pages import colours
from tests.browser.test_page import PIXELS
from tests.near import assert_near

pytestmark = needs_chromium
STEP = 1.0
"""Of 255: what colours may differ by from those computed here."""
U = np.linspace(0.1, 0.9, 5)
ROWS = np.array([6, 14, 22, 30, 38, 82, 90, 98, 106, 114])
READY = """new Promise((done) => {
  const look = () => current?.solid?.drawn > 0 ? setTimeout(done, 80) : setTimeout(look, 20); look(); })"""
MOVE = """(([x, y]) => { const { flat } = current, r = flat.canvas.getBoundingClientRect(), [px, py] = flat.place(x, y);
  const at = { clientX: r.left + px, clientY: r.top + py, bubbles: true };
  flat.canvas.dispatchEvent(new PointerEvent('pointermove', at)); })"""
NOTE = "document.querySelector('.solid .stage > div').textContent"
BEYOND = "current.flat.state.field.largest > current.flat.state.field.limit"


WAYS = {
    "webgl": (WITH_WEBGL, "?view=webgl", "webgl"),
    "no card": (WITH_WEBGL, "", "canvas"),
    "no webgl": (WITHOUT_WEBGL, "?view=webgl", "canvas"),
}
"""With which flags the page is opened, what is asked of it, and what it draws with; no card: WebGL by the processor."""


@pytest.fixture(scope="module", params=[WAYS["webgl"], WAYS["no webgl"]], ids=["webgl", "canvas"])
def shown(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Page, Document]]:
    file, _, view = made(tmp_path_factory.mktemp("page"))
    flags, query, kind = request.param
    with opened(file, tmp_path_factory.mktemp("profile"), *flags, query=query) as page:
        page.ask(READY)
        assert page.ask("current.solid.kind") == kind
        yield page, view


def rails(view: Document) -> Array:
    """Return both ends of the rulings in the flat frame, as the page reads them."""
    packed = view["formed"]["flat"]
    steps = np.frombuffer(base64.b64decode(packed["points"]), "<u2").reshape(-1, 2, 2)
    return np.asarray(np.array(packed["low"]) + packed["step"] * steps)


def strains(view: Document) -> Array:
    (field,) = [one for one in view["formed"]["fields"] if one["name"] == "bending"]
    return np.frombuffer(base64.b64decode(field["values"]), "<f4").astype(np.float64).reshape(-1, 2)


def places(view: Document) -> tuple[Array, Array]:
    """Return fifty places on rulings, and the strain there: along a ruling its inverse is linear."""
    ends, values = rails(view)[ROWS], strains(view)[ROWS]
    at = ends[:, None, 0] + U[:, None] * (ends[:, None, 1] - ends[:, None, 0])
    there = 1.0 / ((1.0 - U) / values[:, :1] + U / values[:, 1:])
    return at.reshape(-1, 2), there.ravel()


def test_strain_by_bending_has_the_colours_of_its_share_of_the_limit(shown: tuple[Page, Document]) -> None:
    page, view = shown
    page.ask("Object.assign(current.flat.state, {rulings: false, worst: null, cursor: null})")
    assert page.ask("current.flat.state.field.limit") == ALLOWED
    at, value = places(view)
    assert len(at) == 50
    assert np.ptp(value / ALLOWED) > 0.3
    found = np.array(page.ask(f"{PIXELS}({json.dumps(at.tolist())}, 0)"), dtype=float)
    assert np.abs(found - np.round(colours(value, ALLOWED))).max() <= STEP
    page.ask("Object.assign(current.flat.state, {rulings: true})")


def test_the_cursor_of_the_flat_view_is_shown_formed_with_its_value(shown: tuple[Page, Document]) -> None:
    page, view = shown
    at, value = places(view)
    for (x, y), strain in list(zip(at.tolist(), value.tolist(), strict=True))[::9]:
        page.ask(f"{MOVE}({[x, y]})")
        place, told = str(page.ask(NOTE)).split("\n")
        assert place.endswith(f"x {x:.1f}   y {y:.1f} mm flat")
        assert_near(
            float(told.split()[-2].replace("−", "-")), 100.0 * strain, bound=5e-3 * abs(100.0 * strain), why="3 digits"
        )
        assert f"x {x:.2f}" in str(page.ask("document.querySelector('.said').textContent"))
    page.ask("current.flat.canvas.dispatchEvent(new PointerEvent('pointerleave'))")
    assert page.ask(NOTE) == ""


def test_the_cursor_of_the_formed_view_is_shown_flat(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    over = "document.querySelectorAll('.solid canvas')[1]"
    page.ask(
        f"{over}.dispatchEvent(new PointerEvent('pointermove', ((r) => ({{ clientX: r.left + r.width / 2,"
        f" clientY: r.top + r.height / 3, bubbles: true }}))({over}.getBoundingClientRect())))"
    )
    x, y = (float(word) for word in str(page.ask(NOTE)).split("\n")[0].replace("x", "").split()[4:7:2])
    assert_near(page.ask("current.flat.state.cursor"), [x, y], bound=0.051, why="told to a tenth")
    page.ask(f"{over}.dispatchEvent(new PointerEvent('pointerleave'))")
    assert page.ask("current.flat.state.cursor") is None


def test_both_views_take_the_colours_that_are_chosen(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    choose = (
        "((s) => { s.value = '%s'; s.dispatchEvent(new Event('change')); })(document.querySelector('.view select'))"
    )
    formed = "document.querySelector('.solid select').value"
    assert page.ask(formed) == "bending"
    page.ask(choose % "")
    assert page.ask("current.flat.state.field") is None
    assert page.ask(formed) == "sides"
    page.ask(choose % "bending")
    assert page.ask("current.flat.state.field.name") == page.ask(formed) == "bending"


def test_without_a_graphics_card_a_canvas_is_quicker(tmp_path: Path) -> None:
    flags, query, kind = WAYS["no card"]
    with opened(made(tmp_path)[0], tmp_path / "profile", *flags, query=query) as page:
        page.ask(READY)
        assert page.ask("current.solid.kind") == kind
        page.ask("window.painters = [1, 20000].map((triangles) => planishPaint.painter(null, triangles))")
        assert page.ask("painters.map(({ kind }) => kind)") == ["canvas", "webgl"]
        page.ask("painters.forEach((one) => one.dispose())")
        assert page.ask("planishPaint.painter(null, 20000) === painters[1]")
        assert page.told == []


def test_a_part_that_is_opened_next_is_drawn_anew(shown: tuple[Page, Document]) -> None:
    """With WebGL on the canvas that is there, so that its programs need not be made again."""
    page, _ = shown
    page.ask("window.before = document.querySelector('.solid canvas')")
    page.ask("showPart(0)")
    assert page.ask("current.solid") is None
    page.ask(READY)
    kept = page.ask("current.solid.kind") == "webgl"
    assert page.ask("document.querySelector('.solid canvas') === window.before") is kept
    assert page.ask("document.querySelectorAll('.solid canvas').length") == 2


def test_numbers_and_flat_view_are_there_before_the_formed_one(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    first = (
        "showPart(0); new Promise((done) => requestAnimationFrame(() => "
        "done([Boolean(current.flat), Boolean(current.solid), byId('part-title').textContent])))"
    )
    assert page.ask(first) == [True, False, "frustum"]
    page.ask(READY)


def test_what_is_proved_is_said_to_be(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    said = str(page.ask("document.querySelector('.view').textContent"))
    assert "Strain of laying it flat: " in said
    assert "(sampled, limit " in said
    assert page.ask(BEYOND) is False


def test_whatever_can_be_reached_by_key_has_a_name(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    reached = [(node["role"]["value"], node["name"]["value"].strip()) for node in focusable(page)]
    assert {"button", "link", "combobox", "slider", "searchbox", "image"} <= {role for role, _ in reached}
    assert [role for role, name in reached if not name] == []


def focusable(page: Page) -> list[dict]:
    """Return what a screen reader is told of everything that takes the focus."""
    nodes = page._ask("Accessibility.getFullAXTree")["nodes"]
    takes = [
        any(one["name"] == "focusable" and one["value"]["value"] for one in node.get("properties", []))
        for node in nodes
    ]
    return [node for node, focus in zip(nodes, takes, strict=True) if focus and not node["ignored"]]


def test_it_opens_on_a_phone(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    page._ask("Emulation.setDeviceMetricsOverride", width=360, height=740, deviceScaleFactor=2, mobile=True)
    page._ask("Page.reload")
    page.ask("new Promise((done) => setTimeout(done, 300))")
    page.ask(READY)
    assert page.ask("document.documentElement.scrollWidth") <= 360
    widths = page.ask(
        "[...document.querySelectorAll('.view canvas')].map((c) => Math.round(c.getBoundingClientRect().width))"
    )
    assert isinstance(widths, list)
    assert 300 <= min(widths) <= max(widths) <= 360


def test_nothing_is_told_and_nothing_asked_for(shown: tuple[Page, Document]) -> None:
    page, _ = shown
    assert page.told == []
    assert page.requests == []
