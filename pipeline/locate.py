"""Lines and columns of the keys and values of a job file, for the messages about them.

tomllib and json say nothing of places, so the text is parsed once more by tree-sitter, and only when there is
something to report.  A place is found for every path that the file itself holds; a missing key has the place of the
table it is missing from.  Lines and columns count from 1, columns in characters.
"""

import re
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from pipeline.paths import Path

if TYPE_CHECKING:
    from tree_sitter import Node

LARGEST_BYTES = 8_000_000
"""Above this the second parse would take seconds and half a gigabyte; messages then name the path only."""


_NOT_JSON = re.compile(rb"(?<=[:,\[\s])-?(?:NaN|Infinity)(?=[\s,\]}])")
"""Python's reader takes these for numbers, the grammar of JSON does not; digits of the same width keep the columns."""


@dataclass(frozen=True, slots=True)
class Place:
    """Line and column of a key, and of its value; the same for what has no key."""

    key: tuple[int, int]
    value: tuple[int, int]


@dataclass(slots=True)
class Index:
    """The places found so far.  Only what is on the way to a wanted path is looked at."""

    lines: list[bytes]
    on_the_way: frozenset[Path]
    places: dict[Path, Place] = field(default_factory=dict)

    def add(self, path: Path, key: "Node", value: "Node") -> bool:
        """Note a place, the first one of a path only; return whether it is worth looking further inside."""
        self.places.setdefault(path, Place(self.position(key), self.position(value)))
        return path in self.on_the_way

    def position(self, node: "Node") -> tuple[int, int]:
        """Return line and column of the first character, from 1."""
        row, column = node.start_point
        before = self.lines[row][:column] if row < len(self.lines) else b""
        return row + 1, len(before.decode("utf-8", "replace")) + 1


def places(text: str, *, is_json: bool, wanted: Iterable[Path]) -> dict[Path, Place]:
    """Return the places of the wanted paths and of all tables and arrays on the way to them."""
    source = text.encode()
    prefixes = frozenset(path[:count] for path in wanted for count in range(len(path) + 1))
    if len(source) > LARGEST_BYTES:
        return {}
    index = Index(source.split(b"\n"), prefixes, {(): Place((1, 1), (1, 1))})
    (_json_document if is_json else _toml_document)(index, _parse(source, is_json=is_json))
    return index.places


def nearest(found: dict[Path, Place], path: Path) -> Place | None:
    """Return the place of a path, or of the innermost table around it; None if no places were looked up."""
    return next((found[path[:count]] for count in range(len(path), -1, -1) if path[:count] in found), None)


def _parse(source: bytes, *, is_json: bool) -> "Node":
    from tree_sitter import Language, Parser

    if is_json:
        from tree_sitter_json import language

        source = _NOT_JSON.sub(lambda found: b"0" * len(found[0]), source)
    else:
        from tree_sitter_toml import language
    return Parser(Language(language())).parse(source).root_node


def _toml_document(index: Index, root: "Node") -> None:
    """Note pairs, tables and arrays of tables; `[a.b]` below `[[a]]` belongs to the last one."""
    counts: dict[Path, int] = {}
    for node in root.children:
        if node.type == "pair":
            _toml_pair(index, (), node)
        elif node.type in {"table", "table_array_element"}:
            base = _header(index, node, counts)
            for pair in node.children:
                if pair.type == "pair":
                    _toml_pair(index, base, pair)


def _header(index: Index, table: "Node", counts: dict[Path, int]) -> Path:
    """Return the path that a table's header opens, arrays of tables counted."""
    names = _toml_keys(table.children[1])
    path: Path = ()
    for name in names[:-1]:
        path = _inside((*path, name), counts)
        index.add(path, table, table)
    path += (names[-1],)
    if table.type == "table":
        path = _inside(path, counts)
    else:
        index.add(path, table, table)
        counts[path] = counts.get(path, -1) + 1
        path += (counts[path],)
    index.add(path, table, table)
    return path


def _inside(path: Path, counts: dict[Path, int]) -> Path:
    return (*path, counts[path]) if path in counts else path


def _toml_pair(index: Index, base: Path, pair: "Node") -> None:
    key, value = pair.children[0], pair.children[-1]
    names = _toml_keys(key)
    for count in range(1, len(names)):
        index.add(base + names[:count], key, key)
    path = base + names
    if index.add(path, key, value):
        _toml_value(index, path, value)


def _toml_value(index: Index, path: Path, value: "Node") -> None:
    if value.type == "inline_table":
        for pair in value.children:
            if pair.type == "pair":
                _toml_pair(index, path, pair)
    elif value.type == "array":
        for i, item in enumerate(_items(value)):
            if index.add((*path, i), item, item):
                _toml_value(index, (*path, i), item)


def _toml_keys(node: "Node") -> Path:
    """Return the names of a bare, quoted or dotted key."""
    if node.type == "dotted_key":
        return tuple(name for child in node.children for name in _toml_keys(child))
    if node.type == "quoted_key":
        return (next(iter(tomllib.loads(f"{_text(node)} = 1"))),)
    return (_text(node),) if node.type == "bare_key" else ()


def _json_document(index: Index, root: "Node") -> None:
    for value in root.children:
        if index.add((), value, value):
            index.places[()] = Place(index.position(value), index.position(value))
            _json_value(index, (), value)


def _json_value(index: Index, path: Path, value: "Node") -> None:
    if value.type == "object":
        for pair in value.children:
            if pair.type == "pair":
                key, inner = pair.children[0], pair.children[-1]
                name = _json_name(key)
                if index.add((*path, name), key, inner):
                    _json_value(index, (*path, name), inner)
    elif value.type == "array":
        for i, item in enumerate(_items(value)):
            if index.add((*path, i), item, item):
                _json_value(index, (*path, i), item)


def _json_name(key: "Node") -> str:
    import json

    return str(json.loads(_text(key)))


def _items(array: "Node") -> "Iterator[Node]":
    return (child for child in array.children if child.is_named and child.type != "comment")


def _text(node: "Node") -> str:
    return (node.text or b"").decode()
