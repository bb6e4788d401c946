"""The mark of the tests that ask other programs: `-m "not readers"` leaves them out."""

import pytest


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "readers: asks a program of somebody else, skipped where it is not installed")
