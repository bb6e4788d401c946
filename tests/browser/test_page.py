"""The page of a report in chromium: what it shows and asks for, what a person does with it, what is on its canvas."""

import json
from collections.abc import Iterator

import numpy as np
import pytest

from tests.browser.chromium import WITHOUT_WEBGL, Page, needs_chromium, opened
from tests.browser.pages import HIGH, HOSTILE, LIMIT, PLATE, REFUSED, RULINGS, VALUE, WIDE, X, Y, colours, written

pytestmark = needs_chromium
NAMES = "[...document.querySelectorAll('#table tbody a')].map((a) => a.textContent)"
PIXELS = """((places, reach) => { const plan = current.flat; plan.paint();
  const { width, height } = plan.canvas;
  const copy = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  copy.drawImage(plan.canvas, 0, 0);
  return places.map(([x, y]) => {
  const [px, py] = plan.place(x, y).map(Math.floor), n = 2 * reach + 1;
  return [...copy.getImageData(px - reach, py - reach, n, n).data].filter((_, i) => i % 4 !== 3); }); })"""
STEP = 1.0
"""Of 255: what colours may differ by from those computed here."""
RULING = (0x7D, 0x87, 0x91)
NEAR = 55
"""Of 255: what a pixel that a line of one pixel half covers may differ by from its colour; the ground does by 102."""


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    file = written(tmp_path_factory.mktemp("page"))
    with opened(file, tmp_path_factory.mktemp("profile"), *WITHOUT_WEBGL) as browser:
        yield browser


def go(page: Page, name: str) -> None:
    page.ask(f"goTo(rowOf.get({json.dumps(name)}));new Promise((done) => setTimeout(done, 120))")


def pixels(page: Page, places: list[list[float]], reach: int) -> np.ndarray:
    found = page.ask(f"{PIXELS}({json.dumps(places)}, {reach})")
    return np.array(found, dtype=float).reshape(len(places), -1, 3)


def test_it_says_the_verdict_and_puts_failures_first(page: Page) -> None:
    assert "2 of 3 parts failed" in str(page.ask("byId('verdict').textContent"))
    assert page.ask(NAMES) == [PLATE, REFUSED, HOSTILE]


def test_names_stay_text(page: Page) -> None:
    go(page, HOSTILE)
    assert page.ask("document.querySelectorAll('img').length") == 0
    assert page.ask("document.querySelectorAll('script').length") == 3
    assert page.ask("byId('part-title').textContent") == HOSTILE
    assert page.ask("document.title") != "taken"


def test_filters_and_sorts(page: Page) -> None:
    page.ask("byId('find').value = 'ÄÖ'; byId('find').dispatchEvent(new Event('input'))")
    assert page.ask(NAMES) == [PLATE]
    page.ask("byId('find').value = ''; byId('show').value = 'passed'; byId('show').dispatchEvent(new Event('change'))")
    assert page.ask(NAMES) == [HOSTILE]
    page.ask("byId('show').value = 'all'; byId('show').dispatchEvent(new Event('change')); sortBy(0)")
    rising = page.ask(NAMES)
    page.ask("sortBy(0)")
    assert page.ask(NAMES) == rising[::-1] != rising
    assert page.ask("document.querySelector('#table th').ariaSort") == "descending"
    page.ask("table.column = -1; headings(); fillTable()")


def test_keys_step_through_the_table_and_move_the_pattern(page: Page) -> None:
    go(page, HOSTILE)
    press = "dispatchEvent(new KeyboardEvent('keydown', {key: '%s', bubbles: true, cancelable: true}))"
    page.ask("document.querySelector('#table tbody a').focus(); document.activeElement." + press % "ArrowDown")
    assert page.ask("document.activeElement.textContent") == REFUSED
    before = page.ask("current.flat.k")
    page.ask("current.flat.canvas." + press % "+")
    assert page.ask("current.flat.k") == pytest.approx(1.3 * before)
    page.ask("current.flat.canvas." + press % "0")
    assert page.ask("current.flat.k") == pytest.approx(before)
    assert page.ask("[...document.querySelectorAll('canvas')].every((c) => c.tabIndex === 0 && c.ariaLabel)")


