"""What the README says of speed and accuracy is what BENCHMARKS.md holds, row by row.

A claim is a link whose text begins with its figure and unit and whose target is the anchor of a row: it has to agree
with a figure, time or memory of that row to the last digit that it gives.  In the section that is there for them no
number stands outside such a link.
"""

import re
from decimal import Decimal
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "BENCHMARKS.md"
SECTION = "## How fast, and beside what"
LINK = re.compile(r"\[([^\]]+)\]\(BENCHMARKS\.md#([^)\s]+)\)")
ROW = re.compile(r'<a id="([^"]+)"></a>(.*)')
FIGURE = re.compile(r"\s*(\d+(?:\.\d+)?(?:e[-+]?\d+)?)\s*(%|[A-Za-z/]*)")
MS = {"s": ("ms", Decimal(1000)), "min": ("ms", Decimal(60_000))}


def read(text: str) -> tuple[Decimal, Decimal, str] | None:
    """Return value, unit in the last place and unit of a figure that a text begins with; times in ms."""
    found = FIGURE.match(text)
    if found is None:
        return None
    value = Decimal(found[1])
    unit, factor = MS.get(found[2], (found[2], Decimal(1)))
    exponent = value.as_tuple().exponent
    assert isinstance(exponent, int)
    return factor * value, factor * Decimal(1).scaleb(exponent), unit


def agrees(claim: str, cell: str) -> bool:
    """Return whether a cell rounds to a claim."""
    said, measured = read(claim), read(cell)
    return (
        said is not None
        and measured is not None
        and said[2] == measured[2]
        and abs(said[0] - measured[0]) <= said[1] / 2
    )


def rows(page: str) -> dict[str, list[str]]:
    """Return the cells of every row by its anchor."""
    return {anchor: rest.split(" | ") for anchor, rest in ROW.findall(page)}


def wrong(readme: str, page: str) -> list[str]:
    """Return the claims that no cell of their row agrees with."""
    table = rows(page)
    claims = LINK.findall(readme)
    return [text for text, anchor in claims if not any(agrees(text, cell) for cell in table.get(anchor, []))]


def loose(readme: str) -> list[str]:
    """Return the numbers of the section that stand outside a link."""
    section = readme.partition(f"{SECTION}\n")[2].partition("\n## ")[0]
    return re.findall(r"\S*\d\S*", LINK.sub("", section))


def test_every_claim_of_the_readme_is_what_was_measured() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    assert wrong(readme, PAGE.read_text("utf-8") if PAGE.exists() else "") == []
    assert loose(readme) == []


TABLE = '| <a id="batch-a"></a>overhead | 1000 jobs | planish | 0.263 ms a job | 5.31 s | 45 MB | one run |\n'


@pytest.mark.parametrize("claim", ["0.26 ms a job", "0.263 ms", "5.3 s", "5310 ms", "45 MB"])
def test_a_claim_that_was_measured_passes(claim: str) -> None:
    assert wrong(f"costs [{claim}](BENCHMARKS.md#batch-a).", TABLE) == []


@pytest.mark.parametrize("claim", ["0.27 ms a job", "0.26 s", "5.4 s", "44 MB", "fast", "0.2 ms"])
def test_a_claim_that_was_not_is_seen(claim: str) -> None:
    assert wrong(f"costs [{claim}](BENCHMARKS.md#batch-a).", TABLE) == [claim]


def test_a_row_that_is_not_there_is_seen() -> None:
    assert wrong("[0.26 ms](BENCHMARKS.md#batch-b)", TABLE) == ["0.26 ms"]


def test_a_number_outside_a_link_is_seen_in_that_section_alone() -> None:
    text = f"3 parts\n{SECTION}\nin [5.3 s](BENCHMARKS.md#batch-a), or 7 times as fast\n## Next\n9 lives\n"
    assert loose(text) == ["7"]
