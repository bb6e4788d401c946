"""Jobs with parts, stock or gaps that nothing can be nested with: refused at once, by name, by the first to see it."""

import time
from pathlib import Path

import pytest

from pipeline.cli import main
from tests.pipeline.jobs import STOCK, write_job

HEAD = 'schema = 1\n[report]\nformats = ["json"]\n'
GOOD = """
[[part]]
name = "good"
[part.surface]
kind = "flat"
outline = { polyline = [[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]] }
"""
SQUARE = "[[0, 0], [50, 0], [50, 50], [0, 50], [0, 0]]"
LOOPED = "[[0, 0], [50, 0], [50, 9], [30, 9], [30, -9], [9, -9], [0, 9], [0, 0]]"
FULL = "[[0, 0], [100, 0], [100, 60], [0, 60], [0, 0]]"
LIMIT_S = 10.0
"""Of processor time, with checks of shapes and other work on the machine; a free core takes under a quarter of it."""


def part(outline: str, holes: str = "", keys: str = "") -> str:
    inner = f"holes = [{holes}]\n" if holes else ""
    return f'[[part]]\nname = "bad"\n{keys}[part.surface]\nkind = "flat"\noutline = {outline}\n{inner}'


def polyline(points: str) -> str:
    return f"{{ polyline = {points} }}"


def box(low: float, high: float) -> str:
    return polyline(f"[[{low}, {low}], [{high}, {low}], [{high}, {high}], [{low}, {high}], [{low}, {low}]]")


BAD_PARTS = {
    "a bow-tie": part(polyline("[[0, 0], [50, 50], [50, 0], [0, 50], [0, 0]]")),
    "an outline that crosses itself": part(polyline(LOOPED)),
    "no area": part(polyline("[[0, 0], [50, 0], [20, 0], [0, 0]]")),
    "two points": part(polyline("[[0, 0], [50, 0]]")),
    "one point": part(polyline("[[0, 0]]")),
    "no points": part(polyline("[]")),
    "one point many times": part(polyline("[[1, 1], [1, 1], [1, 1], [1, 1]]")),
    "a spike": part(polyline("[[0, 0], [50, 0], [50, 20], [50, 45], [50, 20], [0, 20], [0, 0]]")),
    "an open outline": part(polyline("[[0, 0], [50, 0], [50, 50]]")),
    "nan": part(polyline("[[0, 0], [nan, 0], [50, 50], [0, 0]]")),
    "inf": part(polyline("[[0, 0], [inf, 0], [50, 50], [0, 0]]")),
    "an angle that is no number": part(polyline(SQUARE), keys="rotations = [nan]\n"),
    "no angle": part(polyline(SQUARE), keys="rotations = []\n"),
    "a negative quantity": part(polyline(SQUARE), keys="quantity = -1\n"),
    "no copies": part(polyline(SQUARE), keys="quantity = 0\n"),
    "a name that is taken": part(polyline(SQUARE)).replace('"bad"', '"good"'),
    "too long": part(polyline("[[0, 0], [500, 0], [500, 5], [0, 5], [0, 0]]")),
    "too high as it must lie": part(polyline("[[0, 0], [5, 0], [5, 61], [0, 61], [0, 0]]"), keys="rotations = [0]\n"),
    "a hole outside": part(box(0, 50), box(60, 70)),
    "a hole across the outline": part(box(0, 50), box(40, 60)),
    "a hole round the part": part(box(0, 50), box(-10, 60)),
    "holes that cross": part(box(0, 50), f"{box(10, 30)}, {box(20, 40)}"),
    "a hole in a hole": part(box(0, 50), f"{box(10, 40)}, {box(20, 30)}"),
    "a hole that crosses itself": part(box(0, 50), polyline("[[10, 10], [40, 40], [40, 10], [10, 40], [10, 10]]")),
    "a hole of no area": part(box(0, 50), polyline("[[10, 10], [40, 10], [20, 10], [10, 10]]")),
}

