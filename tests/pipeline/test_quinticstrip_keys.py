"""What each further patch of a quintic strip takes depends on the first: no key is missing, none is for nothing."""

from pathlib import Path

import pytest

from pipeline.jobfile import read
from stages.errors import BadInputError
from tests.samples import SAMPLES

LAST = "s1 = 0.2\ng = 1\n"
"""How the last patch of the body of the bag ends, which goes on from a cylinder."""


def complaints(folder: Path, end: str) -> list[str]:
    """Return what is said of the bag where the further patch of its body ends so."""
    head, next_, rest = (SAMPLES / "bag" / "job.toml").read_text("utf-8").partition("[[part.surface.next]]")
    assert LAST in rest
    (folder / "job.toml").write_text(head + next_ + rest.replace(LAST, end, 1), "utf-8")
    try:
        read(folder / "job.toml", [])
    except BadInputError as error:
        return [problem.message for problem in error.problems]
    return []


@pytest.mark.parametrize(
    ("end", "said"),
    [
        (LAST, []),
        ("g = 1\n", ["missing after a quintic-cylinder"]),
        (LAST + "beta1 = 20\n", ["not used after a quintic-cylinder"]),
    ],
)
def test_a_further_patch_takes_what_goes_on_from_the_first(tmp_path: Path, end: str, said: list[str]) -> None:
    assert complaints(tmp_path, end) == said
