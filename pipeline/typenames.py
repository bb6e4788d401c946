"""What the types of a job file are called in messages and listings."""

from collections.abc import Iterable, Sequence

from msgspec import inspect

from pipeline.paths import Path
from stages.model.scalars import Angle, Coordinate, Curvature, Length, Number

QUANTITY_NAMES: dict[type, str] = {
    Length: "a length",
    Coordinate: "a length",
    Curvature: "a curvature",
    Number: "a number",
    Angle: "an angle in degrees",
}
PLURALS = {
    "a length": "lengths",
    "a curvature": "curvatures",
    "a number": "numbers",
    "a table": "tables",
    "an angle in degrees": "angles in degrees",
}


def type_name(sort: inspect.Type) -> str:
    """Return what a type is called in a message."""
    match sort:
        case inspect.UnionType():
            return _union_name(sort)
        case inspect.StructType():
            return "a table"
        case inspect.VarTupleType():
            return f"an array of {_count(sort)}{_plural(sort.item_type)}"
        case inspect.TupleType():
            return fixed_name(sort.item_types)
        case inspect.CustomType():
            return QUANTITY_NAMES[sort.cls]
        case inspect.FloatType():
            return "a number"
        case inspect.LiteralType():
            return " or ".join(quoted(sort.values))
        case inspect.IntType():
            return f"a whole number{_between(sort.ge, sort.le)}"
        case inspect.StrType():
            return f"a text{_between(sort.min_length, sort.max_length, ' characters')}"
        case _:
            return "true or false"


def needed(sort: inspect.Type, path: Path) -> str:
    """Return what belongs at a path, as a hint: with how it is written where that is easily got wrong."""
    name = f"{type_name(sort)} is needed"
    steps = [step for step in path if isinstance(step, str)]
    if isinstance(sort, inspect.VarTupleType) and type_name(sort.item_type) in TABLES and len(steps) <= DEEPEST_HEADING:
        return f"{name}; in TOML write [[{'.'.join(steps)}]] over each"
    if isinstance(sort, inspect.LiteralType) and len(sort.values) == 1 and steps:
        return f"{steps[-1]} = {quoted(sort.values)[0]} is needed"
    return name


TABLES = ("a table", "a table with a kind")
DEEPEST_HEADING = 2
"""Tables further inside are written in braces rather than under headings of their own."""


def quoted(words: Iterable[object]) -> list[str]:
    """Return the words as a job file writes them."""
    return [f'"{word}"' if isinstance(word, str) else str(word) for word in words]


def _union_name(sort: inspect.UnionType) -> str:
    members = [item for item in sort.types if not isinstance(item, inspect.NoneType)]
    if len([item for item in members if isinstance(item, inspect.StructType)]) > 1:
        return "a table with a kind"
    return " or ".join(type_name(item) for item in members)


def _between(low: int | None, high: int | None, of: str = "") -> str:
    if low is None and high is None:
        return ""
    if low is None:
        return f" of at most {high}{of}"
    return f" from {low} to {high}{of}" if high is not None else f" of at least {low}{of}"


def _count(sort: inspect.VarTupleType) -> str:
    low, high = sort.min_length, sort.max_length
    if low is not None and high is not None:
        return f"{low} to {high} "
    if low == 1:
        return "one or more "
    return f"at least {low} " if low else ""


def _plural(sort: inspect.Type) -> str:
    singular = type_name(sort)
    return PLURALS.get(singular, f"items, each {singular}")


def fixed_name(sorts: Sequence[inspect.Type]) -> str:
    """Return what an array of a fixed number of items is called."""
    same = len({type_name(sort) for sort in sorts}) == 1
    return f"an array of {len(sorts)} {_plural(sorts[0])}" if same else f"an array of {len(sorts)}"
