"""Children that load nothing before their first job: what a runner under kills starts hundreds of times.

In the place of the small job that warms a child up there is an error, which `warm` takes for one of the first job.
"""

import sys

import tests.bench.soak

KEPT = tests.bench.soak
"""Loaded here, once, as every child asks for it."""

sys.modules["pipeline.job"] = None  # type: ignore[assignment]
import pipeline.batch.warm  # noqa: E402

del sys.modules["pipeline.job"]
WARM = pipeline.batch.warm
