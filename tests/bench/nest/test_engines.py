"""Engines as children: what they tell is kept, what they do else ends neither the benchmark nor this test."""

import sys
from time import monotonic

import msgspec
import pytest

from tests.bench.nest.engines import ENGINES, Engine, Run, run_command, version
from tests.bench.nest.rivals import wire

LAYOUT = '{"placed": [{"part": "a", "stock": "s", "sheet": 0, "x": 1, "y": 2, "angle_deg": 90}]}'


def child(code: str, limit_s: float = 10.0, request: bytes = b"") -> Run:
    return run_command([sys.executable, "-S", "-c", code], request, limit_s)


def test_every_layout_is_kept_in_order() -> None:
    found = child(f'print({LAYOUT!r}); print(\'{{"error": "later"}}\')')
    assert [len(one.placed) for one in found.said] == [1, 0]
    assert found.said[0].placed[0].angle_deg == 90.0
    assert found.said[1].error == "later"


def test_the_request_reaches_the_child() -> None:
    found = child("import sys; print(sys.stdin.read())", request=b'{"error": "heard"}')
    assert [one.error for one in found.said] == ["heard"]


def test_a_crash_is_told_with_its_last_line_and_keeps_the_layouts_before() -> None:
    found = child(f"print({LAYOUT!r}, flush=True); raise ValueError('broken')")
    assert len(found.said[0].placed) == 1
    assert "exit code 1" in found.said[1].error
    assert "broken" in found.said[1].error


def test_a_line_that_is_no_answer_is_an_error() -> None:
    assert "not understood" in child("print('progress: 3 of 4')").said[0].error


def test_a_child_that_does_not_end_is_ended_and_counts_with_what_it_told() -> None:
    start = monotonic()
    found = child(f"import time; print({LAYOUT!r}, flush=True); time.sleep(60)", limit_s=0.5)
    assert monotonic() - start < 10.0
    assert [len(one.placed) for one in found.said] == [1]


def test_processor_time_of_the_child_is_counted() -> None:
    busy = child("import time\nend = time.process_time() + 0.3\nwhile time.process_time() < end: pass")
    assert busy.cpu_s >= 0.3 - 0.02, "the system counts in ticks of 10 ms"
    assert busy.wall_s >= 0.3 - 0.02


def test_an_engine_that_is_not_there_has_no_version() -> None:
    assert version(Engine("none", "stages.no_such_engine", "none", ("x.py",))) is None
    assert version(ENGINES[0]) is not None


def test_a_set_of_angles_becomes_the_most_equal_steps_that_are_all_allowed() -> None:
    assert wire.equal_steps([0.0]) == 1
    assert wire.equal_steps([0.0, 180.0]) == 2
    assert wire.equal_steps([0.0, 90.0, 180.0, 270.0]) == 4
    assert wire.equal_steps([0.0, 5.0, 10.0, 175.0, 180.0, 185.0]) == 2
    assert wire.equal_steps([0.0, 90.0]) == 1
    assert wire.equal_steps([0.0, -120.0, 120.0]) == 3


SQUARE = {"id": "a", "count": 2, "outer": [[0, 0], [10, 0], [10, 10], [0, 10]], "holes": []}
STRIP = {"strip": [1.0, 11.0, 1.0], "seconds": 1.2, "parts": [SQUARE]}


@pytest.mark.parametrize("needed", [21.0, 26.0, 39.0])
def test_bisection_comes_to_the_width_that_is_needed(needed: float, capsys: pytest.CaptureFixture[str]) -> None:
    def fill(width: float, seconds: float) -> list[wire.Table]:
        assert 0.0 < seconds <= 1.2
        spread = [wire.spot("a", ("strip", 0), (1.0 + k * (needed - 10.0), 1.0), 0.0) for k in range(2)]
        return spread if width >= needed else spread[:1]

    wire.narrowest(STRIP, fill)
    lines = [msgspec.json.decode(line) for line in capsys.readouterr().out.splitlines()]
    assert all(len(line["placed"]) == 2 for line in lines)
    assert lines[-1]["placed"][1]["x"] == needed - 9.0


def test_bisection_ends_with_the_time_where_nothing_is_ever_placed(capsys: pytest.CaptureFixture[str]) -> None:
    start = monotonic()
    wire.narrowest(STRIP | {"seconds": 0.6}, lambda *_: [])
    assert monotonic() - start < 5.0
    assert not capsys.readouterr().out
