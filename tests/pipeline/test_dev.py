"""The set-up: `dev.py` is small and of the standard library, the lock complete and without addresses."""

import ast
import re
import sys
import tomllib
from pathlib import Path

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
