"""Commands that are looked up where they are called, so that the others do not wait for what they load."""

from importlib import import_module

import click

ELSEWHERE = {
    "batch": ("pipeline.batch.commands", "batch"),
    "doctor": ("pipeline.batch.doctoring", "doctor"),
    "explain": ("pipeline.batch.commands", "explain"),
    "retry": ("pipeline.batch.commands", "retry"),
    "status": ("pipeline.batch.commands", "status"),
}
"""Module and name of the commands that lie elsewhere, by what they are called."""


class Commands(click.Group):
    """The commands given to it, and those that lie elsewhere."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return sorted([*super().list_commands(ctx), *ELSEWHERE])

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command; None where there is none of that name."""
        if cmd_name not in ELSEWHERE:
            return super().get_command(ctx, cmd_name)
        module, name = ELSEWHERE[cmd_name]
        command = getattr(import_module(module), name)
        return command if isinstance(command, click.Command) else None
