"""The scripts of the page, those of the formed view among them: fit to stand in it, asking nothing of a network."""

import json
import re
from importlib.resources import files

import pytest

from pipeline.report.html import LIBRARY, SCRIPTS

ASSETS = files("pipeline") / "data" / "report"
NAMESPACES = {"http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg"}
"""Names of elements, never asked for."""
ASKING = re.compile(
    r"\bfetch\(|XMLHttpRequest|WebSocket|importScripts|sendBeacon|EventSource|sourceMappingURL|\beval\("
)


@pytest.mark.parametrize("name", [LIBRARY, *SCRIPTS])
def test_a_script_can_stand_in_a_page_and_asks_for_nothing(name: str) -> None:
    text = (ASSETS / name).read_text("utf-8")
    assert "</script" not in text.lower()
    assert "<!--" not in text
    assert set(re.findall(r"https?://[^\s\"'`)]+", text)) <= NAMESPACES
    assert not ASKING.findall(text)


def test_the_library_carries_its_licence_and_the_version_it_is_built_from() -> None:
    text, licence = ((ASSETS / name).read_text("utf-8") for name in (LIBRARY, "three.LICENSE.txt"))
    head = text.partition("*/")[0]
    assert licence.strip() in head
    assert "MIT" in licence
    wanted = json.loads((ASSETS / "viewer" / "package.json").read_text("utf-8"))["devDependencies"]["three"]
    assert f"three.js {wanted}," in head


def test_the_lock_file_names_versions_and_digests_and_no_address() -> None:
    lock = json.loads((ASSETS / "viewer" / "package-lock.json").read_text("utf-8"))
    wanted = json.loads((ASSETS / "viewer" / "package.json").read_text("utf-8"))["devDependencies"]
    packages = {name: entry for name, entry in lock["packages"].items() if name}
    assert {name: packages[f"node_modules/{name}"]["version"] for name in wanted} == wanted
    assert all("integrity" in entry and "resolved" not in entry for entry in packages.values())
