import pytest

from pipeline.processes import limits, listing, look_up, table
from pipeline.processtables import ProcessTable
from stages.model.scalars import Length


def test_every_value_has_a_source_and_every_process_a_last_row() -> None:
    for row in table():
        rules = [rule for rule in (row.min_hole, row.min_web) if rule is not None]
        assert row.kerf.source and all(rule.source for rule in rules)
        assert row.kerf.value >= 0.0 and all(rule.least > 0.0 for rule in rules)
        assert look_up(row.type, 1e6).up_to is None


@pytest.mark.parametrize(
    ("process", "thickness", "hole", "web"),
    [
        ("laser", 0.5, 0.5, 0.5),  # least
        ("laser", 2.0, 1.4, 1.4),  # 0.7 x thickness
        ("laser", 3.0, 2.1, 2.1),
        ("laser", 6.0, 6.0, 6.0),  # 1 x thickness above 3 mm
        ("plasma", 10.0, 15.0, 15.0),
        ("waterjet", 50.0, 1.5, 1.0),
        ("laser", None, 0.5, 0.5),
    ],
)
def test_limits_go_with_the_thickness(process: str, thickness: float | None, hole: float, web: float) -> None:
    found = limits(ProcessTable(type=process), thickness)  # type: ignore[arg-type]
    assert (found["min_hole"].value, found["min_web"].value) == pytest.approx((hole, web), rel=1e-15)


def test_what_the_job_says_goes_before_the_table() -> None:
    found = limits(ProcessTable(type="laser", min_web=Length(9)), 2.0)
    assert (found["min_web"].value, found["min_web"].source) == (9.0, "job file, process.min_web")
    assert found["min_hole"].value == pytest.approx(1.4)
    assert limits(ProcessTable(kerf=Length(1)), None).keys() == {"kerf"}
    assert limits(ProcessTable(), 2.0) == {}


def test_the_listing_tells_every_source() -> None:
    text = listing()
    for row in table():
        assert row.kerf.source in text
        assert all(rule.source in text for rule in (row.min_hole, row.min_web) if rule is not None)


def test_a_knife_sets_no_least_hole() -> None:
    assert "min_hole" not in limits(ProcessTable(type="knife"), 1.5)
