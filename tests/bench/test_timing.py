"""Times are those of the call, memory that of its peak and not of what stays."""

import subprocess
import sys
import time

import pytest

from tests.bench import timing
from tests.bench.timing import measured

BLOCK_MB = 48
PEAKS = f"""
import numpy as np
from tests.bench.timing import once

print(*(once(lambda: float(np.ones({BLOCK_MB} << 17).sum()))[2] for _ in range(3)), once(lambda: 1.0)[2])
"""


def test_the_seconds_are_those_that_the_call_takes() -> None:
    took = measured(lambda: time.sleep(0.02), rounds=3)
    assert 0.02 <= took.seconds < 10.0
    assert took.how == "median of 3"


def test_a_long_call_is_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timing, "LONG_S", 0.01)
    calls: list[int] = []
    took = measured(lambda: (calls.append(1), time.sleep(0.02)), rounds=5)
    assert (len(calls), took.how) == (1, "one run")


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel's mark is that of Linux")
def test_memory_is_that_of_the_peak_within_the_call() -> None:
    """In a process of its own: what else a process has done decides what its heap can give back."""
    told = subprocess.run([sys.executable, "-c", PEAKS], capture_output=True, text=True, check=True).stdout.split()
    *peaks, little = map(float, told)
    assert len(peaks) == 3
    assert all(0.9 * BLOCK_MB <= peak <= 1.5 * BLOCK_MB for peak in peaks)
    assert little <= 0.2 * BLOCK_MB
