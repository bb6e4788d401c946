"""The mutants of a source text: each changes one place of it, as a slip of the hand would.

Comparisons become their neighbour at the boundary or their opposite, arithmetic another operation, `and` `or`, `min`
`max`, numbers one more or less, a value that is returned its opposite, its negative, one more or none at all.  The
changes are made in the text, so that all else stays where it is.

Left alone: annotations and decorators, what only checkers of types see, and texts with what stands in them.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

COMPARED = {
    "<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",),
    "is": ("is not",), "is not": ("is",), "in": ("not in",), "not in": ("in",),
}  # fmt: skip
COMPARISONS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=", ast.Is: "is",
    ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
}  # fmt: skip
ARITHMETIC = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.FloorDiv: ("//", "/"),
    ast.Mod: ("%", "*"), ast.Pow: ("**", "*"), ast.BitAnd: ("&", "|"), ast.BitOr: ("|", "&"),
}  # fmt: skip
LARGEST = {"min": "max", "minimum": "maximum", "argmin": "argmax", "fmin": "fmax", "nanmin": "nanmax"}
SWAPPED = LARGEST | {largest: least for least, largest in LARGEST.items()}
TEXTS_AND_LISTS = (ast.JoinedStr, ast.List, ast.ListComp, ast.Tuple)
"""No number comes of them: with another operation than `+` the program would not even begin."""
NUMBERS = {"int", "float", "Values", "Points2", "Points3", "Vector2", "Vector3", "Matrix", "Array"}
Node = ast.expr | ast.stmt
Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True, slots=True)
class Change:
    """Some bytes of a source text, from `begin` on, and what they become."""

    kind: str
    begin: int
    before: str
    after: str


class Text:
    """A source text whose places are bytes, as those of `ast` are."""

    def __init__(self, source: bytes) -> None:
        self.source = source
        lines = source.split(b"\n")
        self.starts = [0]
        for line in lines:
            self.starts.append(self.starts[-1] + len(line) + 1)

    def begin(self, node: Node) -> int:
        return self.starts[node.lineno - 1] + node.col_offset

    def end(self, node: Node) -> int:
        return self.starts[(node.end_lineno or 1) - 1] + (node.end_col_offset or 0)

    def of(self, node: Node) -> str:
        return self.source[self.begin(node) : self.end(node)].decode()

    def between(self, left: Node, right: Node, sign: str) -> int | None:
        """Return where an operator stands between its operands; None where a comment might hide it."""
        gap = self.source[self.end(left) : self.begin(right)].decode()
        place = re.search(rf"\b{sign}\b" if sign[0].isalpha() else re.escape(sign), gap)
        return None if place is None or "#" in gap else self.end(left) + place.start()


def changes(source: bytes) -> list[Change]:
    """Return every mutant of a source text, in the order of their places."""
    text = Text(source)
    found = {change for node in _nodes(ast.parse(source)) for change in _of(text, node)}
    return sorted(found, key=lambda change: (change.begin, change.kind, change.after))


def mutated(source: bytes, change: Change) -> bytes:
    """Return the text with the change made."""
    before = change.before.encode()
    end = change.begin + len(before)
    if source[change.begin : end] != before:
        raise ValueError(f"{change.before!r} does not stand at {change.begin}")
    return source[: change.begin] + change.after.encode() + source[end:]


def _nodes(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what may be changed, from above."""
    if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)):
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name not in {"annotation", "returns", "decorator_list"}:
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from _nodes(child)


def _of(text: Text, node: ast.AST) -> Iterator[Change]:
    match node:
        case ast.Compare():
            yield from _compared(text, node)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in ARITHMETIC and _counts(left, op, right):
            sign, other = ARITHMETIC[type(op)]
            yield from _operator(text, "arithmetic", (left, right), sign, other)
        case ast.AugAssign(target=left, op=op, value=right) if type(op) in ARITHMETIC and _counts(left, op, right):
            sign, other = ARITHMETIC[type(op)]
            yield from _operator(text, "arithmetic", (left, right), f"{sign}=", f"{other}=")
        case ast.BoolOp(op=op, values=values):
            sign, other = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
            for pair in pairwise(values):
                yield from _operator(text, "boolean", pair, sign, other)
        case ast.UnaryOp(op=ast.Not()):
            yield Change("not", text.begin(node), "not", "")
        case ast.UnaryOp(op=ast.USub()):
            yield Change("arithmetic", text.begin(node), "-", "+")
        case ast.Constant():
            yield from _constant(text, node)
        case ast.Name(id=name) if name in {"min", "max"}:
            yield Change("min-max", text.begin(node), name, SWAPPED[name])
        case ast.Attribute(attr=name) if name in SWAPPED:
            yield Change("min-max", text.end(node) - len(name), name, SWAPPED[name])
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            yield from _returned(text, node)


def _counts(left: ast.expr, op: ast.operator, right: ast.expr) -> bool:
    """Return whether an operation is one on numbers, or on masks and sets: not on texts, lists or types."""
    for side in (left, right):
        if isinstance(side, TEXTS_AND_LISTS) or (
            isinstance(side, ast.Constant) and isinstance(side.value, str | bytes)
        ):
            return False
        name = side.value.id if isinstance(side, ast.Subscript) and isinstance(side.value, ast.Name) else ""
        name = side.id if isinstance(side, ast.Name) else name
        typed = (isinstance(side, ast.Constant) and side.value is None) or (name[:1].isupper() and not name.isupper())
        if isinstance(op, ast.BitAnd | ast.BitOr) and (
            typed or name in {"int", "float", "str", "list", "tuple", "dict"}
        ):
            return False
    return True


def _operator(text: Text, kind: str, pair: tuple[ast.expr, ast.expr], sign: str, other: str) -> Iterator[Change]:
    place = text.between(*pair, sign)
    if place is not None:
        yield Change(kind, place, sign, other)


def _compared(text: Text, node: ast.Compare) -> Iterator[Change]:
    for op, pair in zip(node.ops, pairwise([node.left, *node.comparators]), strict=True):
        sign = COMPARISONS[type(op)]
        for other in COMPARED[sign]:
            yield from _operator(text, "comparison", pair, sign, other)


def _constant(text: Text, node: ast.Constant) -> Iterator[Change]:
    value = node.value
    if isinstance(value, bool):
        yield Change("constant", text.begin(node), str(value), str(not value))
    elif isinstance(value, int | float):
        for other in (value + 1, value - 1):
            yield Change("constant", text.begin(node), text.of(node), f"{other!r}" if other >= 0 else f"({other!r})")


def _returned(text: Text, function: Function) -> Iterator[Change]:
    said = "" if function.returns is None else ast.unparse(function.returns).strip("'\"")
    for node in _own(function):
        if node.value is not None:
            before = text.of(node.value)
            after = _other_value(said, before)
            if after is not None and after != before:
                yield Change("return", text.begin(node.value), before, after)


def _own(function: Function) -> Iterator[ast.Return]:
    """Yield the returns of a function, not those of functions within."""
    waiting: list[ast.AST] = list(function.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Return):
            yield node
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            waiting += ast.iter_child_nodes(node)


def _other_value(said: str, before: str) -> str | None:
    """Return another value of the type that a function is said to return; None where none is plain."""
    if said == "bool":
        return f"not ({before})"
    if said in NUMBERS:
        return f"({before}) + 1"
    if said.endswith("| None"):
        return "None"
    if said.startswith("tuple[") and said.endswith("...]"):
        return "()"
    return {"str": '""'}.get(said) if not said.startswith("list[") else "[]"
