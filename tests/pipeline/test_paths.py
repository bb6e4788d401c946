"""Paths as text and as values."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.paths import Path, parsed, written


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ("part[0].surface.k0", ("part", 0, "surface", "k0")),
        ("units", ("units",)),
        ('job."a b"', ("job", "a b")),
        ("points[3][2]", ("points", 3, 2)),
    ],
)
def test_a_path_is_written_and_read(text: str, path: Path) -> None:
    assert parsed(text) == path
    assert written(path) == text


@pytest.mark.parametrize("text", ["a..b", ".a", "a b", "a[", "a[-1]", 'a"b"', "a.", r'"\q"', '"a\tb"', r'"\u12"', '"'])
def test_what_is_no_path_is_none(text: str) -> None:
    assert parsed(text) is None


@given(st.lists(st.text() | st.integers(0, 999), min_size=1).filter(lambda steps: isinstance(steps[0], str)))
def test_every_path_comes_back(steps: list[str | int]) -> None:
    assert parsed(written(tuple(steps))) == tuple(steps)
