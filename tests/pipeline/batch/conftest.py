"""What the tests of the commands of a batch share."""

import pytest

from pipeline.batch import commands
from tests.pipeline.batch.inprocess import InProcess


@pytest.fixture
def executor(monkeypatch: pytest.MonkeyPatch) -> InProcess:
    """Put the executor of the test in the place of the children."""
    stand_in = InProcess()
    monkeypatch.setattr(commands, "executor_of", lambda *_args: stand_in)
    return stand_in
