"""What is advised besides the cuts that are suggested: nothing where they are enough."""

from stages.construct import construct
from stages.model.report import Finding
from stages.model.tolerances import STRAIN_LIMIT, Tolerances
from stages.verify import verify
from tests.caps import cap, part

LEATHER = Tolerances("leather")


def suggested(half_angle: float) -> Finding:
    """Return what is suggested for a cap of so many radians from pole to rim."""
    made = construct(part(cap(half_angle, cells=12)), LEATHER).product
    assert made is not None
    (found,) = (one for one in verify(made, LEATHER).report.findings if one.code == "cut-suggested")
    return found


def test_nothing_more_is_advised_where_the_cuts_are_enough() -> None:
    told = suggested(0.7)
    assert told.where is not None
    assert float(str(told.where["strain"])) <= STRAIN_LIMIT["leather"]
    assert "pieces besides" not in told.message
