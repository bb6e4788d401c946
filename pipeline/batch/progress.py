"""How far a batch is, while it runs: a line that changes on a terminal, one every ten seconds else, events as JSON."""

import json
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic

from pipeline.batch.runner import Event, Loop
from pipeline.batch.told import Tally

TERMINAL_S, PLAIN_S = 0.2, 10.0
"""Between two lines."""
FIRST_S = 60.0
"""Between those that come before the first job has ended, once it was said that the workers start."""
WINDOW_S = 30.0
"""The rate is that of this time: of the whole run it would hide that jobs become longer."""
MOST_TOLD = 20
"""Failures that are told while it runs; after that only their number is."""
MINUTE, HOUR, DAY = 60, 3600, 86_400

Say = Callable[[str], None]


@dataclass(slots=True)
class Progress:
    """Listens to a run.  say: is given lines for people; write: lines of JSON, None where no one asked for them."""

    say: Say
    write: Say | None = None
    terminal: bool = False
    quiet: bool = False
    ended: Counter[str] = field(default_factory=Counter)
    samples: deque[tuple[float, int]] = field(default_factory=deque)
    shown: float = 0.0
    begun: bool = False
    width: int = 0

    def __call__(self, loop: Loop, event: Event | None) -> None:
        """Take note of what happened, and tell it."""
        now = monotonic()
        if not self.samples:
            self.samples.append((now, 0))
            self.shown = now
        if event is not None:
            self._note(event)
        if now - self.shown >= self._pause():
            self.shown = now
            self._show(loop, now)

    def _pause(self) -> float:
        """Return the seconds between two lines: before the first job has ended there is little to tell twice."""
        if self.terminal or self.write is not None:
            return TERMINAL_S if self.terminal else PLAIN_S
        return FIRST_S if self.begun and not self.ended else PLAIN_S

    def _note(self, event: Event) -> None:
        record = event.record
        if event.final:
            self.ended[record.status] += 1
        if self.write is not None:
            said = {"event": "ended" if event.final else "again", "job": event.job, "status": record.status}
            figures = {"cause": record.cause, "seconds": round(record.seconds, 6), "tries": event.tries}
            self.write(json.dumps(said | figures))
        failed = self.ended.total() - self.ended["made"]
        if not self.quiet and record.status != "made" and failed <= MOST_TOLD:
            again = "" if event.final else " (runs again)"
            self._line(f"{event.job}: {record.status}: {record.cause}{again}")

    def _show(self, loop: Loop, now: float) -> None:
        """Say how far it is."""
        done = self.ended.total()
        self.samples.append((now, done))
        while len(self.samples) > 1 and now - self.samples[1][0] > WINDOW_S:
            self.samples.popleft()
        since, before = self.samples[0]
        rate = (done - before) / max(now - since, 1e-9)
        if self.write is not None:
            said = {"event": "progress", "accepted": loop.accepted, "ended": done, "left": loop.left}
            self.write(json.dumps(said | {"rate": round(rate, 3)}))
        if not self.quiet:
            self._again(self.text(loop, rate)) if self.terminal else self.say(self.text(loop, rate))
        self.begun = True

    def text(self, loop: Loop, rate: float) -> str:
        """Return a line on how far it is, with the time that is left at this rate."""
        done, failed = self.ended.total(), self.ended.total() - self.ended["made"]
        of = f"{loop.accepted} jobs taken in" if loop.left is None else f"{loop.left} left"
        if not done:
            return f"{of}, none done yet" if self.begun and not self.terminal else f"{of}, the workers start"
        left = "" if loop.left is None or rate <= 0 else f", {duration(loop.left / rate)} to go"
        return f"{done} done, {of}, {rate:.3g}/s{left}{f', {failed} not made' if failed else ''}"

    def end(self, counts: Tally) -> None:
        """Say what became of all jobs."""
        if self.write is not None:
            self.write(json.dumps({"event": "end", **counts.document()}))
        if not self.quiet:
            told = self.ended.total() - self.ended["made"]
            known = told <= MOST_TOLD and told == sum(counts.ended.values()) - counts.ended["made"]
            self._line("\n".join(counts.lines()[: 1 if known else None]))

    def _again(self, text: str) -> None:
        """Write over the line that is there."""
        self.say(f"\r{text.ljust(self.width)}")
        self.width = len(text)

    def _line(self, text: str) -> None:
        """Write a line of its own."""
        self.clear()
        self.say(f"{text}\n" if self.terminal else text)

    def clear(self) -> None:
        """Leave no half line behind."""
        if self.terminal and self.width:
            self.say(f"\r{' ' * self.width}\r")
            self.width = 0


def duration(seconds: float) -> str:
    """Return a time as people say it."""
    if seconds < 2 * MINUTE:
        return f"{seconds:.0f} s"
    if seconds < 2 * HOUR:
        return f"{seconds / MINUTE:.0f} min"
    return f"{seconds / HOUR:.0f} h" if seconds < 2 * DAY else f"{seconds / DAY:.1f} days"
