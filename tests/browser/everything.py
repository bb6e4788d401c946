"""Opens everything that a page of a report has: all parts, flat and formed, and all sheets."""

from typing import NamedTuple

from tests.browser.chromium import Page

WALK = """(async (patience) => {
  const frame = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  const until = async (there) => {
    for (let i = 0; i < patience && !there(); i += 1) await frame();
    return Boolean(there());
  };
  const pen = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true });
  const tones = (canvas) => {
    if (!canvas?.width) return 0;
    [pen.canvas.width, pen.canvas.height] = [canvas.width, canvas.height];
    pen.drawImage(canvas, 0, 0);
    return new Set(new Uint32Array(pen.getImageData(0, 0, canvas.width, canvas.height).data.buffer)).size;
  };
  const parts = [], sheets = [];
  for (const [index, { name }] of report.rows.entries()) {
    goTo(index);
    const { view } = partAt(index), isFormed = Boolean(view?.formed);
    const there = await until(() => current?.index === index && (!isFormed || current.solid?.drawn > 0));
    const flat = view?.flat ? tones(current.flat?.canvas) : null;
    const formed = isFormed ? tones(document.querySelector('.solid canvas')) : null;
    parts.push({ name, title: byId('part-title').textContent, there, flat, formed });
  }
  for (const box of document.querySelectorAll('.sheet')) {
    box.scrollIntoView({ behavior: 'instant' });
    await until(() => box.plan);
    await frame();
    sheets.push(tones(box.plan?.canvas));
  }
  return { parts, sheets, wanted: report.nest?.sheets?.length ?? 0 };
})"""
FRAMES = 1200
"""For a view to be there: some 20 s."""
LEAST_TONES = 4
"""What is drawn has more: ground, fill, line, and what lies between where they meet."""


class Seen(NamedTuple):
    """How many parts and sheets a page has, and what is wrong with them or was told."""

    parts: int
    sheets: int
    wrong: list[str]


def everything(page: Page, frames: int = FRAMES) -> Seen:
    """Open everything of the page that is open; frames: how long each view may take to be there."""
    found = page.ask(f"{WALK}({frames})")
    assert isinstance(found, dict)
    parts, sheets = found["parts"], found["sheets"]
    wrong = [f"{one['name']}: {fault}" for one in parts for fault in _faults(one)]
    wrong += [f"sheet {number} is not drawn" for number, tones in enumerate(sheets, 1) if tones < LEAST_TONES]
    if len(sheets) != found["wanted"]:
        wrong.append(f"{len(sheets)} of {found['wanted']} sheets")
    return Seen(len(parts), len(sheets), wrong + page.told + page.requests)


def _faults(part: dict) -> list[str]:
    """Return what is wrong with one part as it was shown."""
    faults = [] if part["there"] and part["title"] == part["name"] else ["did not open"]
    drawn = {view: part[view] for view in ("flat", "formed") if part[view] is not None}
    return faults + [f"{view} is not drawn" for view, tones in drawn.items() if tones < LEAST_TONES]
