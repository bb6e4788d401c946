"""Tables as the text of a job file, TOML or JSON; `Raw` stands as it is, whatever the format makes of it."""

import json
import re

BARE = re.compile(r"[A-Za-z0-9_-]+")


class Raw(str):
    """Text that is written without quotes: 1e308, nan, a number of a thousand digits."""

    __slots__ = ()


def as_toml(table: dict[str, object]) -> str:
    """Return a table as TOML, all but its top in one line each."""
    return "".join(f"{_key(key)} = {_value(value, toml=True)}\n" for key, value in table.items())


def as_json(table: object) -> str:
    """Return a table as JSON."""
    return _value(table, toml=False)


def _value(value: object, *, toml: bool) -> str:
    match value:
        case Raw():
            return str(value)
        case bool():
            return "true" if value else "false"
        case str():
            return _quoted(value) if toml else json.dumps(value, ensure_ascii=False)
        case dict():
            equals = " = " if toml else ": "
            rows = (
                f"{_key(key) if toml else json.dumps(key)}{equals}{_value(item, toml=toml)}"
                for key, item in value.items()
            )
            return "{" + ", ".join(rows) + "}"
        case list():
            return "[" + ", ".join(_value(item, toml=toml) for item in value) + "]"
        case None:
            return '"none"' if toml else "null"
    return repr(value)


def _key(key: str) -> str:
    return key if BARE.fullmatch(key) else _quoted(key)


def _quoted(text: str) -> str:
    """Return a basic string of TOML, which escapes what JSON leaves alone: the control character DEL."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")
