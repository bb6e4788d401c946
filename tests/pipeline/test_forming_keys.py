"""Faces and bend lines in job files: what is read, and what is refused with its place."""

from fractions import Fraction
from pathlib import Path

import pytest

from pipeline.jobfile import read
from stages.errors import BadInputError
from tests.pipeline.jobs import CONE, PLATE, write_job

JOB = "schema = 1\n[material]\nthickness = 2\n" + CONE
FACE = JOB.replace('name = "cone"', 'name = "cone"\nface = "outer"')


def test_a_face_and_its_bend_lines_are_read(tmp_path: Path) -> None:
    part = read(write_job(tmp_path, FACE + "[[part.bend]]\nmax_angle = 5\n")).tables.part[0]
    assert part.face == "outer"
    (bend,) = part.bend
    assert (bend.name, bend.max_angle, bend.facet_error) == ("bend", 5, None)
    inches = 'units = "in"\n' + FACE + '[[part.bend]]\nname = "hit"\nfacet_error = 0.01\n'
    (bend,) = read(write_job(tmp_path, inches)).tables.part[0].bend
    assert (bend.name, bend.facet_error) == ("hit", Fraction(254, 1000))


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (
            JOB.replace('name = "cone"', 'name = "cone"\nface = "iner"'),
            'face: "iner" is not allowed (did you mean "inner"?)',
        ),
        (JOB + "[[part.bend]]\n", "part[0].bend[0].max_angle: exactly one of max_angle and facet_error"),
        (JOB + "[[part.bend]]\nmax_angle = 120\n", "part[0].bend[0].max_angle: 120 deg (at most 90 deg in one step)"),
        (JOB + "[[part.bend]]\nmax_angle = 5\n[[part.bend]]\nmax_angle = 6\n", "part[0].bend[1]: a second set"),
        (PLATE + "[[part.bend]]\nmax_angle = 5\n", "part[0].bend: a plate does not bend"),
    ],
)
def test_bends_that_make_no_sense_are_refused_with_their_place(tmp_path: Path, text: str, complaint: str) -> None:
    with pytest.raises(BadInputError) as caught:
        read(write_job(tmp_path, text))
    assert complaint in str(caught.value)
