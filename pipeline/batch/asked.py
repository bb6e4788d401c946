"""The command that a run was asked for with, so that whoever looks later can ask for the same again.

It is put together from what was given to the command, not from the words that the process was started with, which
may be those of another program that calls it.  Options come behind the arguments, in the order of the help.
"""

import os
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

import click
from click.core import ParameterSource

PROGRAM = "planish"


@dataclass(frozen=True, slots=True)
class Asked:
    """A command, and the folder that names of files in it begin at; both empty where no one has asked."""

    command: str = ""
    folder: str = ""

    def line(self) -> str:
        """Return what to type in the present folder."""
        here = not self.folder or self.folder == os.getcwd()  # noqa: PTH109  # a text, as the journal has it
        return self.command if here else f"cd {shlex.quote(self.folder)} && {self.command}"


def asked(context: click.Context) -> Asked:
    """Return what was asked for with a command that is being run."""
    words = [PROGRAM, context.info_name or "", *_words(context)]
    return Asked(shlex.join(words), os.getcwd())  # noqa: PTH109


def _words(context: click.Context) -> Iterator[str]:
    """Yield the arguments and options that were given, arguments last where one would be taken for an option."""
    given = [(parameter, _values(context, parameter)) for parameter in context.command.params]
    arguments = [word for parameter, words in given if isinstance(parameter, click.Argument) for word in words]
    mistaken = any(word.startswith("-") for word in arguments)
    if not mistaken:
        yield from arguments
    for parameter, words in given:
        if isinstance(parameter, click.Option):
            for word in words:
                yield from (parameter.opts[0], *([] if parameter.is_flag else [word]))
    if mistaken:
        yield from ("--", *arguments)


def _values(context: click.Context, parameter: click.Parameter) -> list[str]:
    """Return the values given to a parameter; one for a flag that is set, none for what was left out."""
    name = parameter.name or ""
    if context.get_parameter_source(name) is not ParameterSource.COMMANDLINE:
        return []
    value = context.params[name]
    return [str(each) for each in value] if isinstance(value, tuple) else [str(value)]
