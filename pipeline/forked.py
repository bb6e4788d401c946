"""A call made for each of some numbers by several processes at a time, forked from this one when it is to be made.

Each process has what this one has, the modules and all that was worked out so far, at no cost, and is told numbers
alone; what it answers is sent back.  This process only hands out and collects.

On Linux alone: elsewhere a forked process may not use the libraries that its parent has begun to use, and all calls are
made in this one.
"""

import copy
import gc
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import TypeVar, cast

from pipeline.batch import children
from pipeline.inturn import Each, in_turn

T = TypeVar("T")


def each_by(workers: int) -> Each:
    """Return the way to make a call for each of some numbers in so many processes."""

    def each(call: Callable[[int], T], count: int) -> Iterator[T]:
        return iter(in_turn(call, count)) if min(workers, count) <= 1 or not forks() else forked(call, count, workers)

    return each


def forks() -> bool:
    """Return whether this system can go on in a copy of a process."""
    return sys.platform == "linux"


class EndedError(Exception):
    """A process has ended that should not have: at which number, and how."""

    def __init__(self, number: int, said: str) -> None:
        super().__init__(f"the process at number {number} has ended: {said}")
        self.number, self.said = number, said


@dataclass(frozen=True, slots=True)
class Failed:
    """What was raised in the place of a value."""

    error: BaseException


@dataclass(slots=True)
class Hand:
    """A process that works, and the pipe to it.  number: what it is at; -1: nothing."""

    process: BaseProcess
    pipe: Connection
    number: int = -1

    def ask(self, left: Iterator[int]) -> None:
        """Tell it the next number, if there is one."""
        self.number = next(left, -1)
        with suppress(OSError):  # it has ended, which is seen where its answer is waited for
            if self.number >= 0:
                self.pipe.send(self.number)

    def answer(self) -> object:
        """Return what came of its number: a value, or `Failed`."""
        try:
            return self.pipe.recv()
        except (EOFError, OSError):
            self.process.join()
            said, _ = children.end_of(self.process.exitcode or 0, server=0)
            return Failed(EndedError(self.number, said))

    def end(self) -> None:
        """End the process, whatever it does."""
        if self.process.pid is not None:
            children.kill_group(self.process.pid)
        self.process.kill()
        self.process.join()
        self.pipe.close()


def forked(call: Callable[[int], T], count: int, workers: int) -> Iterator[T]:
    """Yield what a call returns for each number below a count, made by that many processes."""
    left, ready = iter(range(count)), dict[int, object]()
    hands: list[Hand] = []
    try:
        for _ in range(min(workers, count)):
            hands.append(_started(call))
            hands[-1].ask(left)
        for number in range(count):
            while number not in ready:
                _collect(hands, left, ready)
            value = ready.pop(number)
            if isinstance(value, Failed):
                raise value.error
            yield cast("T", value)
    finally:
        for hand in hands:
            hand.end()


def _collect(hands: Sequence[Hand], left: Iterator[int], ready: dict[int, object]) -> None:
    """Take what has been answered, and tell who has answered what is next.

    Numbers are handed out in order, so someone is at the one that is waited for, or has answered it.
    """
    at_work = [hand for hand in hands if hand.number >= 0]
    answered = wait([hand.pipe for hand in at_work])
    for hand in at_work:
        if hand.pipe in answered:
            number, ready[number] = hand.number, hand.answer()
            hand.ask(left)


def _started(call: Callable[[int], object]) -> Hand:
    """Return a new process that makes a call for the numbers it is told."""
    context = get_context("fork")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(call, there, os.getpid()), daemon=True)
    process.start()
    there.close()
    return Hand(process, here)


def _serve(call: Callable[[int], object], pipe: Connection, parent: int) -> None:
    """Answer numbers until there are no more; runs in the child."""
    gc.freeze()
    children.tame(parent)
    while True:
        answer = _answer(call, pipe.recv())
        try:
            pipe.send(answer)
        except Exception as error:  # it cannot be sent; nothing of it has been
            pipe.send(Failed(_plain(error)))


def _answer(call: Callable[[int], object], number: int) -> object:
    try:
        return call(number)
    except BaseException as error:
        return Failed(_copied(error))


def _copied(error: BaseException) -> BaseException:
    """Return an error as it is where it can be built anew at the other end, else one that says the same."""
    try:
        copy.copy(error)
    except Exception:
        return _plain(error)
    return error


def _plain(error: BaseException) -> RuntimeError:
    told = RuntimeError(f"{type(error).__name__}: {error}")
    for note in getattr(error, "__notes__", ()):
        told.add_note(note)
    return told
