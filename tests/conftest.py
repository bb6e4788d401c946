"""Where shapes and types are checked at every call: in tests of single stages.

Tests of whole jobs run them as users do.  The checks take two thirds of the time of a job, and what a job calls has
tests of its own in which they are on.
"""

from collections.abc import Iterator

import pytest

WHOLE_JOBS = tuple(
    f"tests.{name}" for name in ("pipeline.", "readers.", "browser.", "fuzz.", "test_samples", "test_sample_kinds")
)


@pytest.fixture(scope="module", autouse=True)
def _checked(request: pytest.FixtureRequest) -> Iterator[None]:
    """Switch the checks off in modules of tests of whole jobs."""
    import jaxtyping

    before = jaxtyping.config.jaxtyping_disable
    jaxtyping.config.update("jaxtyping_disable", before or request.module.__name__.startswith(WHOLE_JOBS))
    yield
    jaxtyping.config.update("jaxtyping_disable", before)
