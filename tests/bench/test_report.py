"""The report of a thousand different parts: how long its formats take, how large they are, how soon a browser has it.

Processor seconds of one core, whatever else runs, but for what the browser does: that is by the clock.  All figures are
told at the end.  Where benchmarks are off, a few parts show that it all works, and nothing is timed.

Goals: the page with what it draws in 10 s and 60 MB, ready in 1.5 s, a part open in 0.3 s (its numbers and the flat
view are painted); 5 ms a part for the traveller.  `formed` is when the view that can be turned is painted, too: as the
page does without a graphics card, and with WebGL all the same.  `longest` is for how long it did not answer at most.
"""

import json
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from pipeline.job import job_of
from pipeline.jobfile import read
from pipeline.outputs import stored, views
from pipeline.report.document import document, encoded
from pipeline.report.render import FORMATS, Made
from pipeline.report.view.entries import VIEW
from pipeline.run import JobResult, run_job
from tests.bench.manyparts import FAMILIES, job_text
from tests.browser.chromium import WITH_WEBGL, Page, needs_chromium, opened
from tests.pipeline.jobs import write_job

COUNT, FEW = 1000, 12
PAGE_S, PAGE_BYTES, READY_MS, OPEN_MS = 10.0, 60e6, 1500.0, 300.0
MS_PER_PART = {"traveller": 5.0, "csv": 2.0, "junit": 2.0}
ROUNDS = 4
"""Of parts that are opened, one of each family a round."""
WAYS = {"no graphics card": "", "WebGL by the processor": "?view=webgl"}
"""What is asked of the page where it can have WebGL, and no graphics card is there."""
OPEN = """(async (number) => {
  const soon = () => new Promise((done) => setTimeout(done)), blocked = [0];
  const watch = new PerformanceObserver((list) => blocked.push(...list.getEntries().map((one) => one.duration)));
  watch.observe({ type: 'longtask' });
  const before = performance.now();
  goTo(number);
  while (current?.index !== number) await soon();
  await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  const flat = performance.now() - before;
  while (partAt(number).view.formed && !(current.solid?.drawn > 0)) await soon();
  document.querySelector('.solid canvas')?.getContext('webgl2')?.readPixels(0, 0, 1, 1, 6408, 5121, new Uint8Array(4));
  const formed = performance.now() - before;
  await new Promise((done) => setTimeout(done, 50));
  watch.disconnect();
  return [flat, formed, Math.max(...blocked)]; })"""


@pytest.fixture(scope="module")
def count(request: pytest.FixtureRequest) -> int:
    """Return how many parts there are: all where it is timed."""
    return FEW if request.config.getoption("benchmark_disable") else COUNT


@pytest.fixture(scope="module")
def told(request: pytest.FixtureRequest, count: int) -> Iterator[list[str]]:
    """Return the lines that are told at the end."""
    lines: list[str] = []
    yield lines
    if count == COUNT:
        with request.config.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
            print("", f"report of {count} parts", *(f"  {line}" for line in lines), sep="\n")


@cache
def ran(count: int) -> JobResult:
    """Return what became of the job; it is run once."""
    with TemporaryDirectory() as folder:
        made = run_job(job_of(read(write_job(Path(folder), job_text(count)))))
    return replace(made, job=replace(made.job, formats=("json", "html", "traveller", "csv", "junit")))


@cache
def made(count: int) -> Made:
    """Return its report and what is drawn of it."""
    report = encoded(document(ran(count), {}))
    return Made(json.loads(report), {**stored(ran(count)), **views(ran(count))})


def test_all_parts_pass(count: int) -> None:
    assert ran(count).status == "made"


def test_the_page_with_what_it_draws(benchmark: BenchmarkFixture, count: int, told: list[str]) -> None:
    def drawn() -> bytes:
        files = views(ran(count))
        return FORMATS["html"](Made(made(count).report, files))["report.html"]

    made(count)
    before = process_time()
    page = benchmark.pedantic(drawn, rounds=1)
    seconds = process_time() - before
    benchmark.extra_info |= {"seconds": seconds, "bytes": len(page)}
    told.append(f"page: {seconds:.2f} s of one core, {len(page) / 1e6:.1f} MB")
    assert count < COUNT or seconds <= PAGE_S
    assert len(page) <= PAGE_BYTES


@pytest.mark.parametrize("name", MS_PER_PART)
def test_a_format(name: str, benchmark: BenchmarkFixture, count: int, told: list[str]) -> None:
    given = made(count)
    before = process_time()
    files = benchmark.pedantic(FORMATS[name], (given,), rounds=1)
    each_ms = 1000.0 * (process_time() - before) / count
    benchmark.extra_info |= {"ms_per_part": each_ms, "bytes": sum(map(len, files.values()))}
    told.append(f"{name}: {each_ms:.2f} ms a part, {sum(map(len, files.values())) / 1e6:.2f} MB")
    assert all(files.values())
    assert count < COUNT or each_ms <= MS_PER_PART[name]


@needs_chromium
@pytest.mark.parametrize("way", WAYS)
def test_the_page_is_ready_and_parts_open(
    way: str, benchmark: BenchmarkFixture, tmp_path: Path, count: int, told: list[str]
) -> None:
    assert VIEW in made(count).files
    file = tmp_path / "report.html"
    file.write_bytes(FORMATS["html"](made(count))["report.html"])
    with opened(file, tmp_path / "profile", *WITH_WEBGL, query=WAYS[way]) as page:
        ready = page.ask("performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd")
        assert isinstance(ready, float | int)
        (first, *others) = benchmark.pedantic(opening, (page, count), rounds=1)
        flat, formed, longest = (max(one) for one in zip(first, *others, strict=True))
    benchmark.extra_info |= {"ready_ms": ready, "flat_ms": flat, "formed_ms": formed, "longest_ms": longest}
    told.append(
        f"{way}: ready {ready:.0f} ms; opened, worst of {len(others)}: flat {flat:.0f} ms, formed {formed:.0f} ms,"
        f" longest {longest:.0f} ms; the first: {', '.join(f'{one:.0f}' for one in first)} ms"
    )
    assert count < COUNT or ready <= READY_MS
    assert count < COUNT or flat <= OPEN_MS


def opening(page: Page, count: int) -> list[list[float]]:
    """Return flat, formed and longest of parts that are opened one after the other, ms, each of another family."""
    step = count // ROUNDS - count // ROUNDS % len(FAMILIES) + 1
    numbers = [(1 + step * i) % count for i in range(ROUNDS * len(FAMILIES))]
    found = [page.ask(f"{OPEN}({number})") for number in numbers]
    return [[float(one) for one in times] for times in found if isinstance(times, list)]
