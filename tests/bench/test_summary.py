"""How long the summary of many jobs takes: reports read, counted and shown."""

from pytest_benchmark.fixture import BenchmarkFixture

from pipeline.report.summary import summary_files
from tests.pipeline.test_summary import jobs

JOBS = 10_000


def test_ten_thousand_jobs_are_summarised(benchmark: BenchmarkFixture) -> None:
    files = benchmark.pedantic(lambda: summary_files(jobs(JOBS)), rounds=1)
    assert files["summary.csv"].count(b"\r\n") == JOBS + 1
    assert len(files["summary.html"]) < 1_000_000
