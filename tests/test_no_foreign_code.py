"""Nothing that is read becomes code: no pickle, no eval, no expressions, no shell, no network in the packages."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FILES = sorted(file for package in ("pipeline", "stages") for file in (ROOT / package).rglob("*.py"))
CALLS = {"eval", "exec", "compile", "__import__", "breakpoint", "input"}
MODULES = {
    "pickle", "cPickle", "dill", "cloudpickle", "joblib", "shelve", "marshal", "code", "codeop", "imp", "runpy",
    "socketserver", "ssl", "http", "urllib.request", "ftplib", "smtplib", "requests", "httpx", "aiohttp", "xmlrpc",
    "webbrowser", "yaml", "sympy", "numexpr", "asteval", "xml.sax", "xml.dom",
}  # fmt: skip
ATTRIBUTES = {"system", "popen", "socket", "create_connection", "allow_pickle", "eval", "lambdify", "sympify"}
SUBPROCESS = {"pipeline/cad/files.py", "stages/nest/child.py"}
"""Where processes are started by a list of arguments, all of them the program's own."""


def offences(text: str, name: str) -> Iterator[str]:
    """Yield what a file may not do."""
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.Import(names=names):
                modules = [one.name for one in names]
            case ast.ImportFrom(module=str() as module):
                modules = [module]
            case ast.Call(func=ast.Name(id=called)) if called in CALLS:
                yield f"{name}:{node.lineno}: {called}"
                continue
            case ast.Attribute(attr=attribute, value=ast.Name(id=owner)) if (owner, attribute) != ("re", "compile"):
                if attribute in ATTRIBUTES:
                    yield f"{name}:{node.lineno}: .{attribute}"
                continue
            case ast.keyword(arg="shell" | "allow_pickle", value=value):
                if not (isinstance(value, ast.Constant) and value.value is False):
                    yield f"{name}: {node.arg}"
                continue
            case _:
                continue
        for module in modules:
            if any(module == one or module.startswith(f"{one}.") for one in MODULES):
                yield f"{name}:{node.lineno}: import {module}"
            if module == "subprocess" and name not in SUBPROCESS:
                yield f"{name}:{node.lineno}: import subprocess"


def test_there_are_files_to_look_at() -> None:
    assert len(FILES) > 100


def test_no_file_of_the_packages_makes_code_of_what_it_reads() -> None:
    found = [each for file in FILES for each in offences(file.read_text("utf-8"), file.relative_to(ROOT).as_posix())]
    assert found == []


PLANTED = (
    "import pickle", "from pickle import loads", "import os\nos.system('x')", "eval('1')", "exec('1')",
    "x = compile('1', '', 'eval')", "import urllib.request", "from http import client", "import yaml",
    "import numpy as np\nnp.load('x', allow_pickle=True)", "import subprocess", "run(['x'], shell=True)",
    "__import__('os')", "import http.server as s", "import socket\nsocket.socket()",
)  # fmt: skip


@pytest.mark.parametrize("text", PLANTED)
def test_each_of_them_is_seen(text: str) -> None:
    assert list(offences(text, "planted.py"))


HARMLESS = ("import re\nre.compile('x')", "load(x, allow_pickle=False)", "import json", "model.evaluate(x)")


@pytest.mark.parametrize("text", HARMLESS)
def test_what_is_harmless_is_not(text: str) -> None:
    assert not list(offences(text, "planted.py"))
