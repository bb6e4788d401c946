"""Paths into a job file: `part[0].surface.k0` as text, ("part", 0, "surface", "k0") as a value."""

import json
import re

Path = tuple[str | int, ...]

_QUOTED = r'"(?P<quoted>(?:[^"\\\x00-\x1f]|\\(?:["\\/bfnrt]|u[0-9A-Fa-f]{4}))*)"'
"""A string as JSON writes it, so that what it stands for can always be told."""
_STEP = re.compile(rf"\[(?P<index>\d{{1,9}})\]|(?P<dot>\.)?(?:(?P<bare>[A-Za-z0-9_-]+)|{_QUOTED})")
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def written(path: Path) -> str:
    """Return the path as text; names that are not plain words are quoted."""
    text = ""
    for step in path:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            name = step if _BARE.fullmatch(step) else json.dumps(step)
            text += f".{name}" if text else name
    return text


def parsed(text: str) -> Path | None:
    """Return the path that a text writes, or None if it writes none."""
    steps: list[str | int] = []
    at = 0
    while at < len(text):
        found = _STEP.match(text, at)
        if found is None or (found["index"] is None and bool(found["dot"]) != bool(steps)):
            return None
        steps.append(_step(found))
        at = found.end()
    return tuple(steps)


def _step(found: re.Match[str]) -> str | int:
    if found["index"] is not None:
        return int(found["index"])
    if found["bare"] is not None:
        return found["bare"]
    return str(json.loads(f'"{found["quoted"]}"'))
