"""What the child says of a CAD file: every bit of the faces comes back, and anything else is no answer."""

import json
import pickle
from contextlib import suppress
from fractions import Fraction
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.cad.child import read as read_file
from pipeline.cad.files import read_guarded
from pipeline.cad.wire import Unreadable, WireError, read, written
from stages.geometry.curves.curves import Circular, bezier, rational
from stages.geometry.ruled.backwards import Backwards
from stages.model.cadface import CadBody, CadCone, CadEdge, CadFace, CadNet, CadPlane, CadSweep
from tests.pipeline.cad.test_files import child

LINE = bezier([(Fraction(1, 3), Fraction(0), Fraction(-2)), (Fraction(10**30, 7), Fraction(1), Fraction(2))])
CONIC = rational(
    [(Fraction(0), Fraction(0), Fraction(0), Fraction(1)), (Fraction(1), Fraction(1), Fraction(0), Fraction(1, 2))]
)
RING = Circular(np.array([0.1, 0.2, 1e-300]), np.eye(3)[0], np.eye(3)[1], np.zeros(3), 0.1, 2.0 * np.pi)
NET = CadNet(
    1, 1, np.array([0, 0, 1, 1.0]), np.array([0, 0, 1, 1.0]), np.arange(12.0).reshape(2, 2, 3), np.ones((2, 2))
)
SURFACES = (CadPlane(), CadSweep((LINE, Backwards(CONIC)), np.eye(3)[2]), CadCone(np.zeros(3), RING), NET, None)
FACES = tuple(
    CadFace(
        i,
        f'"{i}" ü',
        "plane",
        surface,
        np.zeros(3),
        np.eye(3)[2],
        ((CadEdge(i, (LINE, CONIC, RING)),),),
        0.1 * i or None,
    )
    for i, surface in enumerate(SURFACES)
)
BODY = CadBody(FACES)


def test_every_bit_of_the_faces_comes_back() -> None:
    back = read(written(BODY))
    assert isinstance(back, CadBody)
    assert (repr(back), written(back)) == (repr(BODY), written(BODY))
    assert read(written(Unreadable("a\nb"))) == Unreadable("a\nb")


def test_a_real_file_comes_back(tmp_path: Path) -> None:
    body = read_file(str(files("pipeline").joinpath("data", "cad", "channel.step")), "step")
    assert isinstance(body, CadBody)
    assert written(read(written(body))) == written(body)


ANSWERS = (
    b"", b"{", b"[]", b"1", b'"x"', b"null", b"[" * 100_000, b'{"is a": "Path"}', b'{"is a": "CadPlane"}',
    b'{"is a": 3}',
    b'{"is a": "CadBody"}', b'{"is a": "CadBody", "faces": {"list": []}, "more": 1}', b'{"ratio": "1/0"}',
    b'{"ratio": "x"}', b'{"array": "x", "shape": [1]}', b'{"array": "AAAA", "shape": [3]}',
    b'{"array": "", "shape": 3}',
)  # fmt: skip


@pytest.mark.parametrize("answer", [*ANSWERS, pickle.dumps(Unreadable("x"))])
def test_anything_else_is_no_answer(answer: bytes) -> None:
    with pytest.raises(WireError):
        read(answer)


@given(st.recursive(st.none() | st.booleans() | st.integers() | st.text(), lambda inner: st.dictionaries(
    st.sampled_from(["is a", "list", "array", "shape", "ratio", "faces", "message"]), inner | st.lists(inner)
)))  # fmt: skip
def test_no_answer_does_more_than_be_refused(answer: object) -> None:
    with suppress(WireError):
        read(json.dumps(answer).encode())


def test_what_is_no_part_of_an_answer_is_not_written() -> None:
    with pytest.raises(ValueError, match="no part of an answer"):
        written((Path("x"),))


def test_a_child_that_answers_with_a_pickle_is_not_believed(tmp_path: Path) -> None:
    planted = tmp_path / "ran"
    code = f"import os, pickle, sys\nclass C:\n def __reduce__(self): return (open, ({str(planted)!r}, 'w'))\n"
    answer = read_guarded(child(code + "os.write(1, pickle.dumps(C()))"), 60.0)
    assert answer == Unreadable("the reader answered with something else than faces")
    assert not planted.exists()
