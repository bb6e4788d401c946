"""The pages of the samples that take long to make, in chromium: everything of them is shown."""

from pathlib import Path

import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from tests.browser.chromium import WITHOUT_WEBGL, needs_chromium, opened
from tests.browser.everything import everything
from tests.browser.test_samples import SLOW, sample_page


@needs_chromium
@pytest.mark.parametrize("name", SLOW)
def test_everything_of_a_sample_is_shown(
    name: str, benchmark: BenchmarkFixture, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    if request.config.getoption("benchmark_disable"):
        pytest.skip("made where benchmarks are run")
    file, parts, sheets = sample_page(name, tmp_path)
    with opened(file, tmp_path / "profile", *WITHOUT_WEBGL) as page:
        assert benchmark.pedantic(everything, (page,), rounds=1) == (parts, sheets, [])