def test_colours_on_the_canvas_are_those_of_the_strains(page: Page) -> None:
    go(page, HOSTILE)
    page.ask("Object.assign(current.flat.state, {rulings: false, worst: null, cursor: null, signs: false})")
    inside = [(j, i) for j in range(1, X.shape[0] - 1) for i in range(1, X.shape[1] - 1)][:50]
    rows, columns = np.transpose(inside)
    shown = pixels(page, np.column_stack([X[rows, columns], Y[rows, columns]]).tolist(), 0)[:, 0]
    assert len(shown) == 50
    assert np.abs(shown - np.round(colours(VALUE[rows, columns]))).max() <= STEP


def test_signs_stand_where_the_limit_is_exceeded_and_nowhere_else(page: Page) -> None:
    go(page, HOSTILE)
    far = np.abs(VALUE) / LIMIT
    inside = np.zeros(far.shape, dtype=bool)
    inside[1:-1, 1:-1] = True
    state = "Object.assign(current.flat.state, {rulings: false, worst: null, cursor: null, signs: %s})"
    shown = []
    for signs in ("true", "false"):
        page.ask(state % signs)
        shown += [
            [
                pixels(page, np.column_stack([X[at], Y[at]]).tolist(), 8)
                for at in (inside & (far > 1.1), inside & (far < 0.9))
            ]
        ]
    (beyond, within), (bare, kept) = shown
    assert len(beyond) > 5
    assert (np.abs(beyond - bare).max(axis=(1, 2)) > 50.0).all()
    assert (within == kept).all()


def test_rulings_are_drawn_within_a_pixel(page: Page) -> None:
    go(page, HOSTILE)
    page.ask("Object.assign(current.flat.state, {rulings: true, worst: null, cursor: null, field: null})")
    along = [
        [ax + t * (bx - ax), ay + t * (by - ay)] for ax, ay, bx, by, _ in RULINGS for t in (0.1, 0.35, 0.5, 0.8)
    ]  # fmt: skip
    beside = [[x, y + 5.0] for x, y in along]

    def found(places: list[list[float]]) -> np.ndarray:
        return (np.abs(pixels(page, places, 1) - RULING).max(axis=2) <= NEAR).any(axis=1)

    assert found(along).all()
    assert not found(beside).any()


def test_a_round_end_is_filled_to_its_rim(page: Page) -> None:
    go(page, PLATE)
    page.ask("Object.assign(current.flat.state, {worst: null, cursor: null})")
    angles = np.linspace(-1.4, 1.4, 9)
    rim = [[150.0 + r * np.cos(a), HIGH / 2.0 + r * np.sin(a)] for r in (47.0, 53.0) for a in angles]
    shown = pixels(page, rim, 0)[:, 0]
    assert (shown[:9] < 250.0).any(axis=1).all()
    assert (shown[9:] == 255.0).all()


def test_a_click_on_a_sheet_opens_the_part(page: Page) -> None:
    page.ask("byId('sheets').scrollIntoView(); new Promise((done) => setTimeout(done, 300))")
    click = """(([x, y]) => { const { plan } = document.querySelector('.sheet');
      const r = plan.canvas.getBoundingClientRect();
      const [px, py] = plan.place(x, y);
      const at = { clientX: r.left + px, clientY: r.top + py, pointerId: 1, bubbles: true };
      plan.canvas.setPointerCapture = () => {};
      for (const kind of ['pointerdown', 'pointerup']) plan.canvas.dispatchEvent(new PointerEvent(kind, at)); })"""
    # the plate is turned over and then by a quarter: (x, y) lies at (480 - y, 20 - x)
    for place, name in (([10.0 + WIDE / 2.0, 60.0], HOSTILE), ([430.0, 15.0], PLATE)):
        page.ask(f"{click}({place});new Promise((done) => setTimeout(done, 150))")
        assert page.ask("byId('part-title').textContent") == name


