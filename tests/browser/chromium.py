"""Chromium without a window, asked over two pipes by its DevTools protocol: a page is opened, then asked expressions.

Messages are JSON, each ended by a zero byte; chromium reads them from descriptor 3 and answers on 4.  What the page
tells of errors, warnings and requests is kept (`told`, `requests`).
"""

import json
import os
import select
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic

import pytest

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser")
SECONDS = 90.0
ALWAYS = ("--headless=new", "--no-sandbox", "--hide-scrollbars", "--remote-debugging-pipe", "--no-first-run")
WITH_WEBGL = (
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-accelerated-2d-canvas",
)
WITHOUT_WEBGL = ("--disable-gpu", "--disable-3d-apis")
READS, WRITES = 3, 4
"""Descriptors of chromium's own."""

needs_chromium = pytest.mark.skipif(PROGRAM is None, reason="chromium is not installed")


class Page:
    """One page; `told`: its errors and warnings.  `requests`: addresses that it asked for, its own file apart."""

    def __init__(self, to_page: int, from_page: int) -> None:
        self.told: list[str] = []
        self.requests: list[str] = []
        self._to, self._from, self._read, self._count, self._session = to_page, from_page, b"", 0, ""
        self._target: str | None = None

    def open(self, file: Path, width: int = 1000, height: int = 800, query: str = "") -> None:
        """Open a page instead of the one that is open, and wait until it is loaded; query: behind its address."""
        self._session, before = "", self._target
        target = self._target = self._ask("Target.createTarget", url="about:blank")["targetId"]
        if before is not None:
            self._ask("Target.closeTarget", targetId=before)
        self._session = self._ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.told, self.requests = [], []
        for domain in ("Runtime", "Log", "Network", "Page"):
            self._ask(f"{domain}.enable")
        screen = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self._ask("Emulation.setDeviceMetricsOverride", **screen)
        self._address = file.as_uri() + query
        self._ask("Page.navigate", url=self._address)
        self.ask("new Promise((done) => document.readyState === 'complete' ? done() : addEventListener('load', done))")

    def ask(self, expression: str) -> object:
        """Return the value of an expression, awaited if it is a promise."""
        reply = self._ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in reply:
            raise AssertionError(reply["exceptionDetails"])
        return reply["result"].get("value")

    def _ask(self, method: str, **parameters: object) -> dict:
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        end = monotonic() + SECONDS
        while True:
            reply = self._next(end)
            if reply.get("id") == self._count:
                assert "error" not in reply, reply
                return reply["result"]
            if reply.get("sessionId", "") == self._session:
                self._hear(reply.get("method", ""), reply.get("params", {}))

    def _next(self, end: float) -> dict:
        while b"\0" not in self._read:
            ready, _, _ = select.select([self._from], [], [], max(end - monotonic(), 0.0))
            more = os.read(self._from, 1 << 20) if ready else b""
            assert more, "chromium does not answer"
            self._read += more
        message, _, self._read = self._read.partition(b"\0")
        return json.loads(message)

    def _hear(self, method: str, said: dict) -> None:
        if method == "Runtime.exceptionThrown":
            self.told.append(json.dumps(said["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and said["type"] in ("error", "warning", "assert"):
            self.told.append(json.dumps(said["args"]))
        elif method == "Log.entryAdded" and said["entry"]["level"] in ("error", "warning"):
            self.told.append(said["entry"]["text"])
        elif method == "Network.requestWillBeSent" and said["request"]["url"] != self._address:
            self.requests.append(said["request"]["url"])


@contextmanager
def opened(file: Path, profile: Path, *flags: str, query: str = "") -> Iterator[Page]:
    """Open a file in a chromium of its own, which ends with the block; query: behind its address."""
    assert PROGRAM is not None
    (its_end, to_page), (from_page, its_answers) = os.pipe(), os.pipe()

    # chromium looks for its pipes on two fixed descriptors: a shell puts them there
    plumbing = f'exec {READS}<&{its_end} {WRITES}>&{its_answers}; exec "$@"'
    command = ["bash", "-c", plumbing, "chromium", PROGRAM, *ALWAYS, f"--user-data-dir={profile}", *flags]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(command, pass_fds=(its_end, its_answers), **quiet) as process:
        os.close(its_end)
        os.close(its_answers)
        try:
            page = Page(to_page, from_page)
            page.open(file, query=query)
            yield page
        finally:
            with suppress(OSError, AssertionError):
                page._ask("Browser.close")
            os.close(to_page)
            os.close(from_page)
            process.terminate()
