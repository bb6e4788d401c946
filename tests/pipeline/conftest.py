"""A finished job that several modules of tests measure, made once."""

from pathlib import Path

import pytest

from pipeline.asmade.nominal import Nominal, nominal_of
from tests.pipeline.asmadejobs import JOB, planish
from tests.pipeline.jobs import write_job


@pytest.fixture(scope="session")
def made_job(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a job and its output in `out`."""
    here = tmp_path_factory.mktemp("asmade")
    planish("run", write_job(here, JOB), "-o", here / "out", "--quiet")
    return here


@pytest.fixture(scope="session")
def nominal(made_job: Path) -> Nominal:
    """Return what can be measured of it."""
    return nominal_of(made_job / "out")
