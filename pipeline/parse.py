"""The text of a job file, TOML or JSON by its ending, -> plain tables and arrays; and `--set`.

Numbers with a point become Decimals, so that 0.1 stays one tenth.  Syntax errors, files too large, wrong encodings and
nesting beyond reason are problems of the file like any other.
"""

import json
import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from decimal import Decimal, InvalidOperation
from difflib import get_close_matches
from pathlib import Path as FilePath

from pipeline.decode import Repeated
from pipeline.paths import Path, parsed
from pipeline.reach import TooLargeError, limited, plain
from stages.errors import BadInputError, Problem

LARGEST_FILE = 20_000_000
"""Bytes; some 300 000 points.  A file above this is no description of a part."""

DEEPEST = 40
"""Tables and arrays in each other; a curve in a chain in a piece of a strip takes a dozen."""
_TOML_PLACE = re.compile(r" \(at line (\d+), column (\d+)\)$")
_STEP = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_STEP}(?:\.[ \t]*+{_STEP}){{{DEEPEST}}}")
"""A dotted name that opens so many tables: tomllib takes the square of their number to read it."""
_LONG_NUMBER = re.compile(r"[0-9A-Fa-f_]{4000,}")
JSON_ENDINGS = (".json", ".jsonl", ".ndjson")
"""One table in a file, and one in each line of a file."""
MOST_VALUES = 500_000
"""Tables, arrays and values of a file: some 150 000 points, which are looked at one by one."""
DEEP = "tables or arrays are nested too deeply"


def read_bytes(file: FilePath) -> bytes:
    """Return the bytes of a job file; `BadInputError` if it is not there or too large."""
    try:
        return limited(plain(file), LARGEST_FILE)
    except TooLargeError:
        too_large = f"larger than {LARGEST_FILE // 10**6} MB"
        raise BadInputError(Problem(too_large, hint="is this a job file?", file=str(file))) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise BadInputError(Problem(f"cannot be read: {reason}", hint=_instead(file), file=str(file))) from None


def _instead(file: FilePath) -> str:
    """Return which file may have been meant where one cannot be read; nothing where none comes near."""
    folder = file if file.is_dir() else file.parent
    try:
        names = {each.stem: each.name for each in folder.iterdir() if each.suffix.lower() in (".toml", *JSON_ENDINGS)}
    except (OSError, ValueError):
        return "" if folder.is_dir() else f"there is no folder {folder}"
    alone = [*names] if len(names) == 1 else []
    near = alone if folder == file else get_close_matches(file.stem, sorted(names), 1)
    return f"did you mean {folder / names[near[0]]}?" if near else ""


def text_of(content: bytes, file: FilePath) -> str:
    """Return the text of a job file; `BadInputError` with the place of what is not UTF-8."""
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        before = content[: error.start]
        line, column = before.count(b"\n") + 1, error.start - before.rfind(b"\n")
        hint = "save the file as UTF-8"
        raise BadInputError(Problem("not UTF-8 text", hint=hint, file=str(file), line=line, column=column)) from None


def parse(text: str, file: FilePath) -> dict[str, object]:
    """Return the top table; `BadInputError` with the place of a syntax error."""
    if not is_json(file):
        _refuse_long_keys(text, file)
    try:
        raw = _parse_json(text) if is_json(file) else tomllib.loads(text, parse_float=_number)
    except RecursionError:
        raise BadInputError(Problem(DEEP, file=str(file))) from None
    except ValueError as error:
        raise BadInputError(_syntax_problem(text, str(file), error)) from None
    if not isinstance(raw, dict):
        raise BadInputError(Problem("a job file is one table", file=str(file), line=1, column=1))
    return raw


def _refuse_long_keys(text: str, file: FilePath) -> None:
    found = _LONG_KEY.search(text)
    if found is not None:
        line = text.count("\n", 0, found.start()) + 1
        raise BadInputError(Problem(DEEP, hint=f"at most {DEEPEST} in each other", file=str(file), line=line))


def refuse_huge(raw: object, file: FilePath, most: int = MOST_VALUES) -> None:
    """Raise `BadInputError` for tables that are nested too deeply or hold too much; nothing is looked at but that."""
    level, count, depth = [raw], 1, 0
    while level:
        level = [inner for item in level for inner in _inside(item)]
        count, depth = count + len(level), depth + 1
        if depth > DEEPEST:
            raise BadInputError(Problem(DEEP, hint=f"at most {DEEPEST} in each other", file=str(file)))
        if count > most:
            message = f"more than {most} values"
            raise BadInputError(Problem(message, hint="divide it, or give curves in drawings", file=str(file)))


def _inside(item: object) -> Iterable[object]:
    if isinstance(item, dict):
        return item.values()
    return item if isinstance(item, list) else ()


def is_json(file: FilePath) -> bool:
    """Return whether the file is read as JSON."""
    return file.suffix.lower() in JSON_ENDINGS


