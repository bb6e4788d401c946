"""The set-up: `dev.py` is small and of the standard library, the lock complete and without addresses."""

import ast
import re
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOCK = (ROOT / "requirements.lock").read_text("utf-8")


def test_dev_is_short_and_imports_the_standard_library_only() -> None:
    text = (ROOT / "dev.py").read_text("utf-8")
    assert len(text.splitlines()) < 100
    imported = {
        (node.module if isinstance(node, ast.ImportFrom) else node.names[0].name) or ""
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    assert imported <= sys.stdlib_module_names


@pytest.mark.parametrize(
    ("words", "module", "rest"),
    [
        (["bench", "nest", "--seconds", "5"], "tests.bench.nest", ["--seconds", "5"]),
        (["bench", "kernels", "-k", "nest"], "pytest", ["-k", "nest"]),
        (["types"], "mypy", []),
    ],
)
def test_two_words_are_a_chore_before_one_is(
    words: list[str], module: str, rest: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    dev = runpy.run_path(str(ROOT / "dev.py"))
    run: list[list[str]] = []

    def ended(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        run.append(command[1:])
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(subprocess, "run", ended)
    monkeypatch.setitem(dev["main"].__globals__, "set_up", lambda: None)
    monkeypatch.setattr(sys, "argv", ["dev.py", *words])
    dev["main"]()
    assert run[0][:2] == ["-m", module]
    assert run[0][len(run[0]) - len(rest) :] == rest


def test_the_lock_holds_every_dependency_with_hashes_and_no_address() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    wanted = [
        *project["project"]["dependencies"],
        *project["project"]["optional-dependencies"]["cad"],
        *(name for name in project["project"]["optional-dependencies"]["dev"] if not name.startswith("planish")),
        *project["build-system"]["requires"],
    ]
    locked = set(re.findall(r"^([a-z0-9-]+)==", LOCK, re.MULTILINE))
    assert {re.split(r"[<>=!~ ]", name)[0] for name in wanted} <= locked
    for line in LOCK.splitlines():
        assert re.fullmatch(r"[a-z0-9-]+==[0-9.a-z]+( ; .+)? \\|    --hash=sha256:[0-9a-f]{64}( \\)?", line)
