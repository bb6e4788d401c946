"""A runner killed at its operations in turn: the batch goes on, nothing is lost, torn, or done twice."""

from pathlib import Path

import pytest

from tests.bench import soak
from tests.pipeline.batch.faults import Case, cases, every

STRIDE = 17
"""Of the operations that the runner is killed at here; `tests.bench.soak` takes every one."""
LEAST_OPERATIONS = 200
"""Of a run of 20 jobs: fewer, and the calls are no longer counted."""


def test_a_first_run_that_is_killed_goes_on(tmp_path: Path) -> None:
    case, _ = cases(tmp_path, 20)
    assert every(STRIDE, 1, case.disturbed) * STRIDE > LEAST_OPERATIONS


def test_a_run_over_older_results_that_is_killed_goes_on(tmp_path: Path) -> None:
    _, case = cases(tmp_path, 20)
    assert every(STRIDE, 2, case.disturbed) * STRIDE > LEAST_OPERATIONS


def test_a_run_that_is_killed_while_it_mends_another_goes_on(tmp_path: Path) -> None:
    def twice(case: Case, number: int) -> bool:
        return case.disturbed(number, 3 + number % 60)

    for case in cases(tmp_path, 8):
        assert every(2 * STRIDE, 7, lambda number, case=case: twice(case, number)) > 2


@pytest.mark.parametrize("size", [40_000, 250_000, 500_000])
def test_a_disk_that_is_full_leaves_nothing_torn_and_the_batch_goes_on(tmp_path: Path, size: int) -> None:
    try:
        assert soak.full(tmp_path, size, 60)
    except PermissionError as error:
        pytest.skip(str(error))


def test_runners_and_workers_that_are_killed_lose_nothing(tmp_path: Path) -> None:
    assert soak.kills(tmp_path, 3) > 0
