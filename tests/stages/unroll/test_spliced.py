"""Rings of edges joined where they share one: two become one, one becomes two, and what is left closes."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.unroll.spliced import Ring, spliced

Edge = tuple[str, str]


def ring(*corners: str) -> Ring[Edge, Edge]:
    """Return the ring through corners; its edges are called by their ends."""
    edges = tuple(zip(corners, [*corners[1:], corners[0]], strict=True))
    return Ring(edges, edges)


def closes(run: tuple[Edge, ...]) -> bool:
    return all(a[1] == b[0] for a, b in zip(run, [*run[1:], run[0]], strict=True))


def corners(run: tuple[Edge, ...]) -> str:
    """Return the corners of a ring from the least one on."""
    names = "".join(a for a, _ in run)
    first = names.index(min(names))
    return names[first:] + names[:first]


def test_two_squares_side_by_side_are_a_hexagon() -> None:
    (run,) = spliced([ring(*"abcd"), ring(*"befc")], [(("b", "c"), ("c", "b"))])
    assert corners(run) == "abefcd"
    assert closes(run)


def test_an_edge_in_pieces_is_taken_out_whole() -> None:
    left = Ring(("s", "s", "x", "x"), (("a", "m"), ("m", "b"), ("b", "c"), ("c", "a")))
    right = Ring(("t", "t", "y"), (("b", "m"), ("m", "a"), ("a", "b")))
    (run,) = spliced([left, right], [("s", "t")])
    assert run == (("b", "c"), ("c", "a"), ("a", "b"))


def test_a_ring_of_four_is_an_outline_and_a_hole() -> None:
    faces = [ring("a", "b", "f", "e"), ring("b", "c", "g", "f"), ring("c", "d", "h", "g"), ring("d", "a", "e", "h")]
    shared = [((p, q), (q, p)) for p, q in (("b", "f"), ("c", "g"), ("d", "h"), ("e", "a"))]
    shared[3] = (("e", "a"), ("a", "e"))
    found = sorted(corners(run) for run in spliced(faces, shared))
    assert found == ["abcd", "ehgf"]


def test_faces_all_round_a_corner_leave_nothing_there() -> None:
    faces = [ring("a", "b", "o"), ring("b", "c", "o"), ring("c", "a", "o")]
    shared = [((p, "o"), ("o", p)) for p in "bca"]
    (run,) = spliced(faces, shared)
    assert corners(run) == "abc"


def test_an_edge_that_no_ring_has_is_a_defect_of_the_caller() -> None:
    with pytest.raises(ValueError, match="no ring has"):
        spliced([ring(*"abc"), ring(*"def")], [(("a", "b"), ("x", "y"))])


@given(st.integers(2, 12), st.randoms(use_true_random=False))
def test_the_order_of_shared_edges_does_not_count(count: int, random: object) -> None:
    names = [chr(ord("A") + i) for i in range(count + 1)]
    faces = [ring(names[i], names[i + 1], names[i + 1].lower(), names[i].lower()) for i in range(count)]
    shared = [((p, p.lower()), (p.lower(), p)) for p in names[1:-1]]
    expected = spliced(faces, shared)
    random.shuffle(shared)  # type: ignore[attr-defined]
    assert spliced(faces, shared) == expected
    assert len(expected[0]) == 2 * count + 2
