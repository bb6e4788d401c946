"""Times are those of the call, memory that of its peak and not of what stays."""

import sys
import time

import numpy as np
import pytest

from tests.bench import timing
from tests.bench.timing import measured, once

BLOCK_MB = 48


def test_the_seconds_are_those_that_the_call_takes() -> None:
    took = measured(lambda: time.sleep(0.02), rounds=3)
    assert 0.02 <= took.seconds < 0.5
    assert took.how == "median of 3"


def test_a_long_call_is_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timing, "LONG_S", 0.01)
    calls: list[int] = []
    took = measured(lambda: (calls.append(1), time.sleep(0.02)), rounds=5)
    assert (len(calls), took.how) == (1, "one run")


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel's mark is that of Linux")
def test_memory_is_that_of_the_peak_within_the_call() -> None:
    def peak() -> float:
        return float(np.ones(BLOCK_MB << 17).sum())

    for _ in range(2):
        _, _, memory = once(peak)
        assert memory is not None
        assert 0.9 * BLOCK_MB <= memory <= 1.5 * BLOCK_MB
    _, _, little = once(lambda: 1.0)
    assert little is not None
    assert little <= 0.2 * BLOCK_MB
