"""Plain tables and arrays -> the structs of a job file, with every complaint and not the first.

A walk over `msgspec.inspect.type_info` of the wanted struct: each value is held against its type, a wrong one is noted
with its path, a stand-in takes its place, and the walk goes on.  Every struct is built and asked for its `troubles`;
of a struct with wrong values those troubles count that are about its right ones.  Quantities go through
`pipeline.units`.  msgspec's own decoder would stop at the first error, and knows neither suggestions nor units.

What a struct stands for may be replaced once it is read (`Walk.resolve`): that is how curves in DXF files come in.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Literal, TypeVar

import msgspec
from msgspec import inspect

from pipeline.paths import Path, parsed
from pipeline.standins import stand_in
from pipeline.typenames import fixed_name, needed, quoted, type_name
from pipeline.units import UnreadableError, coordinate_of, describe, quantity
from stages.model.curves import Table
from stages.model.scalars import Coordinate, Number

T = TypeVar("T", bound=Table)

MOST_COMPLAINTS = 200
"""After these no further ones are noted: a file of a million wrong points needs no million messages."""


@dataclass(frozen=True, slots=True)
class Complaint:
    """Something wrong at a path; `at` says whether the key or the value is to be pointed at."""

    path: Path
    message: str
    hint: str = ""
    at: Literal["key", "value"] = "value"


class TooManyError(Exception):
    """The list of complaints is full."""


@dataclass(frozen=True, slots=True)
class Several:
    """What takes the place of one item of an array: several."""

    items: tuple[object, ...]


class Repeated(dict[str, object]):
    """A JSON object in which some names occur twice."""

    twice: tuple[str, ...] = ()


Resolve = Callable[[Table, Path], Table | Several]


def as_it_is(table: Table, _path: Path) -> Table:
    """Return the table unchanged."""
    return table


class ResolveError(Exception):
    """What a table points at is not there or not usable."""

    def __init__(self, key: str, message: str, hint: str) -> None:
        super().__init__(message)
        self.key, self.message, self.hint = key, message, hint


@dataclass(slots=True)
class Walk:
    """One walk: the unit of bare lengths, what tables are replaced by, and what was found so far.

    unclear: paths of arrays and of tables with a kind of which not even the number or the kind is known.
    """

    unit: str = "mm"
    resolve: Resolve = as_it_is
    complaints: list[Complaint] = field(default_factory=list)
    unclear: set[Path] = field(default_factory=set)

    def complain(self, path: Path, message: str, hint: str = "", at: Literal["key", "value"] = "value") -> None:
        """Note what is wrong."""
        self.complaints.append(Complaint(path, message, hint, at))
        if len(self.complaints) >= MOST_COMPLAINTS:
            raise TooManyError

    def wrong(self, sort: inspect.Type, path: Path, message: str, hint: str = "") -> object:
        """Note what is wrong with a value, and return a stand-in for it."""
        self.complain(path, message, hint)
        if isinstance(sort, inspect.VarTupleType) or _tagged_members(sort):
            self.unclear.add(path)
        return stand_in(sort, len(self.complaints))


def decode(walk: Walk, wanted: type[T], raw: object) -> T | None:
    """Return the struct, or None if there are complaints."""
    try:
        value = _value(walk, inspect.type_info(wanted), raw, ())
    except TooManyError:
        return None
    return value if isinstance(value, wanted) and not walk.complaints else None


def _value(walk: Walk, sort: inspect.Type, raw: object, path: Path) -> object:
    """Return the value as that type wants it, or a stand-in."""
    match sort:
        case inspect.UnionType():
            return _union(walk, sort, raw, path)
        case inspect.StructType():
            return _struct(walk, sort, raw, path)
        case inspect.VarTupleType():
            return _array(walk, sort, raw, path)
        case inspect.TupleType():
            return _fixed_array(walk, sort, raw, path)
        case inspect.CustomType():
            return _quantity(walk, sort, raw, path)
        case inspect.FloatType():
            number = _quantity(walk, inspect.CustomType(Number), raw, path)
            return float(number) if isinstance(number, Number) else number
        case _:
            return _leaf(walk, sort, raw, path)


def _union(walk: Walk, sort: inspect.UnionType, raw: object, path: Path) -> object:
    """Choose the member by the shape of the value, tables by their tag."""
    members = [item for item in sort.types if not isinstance(item, inspect.NoneType)]
    if raw is None and len(members) < len(sort.types):
        return None
    if _tagged_members(sort):
        return _tagged(walk, sort, raw, path)
    fitting = [item for item in members if _has_shape(item, raw)]
    if len(members) == 1 or fitting:
        return _value(walk, (fitting or members)[0], raw, path)
    return walk.wrong(sort, path, f"{describe(raw)} does not belong here", needed(sort, path))


def _tagged_members(sort: inspect.Type) -> list[inspect.StructType]:
    """Return the tables of a union that are told apart by a key."""
    members = sort.types if isinstance(sort, inspect.UnionType) else ()
    return [item for item in members if isinstance(item, inspect.StructType) and item.tag_field]


def _tagged(walk: Walk, sort: inspect.UnionType, raw: object, path: Path) -> object:
    """Choose among tables that are told apart by a key such as `kind`."""
    members = _tagged_members(sort)
    key = members[0].tag_field or ""
    kinds = {str(item.tag): item for item in members}
    if not isinstance(raw, Mapping):
        return walk.wrong(sort, path, f"{describe(raw)} where a table belongs", f"write a table with a {key}")
    chosen = raw.get(key)
    if isinstance(chosen, str) and chosen in kinds:
        return _struct(walk, kinds[chosen], raw, path)
    if key not in raw:
        walk.complain((*path, key), "missing", f"one of {', '.join(quoted(kinds))}")
    else:
        walk.complain((*path, key), f"unknown {key} {describe(chosen)}", suggestion(chosen, list(kinds)))
    walk.unclear.add(path)
    return stand_in(sort, len(walk.complaints))


def _struct(walk: Walk, sort: inspect.StructType, raw: object, path: Path) -> object:
    """Return the struct; complain about each key that is wrong, missing or unknown."""
    if not isinstance(raw, Mapping):
        keys = ", ".join(entry.encode_name for entry in sort.fields)
        return walk.wrong(sort, path, f"{describe(raw)} where a table belongs", f"a table with the keys {keys}")
    before = len(walk.complaints)
    known = {entry.encode_name: entry for entry in sort.fields}
    for key in raw:
        if key not in known and key != sort.tag_field:
            walk.complain((*path, str(key)), "unknown key", suggestion(key, list(known)), "key")
    for key in raw.twice if isinstance(raw, Repeated) else ():
        walk.complain((*path, key), "the key is there twice", "leave one of them out", "key")
    values: dict[str, object] = {}
    for key, entry in known.items():
        at = (*path, key)
        if key in raw:
            values[entry.name] = _value(walk, entry.type, raw[key], at)
        elif entry.required:
            values[entry.name] = walk.wrong(entry.type, at, "missing", needed(entry.type, at))
    table = sort.cls(**values)
    return _checked(walk, table, raw, path, before) if isinstance(table, Table) else table


def _checked(walk: Walk, table: Table, raw: Mapping[str, object], path: Path, before: int) -> Table | Several:
    """Return the table after asking it for its troubles, or what it stands for.

    before: how many complaints there were when the table's turn came.
    """
    wrong = [complaint.path for complaint in walk.complaints[before:]]
    if not any((*path, key) in walk.unclear for key in table.__struct_fields__):
        for trouble in table.troubles():
            inner = parsed(trouble.key) or ()
            if not wrong or (inner and inner[0] in raw and not _touches(path + inner, wrong)):
                walk.complain(path + inner, trouble.message, trouble.hint)
    if len(walk.complaints) > before:
        return table
    try:
        return walk.resolve(table, path)
    except ResolveError as error:
        walk.complain(path + (parsed(error.key) or ()), error.message, error.hint)
        return table


def _touches(path: Path, others: Sequence[Path]) -> bool:
    """Return whether the path is, holds, or lies inside one of the others."""
    return any(path[: len(other)] == other or other[: len(path)] == path for other in others)


def _array(walk: Walk, sort: inspect.VarTupleType, raw: object, path: Path) -> object:
    """Return a tuple of any allowed length; one reference to a drawing may stand for all its items."""
    if isinstance(raw, Mapping) and "file" in raw:
        value = _value(walk, sort.item_type, raw, path)
        return value.items if isinstance(value, Several) else (value,)
    if not isinstance(raw, list | tuple):
        return walk.wrong(sort, path, f"{describe(raw)} where an array belongs", needed(sort, path))
    least, most = sort.min_length or 0, sort.max_length
    if len(raw) < least or (most is not None and len(raw) > most):
        return walk.wrong(sort, path, describe(raw), f"{type_name(sort)} is needed")
    items: list[object] = []
    for i, item in enumerate(raw):
        value = _value(walk, sort.item_type, item, (*path, i))
        items.extend(value.items if isinstance(value, Several) else (value,))
    return tuple(items)


def _fixed_array(walk: Walk, sort: inspect.TupleType, raw: object, path: Path) -> object:
    """Return a tuple of exactly that length."""
    sorts = sort.item_types
    if not isinstance(raw, list | tuple) or len(raw) != len(sorts):
        return walk.wrong(sort, path, f"{describe(raw)} does not fit", f"{fixed_name(sorts)} is needed")
    return tuple(_value(walk, item, raw[i], (*path, i)) for i, item in enumerate(sorts))


def _quantity(walk: Walk, sort: inspect.CustomType, raw: object, path: Path) -> object:
    """Return a length, curvature, angle or plain number."""
    try:
        return coordinate_of(raw, walk.unit) if sort.cls is Coordinate else quantity(sort.cls, raw, walk.unit)
    except UnreadableError as error:
        return walk.wrong(sort, path, error.message, error.hint)


def _leaf(walk: Walk, sort: inspect.Type, raw: object, path: Path) -> object:
    """Return a text, whole number, boolean or one of a few words."""
    if isinstance(sort, inspect.LiteralType):
        fits = any(raw == value and type(raw) is type(value) for value in sort.values)
        return raw if fits else walk.wrong(sort, path, f"{describe(raw)} is not allowed", suggestion(raw, sort.values))
    if not _has_shape(sort, raw):
        return walk.wrong(sort, path, f"{describe(raw)} where {type_name(sort)} belongs")
    if isinstance(raw, str) and not raw.isprintable():
        return walk.wrong(sort, path, f"{describe(raw)} holds a control character", "write plain text on one line")
    low, high = _range(sort)
    size = len(raw) if isinstance(raw, str) else raw
    if isinstance(size, int) and ((low is not None and size < low) or (high is not None and size > high)):
        return walk.wrong(sort, path, f"{describe(raw)} is out of range", f"{type_name(sort)} is needed")
    return raw


def _range(sort: inspect.Type) -> tuple[int | None, int | None]:
    """Return the least and the largest whole number, or length of a text."""
    if isinstance(sort, inspect.IntType):
        return sort.ge, sort.le
    return (sort.min_length, sort.max_length) if isinstance(sort, inspect.StrType) else (None, None)


def _has_shape(sort: inspect.Type, raw: object) -> bool:
    """Return whether a value looks like that type, ranges apart."""
    match sort:
        case inspect.StructType():
            return isinstance(raw, Mapping)
        case inspect.VarTupleType() | inspect.TupleType():
            return isinstance(raw, list | tuple)
        case inspect.StrType() | inspect.BoolType():
            return isinstance(raw, str if isinstance(sort, inspect.StrType) else bool)
        case inspect.IntType():
            return isinstance(raw, int) and not isinstance(raw, bool)
        case inspect.LiteralType():
            return any(type(raw) is type(value) for value in sort.values)
        case inspect.FloatType():
            return not isinstance(raw, bool | str | list | tuple | Mapping | None)
        case _:
            return False


def suggestion(read: object, allowed: Sequence[object]) -> str:
    """Return a hint: the nearest of the allowed words, or all of them."""
    near = get_close_matches(str(read)[:80], [str(word) for word in allowed], 1) if isinstance(read, str) else []
    if near:
        return f'did you mean "{near[0]}"?'
    return f"{'one of' if len(allowed) > 1 else 'only'} {', '.join(quoted(allowed))}"


def canonical(table: msgspec.Struct) -> bytes:
    """Return the same bytes for the same values, however a file wrote them."""
    return msgspec.json.encode(table, enc_hook=str, order="deterministic")