def test_what_is_not_all_is_not_shown_as_all(page: Page) -> None:
    assert page.ask("[0.9996, 1, 0.12345].map(percent)") == ["99.9\u00a0%", "100\u00a0%", "12.3\u00a0%"]
    assert page.ask("shown(-1.5e-7)") == "\u22121.5e\u22127"


WRITTEN = """(() => { const said = [], none = () => {};
  const bar = { closed: true, points: [0, 0, 0, 100, 0, 0, 100, 10, 0, 0, 10, 0] };
  const context = { strokeText: (text) => said.push(text) };
  for (const name of ['beginPath', 'moveTo', 'lineTo', 'closePath', 'fill', 'stroke', 'fillText']) context[name] = none;
  for (const angle of [0, 90]) drawCopy({ context, place: (x, y) => [x, -y], k: 1 }, { index: 0, contours: [bar],
    label: [50, 5], placement: { part: 'bar', copy: angle, angle, mirrored: false }, move: (x, y) => [x, y] }, false);
  return said; })()"""


def test_a_name_that_is_wider_than_its_copy_as_it_lies_is_left_out(page: Page) -> None:
    assert page.ask(WRITTEN) == ["bar 0"]


def test_the_cost_of_all_sheets_is_told_as_far_as_it_is_known(page: Page) -> None:
    total = {"price": 125.0, "offcut_credit": 14.2605, "net": 110.7395, "cut_length_mm": 4500.25, "pierces": 7}
    told = "costFacts(%s).textContent"
    assert page.ask(told % json.dumps({**total, "time_s": 90.5})) == (
        "Price125.00Offcuts worth14.26Net110.74Cut length4500.3\u00a0mmPierces7Cutting time90.5\u00a0s"
    )
    unknown = {**total, "price": None, "offcut_credit": 0.0, "net": None, "time_s": None}
    assert page.ask(told % json.dumps(unknown)) == "Cut length4500.3\u00a0mmPierces7"


WITH_ALLOWANCES = """(() => {
  const part = partAt(0).report, flat = part.flat;
  part.flat = { ...flat, cut: { width: 158.5, height: 200 } };
  showPart(0);
  const text = byId('part').innerText;
  part.flat = flat;
  showPart(0);
  return text; })()"""


def test_a_part_with_allowances_says_how_large_its_blank_is(page: Page) -> None:
    assert "Blank with allowances\n158.5 \u00d7 200 mm" in str(page.ask(WITH_ALLOWANCES))
    assert "Blank with allowances" not in str(page.ask("byId('part').innerText"))


def test_money_has_two_decimals(page: Page) -> None:
    sheet = "showSheet({ ...report.nest.sheets[0], cost: %s }, 0).box.textContent"
    assert "Cost81.40" in str(page.ask(sheet % "81.40000000000001"))
    assert "Cost" not in str(page.ask(sheet % "null"))


def test_beyond_a_round_number_is_beyond_no_limit(page: Page) -> None:
    field = "{ title: 't', evidence: 'sampled', limit: 1, held: %s, at: () => 2 }"
    said = [page.ask(f"flatWords({{ field: {field % held}, flat: {{ rulings: [] }} }}, [0, 0])") for held in (0, 1)]
    assert [str(words).rpartition(" ")[2] for words in said] == ["scale", "limit"]


def test_it_turns_dark_and_is_narrow(page: Page) -> None:
    go(page, HOSTILE)
    was = page.ask("document.documentElement.dataset.theme")
    page.ask("byId('theme').click()")
    assert page.ask("document.documentElement.dataset.theme") != was
    page.ask("byId('theme').click()")
    screen = {"height": 740, "deviceScaleFactor": 1, "mobile": False}
    page._ask("Emulation.setDeviceMetricsOverride", width=360, **screen)
    for name in (HOSTILE, PLATE, REFUSED):
        go(page, name)
        assert page.ask("document.documentElement.scrollWidth") <= 360
    page._ask("Emulation.setDeviceMetricsOverride", width=1000, **screen)


def test_nothing_is_told_and_nothing_asked_for(page: Page) -> None:
    for name in (HOSTILE, PLATE, REFUSED):
        go(page, name)
    assert page.told == []
    assert page.requests == []
