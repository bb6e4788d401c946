"""Reading back raises no alarm on random good jobs, one of each flavour and version."""

import pytest

from tests.readers.drawings import kinds
from tests.stages.write.goodjobs import alarms


@pytest.mark.parametrize("seed", range(len(kinds()), 2 * len(kinds())))
def test_a_good_job_raises_no_alarm(seed: int) -> None:
    assert alarms(seed) == []
