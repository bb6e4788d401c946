"""Which tests are asked about a module, and in which order: those named after it, then who imports it, nearest first.

How near is counted in imports, over the whole tree: a module that is named anywhere in a file, also inside of a
function or as a text, counts as imported there.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

FOLDERS = ("pipeline", "stages", "tests", "samples")
LEFT_OUT = ("tests/readers", "tests/browser", "tests/bench", "tests/mutants", "tests/pipeline/test_wheel.py")
"""Tests that need programs of other people, measure times, build a wheel, or are about mutants themselves."""


def module(file: str) -> str:
    """Return the name under which a file is imported."""
    return file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def files(root: Path) -> list[str]:
    """Return the names of all Python files of the project."""
    return sorted(path.relative_to(root).as_posix() for name in FOLDERS for path in (root / name).rglob("*.py"))


def imported(source: str) -> Iterator[str]:
    """Yield the names that a file may import."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import(names=names):
                yield from (name.name for name in names)
            case ast.ImportFrom(module=str() as package, names=names):
                yield package
                yield from (f"{package}.{name.name}" for name in names)
            case ast.Constant(value=str() as text) if text.startswith(("pipeline.", "stages.")):
                yield text


def importers(root: Path) -> dict[str, set[str]]:
    """Return who imports a module, by its file."""
    every = files(root)
    by_module = {module(file): file for file in every}
    found: dict[str, set[str]] = {}
    for file in every:
        for name in imported((root / file).read_text("utf-8")):
            if name in by_module:
                found.setdefault(by_module[name], set()).add(file)
    return found


def distances(found: dict[str, set[str]], file: str) -> dict[str, int]:
    """Return by how many imports each file is away from one."""
    away, edge = {file: 0}, [file]
    while edge:
        reached = sorted({other for name in edge for other in found.get(name, ())} - set(away))
        away |= dict.fromkeys(reached, away[edge[0]] + 1)
        edge = reached
    return away


def chosen_for(root: Path, found: dict[str, set[str]], file: str) -> list[str]:
    """Return the files of tests that may notice a change of a file, the likeliest first."""
    stem, folder = Path(file).stem, f"tests/{Path(file).parent.as_posix()}"
    away = distances(found, file)

    def order(test: str) -> tuple[bool, int, bool, str]:
        named = Path(test).stem
        mirrored = named == f"test_{stem}" or named.startswith(f"test_{stem}_")
        return not mirrored, away.get(test, len(found)), not test.startswith(folder), test

    tests = [name for name in files(root) if Path(name).name.startswith("test_") and not name.startswith(LEFT_OUT)]
    near = [test for test in tests if test in away or order(test)[0] is False]
    return sorted(near, key=order)
