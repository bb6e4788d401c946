"""Every topic at small sizes: its rows are there and make sense.  No speed is judged here."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import isfinite

import numpy as np
import pytest

from stages.geometry.curves.plane import CircularArc
from tests.bench.rows import Asked, Row, identity
from tests.bench.sections import alone
from tests.bench.timing import measured
from tests.bench.topics import batches, drawing, growth, nesting, starting, unrolling, verifying
from tests.bench.topics.flatteners import LIBIGL
from tests.near import assert_near
from tests.parts import passage

QUICK = Asked("quick")


def made(rows: Callable[[Asked], object]) -> list[Row]:
    return sound(list(rows(QUICK)))


def made_alone(name: str) -> list[Row]:
    """The rows of a topic that forks, in a process of its own: this one has servers of other tests."""
    section = alone(name, QUICK)
    assert not section.failed
    return sound(list(section.rows))


def sound(found: list[Row]) -> list[Row]:
    assert len({identity("topic", row) for row in found}) == len(found), "each has an anchor of its own"
    assert all(row.seconds is None or (isfinite(row.seconds) and row.seconds > 0.0) for row in found)
    return found


def figures(rows: list[Row]) -> dict[str, float]:
    return {f"{row.program}, {row.size}": row.figure for row in rows if row.figure is not None}


def test_the_exact_surface_is_unrolled_to_rounding_and_chords_are_not() -> None:
    found = {(row.program, row.size): row.figure for row in made(unrolling.rows)}
    ours = next(figure for (program, _), figure in found.items() if program == "planish")
    mesh = next(figure for (program, _), figure in found.items() if program == "planish, from the mesh")
    strips = [found["triangle strip", f"{count} rulings"] for count in unrolling.RULINGS]
    assert ours < 1e-14
    assert found["scipy solve_ivp DOP853", "225 points"] < 1e-11
    assert_near(strips[0] / strips[1], (1023 / 127) ** 2, bound=1.0, why="the square of the spacing")
    assert mesh < min(figure for (program, _), figure in found.items() if program in LIBIGL)


@pytest.mark.parametrize("name", ["cylinder over a quintic", "oblique cone over a quintic", "tangent developable"])
def test_three_ways_to_develop_agree_on_every_surface(name: str) -> None:
    surface = unrolling.surfaces()[name]
    places = unrolling.exact_places(surface)
    bound = 1e-11 * unrolling.extent(unrolling.in_space(surface.patch, unrolling.U, unrolling.V))
    for method in (unrolling.developed, unrolling.by_equations):
        assert_near(method(surface.patch, unrolling.U, unrolling.V), places, bound=bound, why="DOP853 at 1e-13")


def test_the_certificate_makes_no_mistake_and_mistakes_are_counted() -> None:
    rows = made(verifying.rows)
    assert {row.what for row in rows} == {"false alarms", "misses, warp 0.5 deg", "misses, warp 0.05 deg"}
    assert [row.figure for row in rows if row.program == "planish"] == [0, 0, 0]
    assert all(row.unit == "of 5" and 0 <= (row.figure or 0) <= 5 for row in rows)
    case = verifying.Case(0.0, True, 1.0, 0.3, 1.0)
    cases = [case, case._replace(warp_deg=0.5, defect=0.2), case._replace(warp_deg=0.05, defect=0.9)]
    assert_near(verifying.best_threshold(cases), 0.6, bound=1e-15, why="one miss; at 0.1 one alarm, which weighs two")
    assert [wrong for _, wrong, _ in verifying.mistakes(cases, [True, True, False])] == [0, 1, 0]


def test_drawings_keep_the_tolerance_and_arcs_are_fewer_than_chords() -> None:
    rows = made(drawing.rows)
    count = {row.program: row.figure for row in rows if row.unit == "lines and arcs"}
    chords = count["planish polylines"], count["uniform sampling, ezdxf"]
    assert count["planish polyline-arcs"] < min(chords) / 2
    assert chords[0] <= 1.05 * chords[1], "ours leave 5 % of the tolerance, which is 2.6 % more chords, and one an edge"
    assert all(0.0 < row.figure <= 0.05 * 1.02 for row in rows if row.unit == "mm" and row.figure is not None)


def test_the_least_number_of_steps_along_an_arc_is_the_closed_form() -> None:
    arc = CircularArc(np.zeros(2), 100.0, 0.0, 2.0)
    expected = int(np.ceil(1.0 / np.arccos(1.0 - 0.05 / 100.0)))
    assert drawing.steps(arc, 0.05) == expected


def test_a_drawing_that_is_off_is_seen_to_be() -> None:
    pattern = passage(drawing.PARTS["frustum, 0.8 m"]).pattern
    assert pattern is not None
    coarse = pattern.replace(outer=replace(pattern.outer, chord_mm=1.0))
    (_, deviation) = drawing.judged("coarse", "", "", coarse, measured(partial(drawing.sampled, coarse), 1))
    assert 0.5 <= (deviation.figure or 0.0) <= 1.02, "of a tolerance of 1 mm uniform sampling leaves half or more"


def test_commands_start_and_one_that_fails_is_no_figure(tmp_path) -> None:
    assert [row.what for row in made(starting.rows)] == ["python, nothing", "planish --version"]
    with pytest.raises(RuntimeError, match="exit code 3: told"):
        starting.ended([*starting.PYTHON, "import sys; sys.stderr.write('told'); sys.exit(3)"], tmp_path)


def test_a_nest_of_ours_is_valid_and_has_a_density() -> None:
    (row,) = made(nesting.rows)
    assert 0.0 < (row.figure or 0.0) < 100.0
    assert "seed" in row.how


def test_pools_and_batches_run_the_same_jobs() -> None:
    rows = made_alone("batch")
    assert [row.size for row in rows if row.what == batches.WHAT] == ["40 jobs"] * 2
    assert all((row.figure or 0.0) > 0.0 for row in rows if row.what == batches.RATE)


def test_every_series_grows_and_one_that_fails_is_no_figure() -> None:
    rows = made_alone("growth")
    assert [row.figure is None for row in rows] == [True, False] * len(growth.SERIES)
    with pytest.raises(RuntimeError, match="not made"):
        list(growth.series("none", "parts", lambda *_: lambda: False, (1,), 1))


def test_cells_make_about_so_many_triangles() -> None:
    for count in (200, 1000, 10_000, 1_000_000):
        columns, rows = growth.cells(count)
        assert abs(2 * columns * rows - count) <= 0.02 * count
