"""Each operator changes what it names, in the text, and leaves alone what only checkers of types see."""

import ast
from pathlib import Path

import pytest

from tests.mutants.operators import Change, changes, mutated

ROOT = Path(__file__).parents[2]
BECOMES = {
    "a < b": {"a <= b", "a >= b"},
    "a >= b": {"a > b", "a < b"},
    "(a) == (b)": {"(a) != (b)"},
    "a is b": {"a is not b"},
    "a not in b": {"a in b"},
    "a < b < c": {"a <= b < c", "a >= b < c", "a < b <= c", "a < b >= c"},
    "a + b": {"a - b"},
    "(a + b) * c": {"(a - b) * c", "(a + b) / c"},
    "a ** b": {"a * b"},
    "a // b": {"a / b"},
    "x += a": {"x -= a"},
    "-a": {"+a"},
    "a and b or c": {"a or b or c", "a and b and c"},
    "not (a)": {" (a)"},
    "f(True)": {"f(False)"},
    "a[0]": {"a[1]", "a[(-1)]"},
    "f(1.5)": {"f(2.5)", "f(0.5)"},
    "min(a, b)": {"max(a, b)"},
    "np.minimum(a, b)": {"np.maximum(a, b)"},
    "a.max()": {"a.min()"},
    "m & n": {"m | n"},
}
RETURNED = {"bool": "not (a)", "float": "(a) + 1", "Points2": "(a) + 1", "str": '""', "tuple[int, ...]": "()"}
LEFT_ALONE = (
    "x: Annotated[int, Meta(ge=1)] = y", "@dataclass(frozen=True)\nclass A:\n    pass", 'x = f"{a + 1} {b < c}"',
    'x = "a" + b', "x = [a] + b", "x = int | None", "x = Alpha | Beta", "if TYPE_CHECKING:\n    x = 1", '"""Of 3."""',
    "def f(a: int) -> tuple[int, int]:\n    return a, a", "x = (a  # + b\n     + b)", "def f() -> None:\n    return",
)  # fmt: skip


def results(source: str) -> set[str]:
    return {mutated(source.encode(), change).decode() for change in changes(source.encode())}


@pytest.mark.parametrize("source", BECOMES)
def test_a_place_becomes_each_of_its_slips(source: str) -> None:
    assert results(source) == BECOMES[source]


@pytest.mark.parametrize("said", RETURNED)
def test_a_returned_value_becomes_another_of_its_type(said: str) -> None:
    function = "def f(a) -> {}:\n    return {}\n"
    assert results(function.format(said, "a")) == {function.format(said, RETURNED[said])}


def test_a_returned_value_that_may_be_none_is_none() -> None:
    assert results("def f(a) -> A | None:\n    return a\n") == {"def f(a) -> A | None:\n    return None\n"}


def test_a_return_belongs_to_the_function_around_it() -> None:
    source = "def f() -> bool:\n    def g() -> str:\n        return a\n    return b\n"
    assert results(source) == {source.replace("a", '""'), source.replace("return b", "return not (b)")}


@pytest.mark.parametrize("source", LEFT_ALONE)
def test_what_is_no_slip_is_left_alone(source: str) -> None:
    assert results(source) == set()


def test_places_are_counted_in_bytes() -> None:
    assert results("f('Öl', a < b)") == {"f('Öl', a <= b)", "f('Öl', a >= b)"}


def test_a_change_whose_text_does_not_stand_there_is_refused() -> None:
    with pytest.raises(ValueError, match="does not stand"):
        mutated(b"a + b", Change("arithmetic", 0, "+", "-"))


@pytest.mark.parametrize("file", ["stages/geometry/paths/biarc.py", "stages/verify/sampled.py", "pipeline/units.py"])
def test_every_mutant_of_a_module_is_another_program_that_can_be_read(file: str) -> None:
    source = (ROOT / file).read_bytes()
    plain = ast.dump(ast.parse(source))
    found = changes(source)
    assert len(found) > 50
    for change in found[:: len(found) // 20]:
        assert ast.dump(ast.parse(mutated(source, change))) != plain, change