def _number(text: str) -> Decimal | str:
    """Return the number; the text itself where no Decimal can hold its exponent."""
    try:
        return Decimal(text)
    except InvalidOperation:
        return text


def _parse_json(text: str) -> object:
    return json.loads(text, parse_float=_number, parse_constant=Decimal, object_pairs_hook=_object)


def _object(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    """Return the object, and remember the names that json would silently overwrite."""
    plain = dict(pairs)
    if len(plain) == len(pairs):
        return plain
    table = Repeated(plain)
    table.twice = tuple(name for name, count in Counter(name for name, _ in pairs).items() if count > 1)
    return table


def _syntax_problem(text: str, file: str, error: ValueError) -> Problem:
    """Return what the parser says, in our form."""
    if isinstance(error, json.JSONDecodeError):
        return Problem(f"JSON: {error.msg}", file=file, line=error.lineno, column=error.colno)
    place = _TOML_PLACE.search(str(error))
    if place:
        message, line = str(error)[: place.start()], int(place[1])
        hint = _toml_hint(text.split("\n")[line - 1][:LOOKED_AT])
        return Problem(f"TOML: {message}", hint=hint, file=file, line=line, column=int(place[2]))
    digits = _LONG_NUMBER.search(text)
    if isinstance(error, tomllib.TOMLDecodeError) or digits is None:
        message = f"TOML: {str(error).removesuffix(' (at end of document)')}"
        return Problem(message, file=file, line=text.rstrip("\n").count("\n") + 1, column=1)
    before = text[: digits.start()]
    line, column = before.count("\n") + 1, digits.start() - before.rfind("\n")
    return Problem("a number of thousands of digits", file=file, line=line, column=column)


_UNQUOTED = (
    (re.compile(r"[=\[,]\s*(-?[\d./]+ ?(?:mm|cm|m|um|in|ft|deg|rad|\"|'))(?![\w\"'])"), "a number with its unit"),
    (re.compile(r"=\s*(?!true|false|inf|nan)([^\W\d][\w .-]*?)\s*(?:[,}#]|$)"), "a text"),
)
LOOKED_AT = 500
"""Letters of a line that TOML does not read: what is meant there is seen at its begin."""
_DECIMAL_COMMA = re.compile(r"=\s*-?(\d+),(\d+)")


def _toml_hint(line: str) -> str:
    """Return what is most likely meant on a line that TOML does not read: quotes that are missing, a decimal comma."""
    comma = _DECIMAL_COMMA.search(line)
    if comma is not None:
        return f"decimals come after a point: {comma[1]}.{comma[2]}"
    for pattern, what in _UNQUOTED:
        found = pattern.search(line)
        if found is not None:
            return f'{what} stands in quotes: "{found[1]}"'
    return ""


SET = "--set"
"""Stands in messages where the name of a file would."""


class Setting(str):
    """`path=value` that was not said by `--set`; origin: where it was, as messages say it."""

    origin: str = SET


def setting_of(path: str, value: str, origin: str) -> Setting:
    """Return a setting with its origin."""
    made = Setting(f"{path}={value}")
    made.origin = origin
    return made


def override(raw: dict[str, object], settings: Iterable[str]) -> dict[Path, str]:
    """Set `path=value` in place and return the paths set with their origins; `BadInputError` for what cannot be set."""
    paths: dict[Path, str] = {}
    problems: list[Problem] = []
    for setting in settings:
        origin = setting.origin if isinstance(setting, Setting) else SET
        name, equals, value = setting.partition("=")
        path = parsed(name.strip())
        if not (equals and path):
            example = "write --set part[0].surface.k0=1"
            problems.append(Problem(f'"{setting}" is not path=value', hint=example, file=origin))
        elif not _put(raw, path, _setting_value(value.strip())):
            hint = "the tables and arrays on the way must be there, or be tables"
            problems.append(Problem("no such place in the job file", path=name.strip(), hint=hint, file=origin))
        else:
            paths[path] = origin
    if problems:
        raise BadInputError(*problems)
    return paths


def _setting_value(text: str) -> object:
    """Return what TOML makes of the text, or the text itself: `1/3` and `steel` need no quotes."""
    try:
        table = tomllib.loads(f"value = {text}", parse_float=_number)
    except (ValueError, RecursionError):
        return text
    return table["value"] if len(table) == 1 else text


def _put(raw: dict[str, object], path: Path, value: object) -> bool:
    """Set the value; missing tables are made, missing array items are not."""
    here: object = raw
    for step, after in zip(path, (*path[1:], None), strict=True):
        last = after is None
        if isinstance(step, str) and isinstance(here, dict):
            if last:
                here[step] = value
            here = here.get(step) if last or not isinstance(after, str) else here.setdefault(step, {})
        elif isinstance(step, int) and isinstance(here, list) and step < len(here):
            if last:
                here[step] = value
            here = here[step]
        else:
            return False
    return True
