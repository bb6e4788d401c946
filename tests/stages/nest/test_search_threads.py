"""How many threads search: no more than there are cores, fewer where the environment says so."""

import pytest

from stages.nest import search


def test_no_more_threads_search_than_cores_may_be_used(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    monkeypatch.setattr(search.os, "sched_getaffinity", lambda _: {0, 3, 5})
    assert search.threads() == len({0, 3, 5})
    for said, wanted in (("1", 1), ("0", 1), ("64", 3), ("all", 3)):
        monkeypatch.setenv("NUMBA_NUM_THREADS", said)
        assert search.threads() == wanted