BAD_REST = {
    "a sheet of no height": STOCK.replace("height = 60", "height = 0"),
    "a sheet of negative width": STOCK.replace("width = 100", "width = -100"),
    "a sheet whose width is no number": STOCK.replace("width = 100", "width = nan"),
    "a sheet without end": STOCK.replace("width = 100", "width = inf"),
    "an edge gap that leaves no room": STOCK + "edge_gap = 30\n",
    "a negative edge gap": STOCK + "edge_gap = -1\n",
    "no sheets": STOCK + "quantity = 0\n",
    "the same stock twice": STOCK + STOCK,
    "a negative gap": STOCK + "[nest]\ngap = -1\n",
    "a gap wider than the sheet": STOCK + "[nest]\ngap = 5000\n",
    "a gap that is no number": STOCK + "[nest]\ngap = nan\n",
    "no time": STOCK + "[nest]\ntime_limit = -3\n",
    "a seed that is none": STOCK + "[nest]\nseed = -1\n",
    "an outline of stock that crosses itself and encloses nothing": '[[stock]]\nid = "bad"\nkind = "hide"\noutline = '
    + polyline("[[0, 0], [90, 0], [40, 0], [0, 0]]\n").replace("\n", "")
    + "\n",
}


def told(tmp_path: Path, text: str, capfd: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """Return the exit code and what was said of a job; it took no time, and left no cut file."""
    job = write_job(tmp_path, text)
    start = time.process_time()
    with pytest.raises(SystemExit) as ended:
        main(["run", str(job), "-o", str(tmp_path / "out")])
    assert time.process_time() - start < LIMIT_S
    said = capfd.readouterr().err
    assert "Traceback" not in said
    assert "internal error" not in said
    assert not (tmp_path / "out" / "cut").exists()
    return int(str(ended.value.code)), said


@pytest.fixture(scope="module", autouse=True)
def _warm(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Run a job once, so that no import counts as time of another."""
    folder = tmp_path_factory.mktemp("warm")
    with pytest.raises(SystemExit) as ended:
        main(["run", str(write_job(folder, HEAD + GOOD + STOCK)), "-o", str(folder / "out"), "--quiet"])
    assert ended.value.code == 0


@pytest.mark.parametrize("name", BAD_PARTS)
def test_a_part_that_cannot_be_nested_is_refused_at_once_by_name(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    code, said = told(tmp_path, HEAD + GOOD + BAD_PARTS[name] + STOCK, capfd)
    assert code in {1, 2, 3}
    assert any(word in said for word in ("bad", "part[1]")), said


@pytest.mark.parametrize("name", BAD_REST)
def test_stock_and_wishes_that_mean_nothing_are_refused_at_once(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    code, said = told(tmp_path, HEAD + GOOD + BAD_REST[name], capfd)
    assert code in {2, 3}
    assert any(word in said for word in ("stock[", "nest.", "gap")), said


ODD_PARTS = {
    "far from the origin": part(polyline("[[1e5, -1e5], [100050, -1e5], [100050, -99970], [1e5, -1e5]]")),
    "clockwise": part(polyline("[[0, 0], [0, 30], [40, 30], [40, 0], [0, 0]]")),
    "exactly as large as the sheet": part(polyline(FULL), keys="rotations = [0]\n"),
}


@pytest.mark.parametrize("name", ODD_PARTS)
def test_what_is_merely_odd_is_cut(name: str, tmp_path: Path) -> None:
    job = write_job(tmp_path, HEAD + GOOD + ODD_PARTS[name] + STOCK + "[nest]\ntime_limit = 0.01\n")
    with pytest.raises(SystemExit) as ended:
        main(["run", str(job), "-o", str(tmp_path / "out"), "--quiet"])
    assert ended.value.code == 0
    assert (tmp_path / "out" / "cut").exists()
