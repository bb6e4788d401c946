"""Side files that were spoilt or made up: what their drawings contradict is refused with the name of the file."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from stages.errors import BadInputError
from tests.pipeline.test_recalled import CHORD_MM, job

Side = dict[str, Any]


def _rivet(side: Side) -> Side:
    """Return what a side file says of the first round hole."""
    found: Side = next(one for one in side["contours"] if one["circle"])
    return found


def _circle(diameter_mm: float) -> Callable[[Side], None]:
    return lambda side: _rivet(side)["circle"].__setitem__(2, diameter_mm)


def _boundary(rows: Callable[[list[list[float]]], object]) -> Callable[[Side], None]:
    return lambda side: side["features"].update(boundary=rows(side["features"]["boundary"]))


def _notch(**changed: object) -> Callable[[Side], None]:
    return lambda side: side["features"]["notches"][0].update(changed)


def _drill(**changed: object) -> Callable[[Side], None]:
    made = {"name": "x", "purpose": "drill", "at": [30.0, 50.0], "diameter_mm": 3.0} | changed
    return lambda side: side["features"]["drills"].append(made)


CONTRADICTIONS: dict[str, tuple[Callable[[Side], None], str]] = {
    "no size": (_circle(0.0), "a circle of 0 mm at "),
    "a negative size": (_circle(-1.0), "a circle of -1 mm at "),
    "more than the chord larger": (_circle(1.0 + 2.1 * CHORD_MM), "is not the one drawn"),
    "beyond all numbers": (_circle(1e308), "is not the one drawn"),
    "no outline": (_boundary(lambda _: []), "the outline without notches is none"),
    "an outline of a point": (_boundary(lambda rows: rows[:1]), "the outline without notches is none"),
    "an outline of one place": (_boundary(lambda rows: rows[:1] * 5), "has pieces without length"),
    "more than half a turn": (_boundary(lambda rows: [[x, y, 2.0] for x, y, _ in rows]), "is none"),
    "a moved outline": (_boundary(lambda rows: [[x + 9.0, y, b] for x, y, b in rows]), "reaches 9 mm further"),
    "an outline beyond all numbers": (_boundary(lambda _: [[1e308, 0, 0], [0, 1e308, 0], [-1e308, 0, 1]]), "reaches "),
    "a notch far away": (_notch(at=[1e9, 0.0]), "mm off the outline"),
    "a notch without a direction": (_notch(inward=[0.0, 0.0]), "(0, 0) is no unit vector"),
    "a notch outwards": (_notch(depth_mm=-1.0), "-1 mm deep"),
    "a name of two lines": (_notch(name="a\n0\nEOF"), "'a\\n0\\nEOF' is no name"),
    "a name without end": (_notch(name="a" * 1000), "is no name"),
    "a drill hole without size": (_drill(diameter_mm=0.0), "drill hole 'x': 0 mm at (30, 50)"),
    "a drill hole elsewhere": (_drill(at=[300.0, 50.0]), "drill hole 'x': 3 mm at (300, 50)"),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_a_side_file_that_its_drawing_contradicts_is_refused_by_its_name(tmp_path: Path, name: str) -> None:
    change, wanted = CONTRADICTIONS[name]

    def spoilt(files: dict[str, bytes]) -> None:
        side = json.loads(files["flat/pocket.json"])
        change(side)
        files["flat/pocket.json"] = json.dumps(side).encode()

    with pytest.raises(BadInputError) as caught:
        job(tmp_path, "r12", spoilt)
    (problem,) = caught.value.problems
    assert problem.file == str(tmp_path / "flat/pocket.json")
    assert problem.message.startswith("contradicts its drawing: ")
    assert wanted in problem.message
    assert "run the job again" in problem.hint
