"""``morse rm``: delete a simulation environment."""

from __future__ import annotations

import shutil
from typing import Annotated

import typer

from morse.cli.messages import CommandError, nearest, say
from morse.cli.sites import Sites
from morse.core.reports.printing import echo
from morse.system.shared_folders import home


def command(
    env: Annotated[str, typer.Argument(help="A registered environment.")],
    force: Annotated[bool, typer.Option("-f", "--force", help="Do not ask for confirmation.")] = False,
) -> None:
    """Delete a simulation environment: its directory with everything in it, and its registration."""
    name = env.rstrip("/")
    sites = Sites()
    directory = sites.find(name)
    if directory is None:
        raise CommandError(f"There is no environment '{env}'.{nearest(name, sites.names())} {sites.known()}")
    if not directory.is_dir():
        sites.forget(name)
        say(f"{directory} did not exist any more; the environment '{name}' is no longer registered.")
        return
    if (own := home()) is not None and own.resolve().is_relative_to(directory.resolve()):
        sites.forget(name)
        raise CommandError(
            f"{directory} contains your home directory, and was not deleted. '{name}' is no longer registered."
        )
    if not force and not _confirmed(f"Delete {directory} and everything in it?"):
        say("Nothing was deleted.")
        return
    if directory.is_symlink():
        directory.unlink()
    else:
        shutil.rmtree(directory)
    sites.forget(name)
    say(f"Deleted the environment '{name}' ({directory}).")


def _confirmed(question: str) -> bool:
    echo(f"* {question} [y/N] ", end="")
    try:
        return input().strip().lower() in ("y", "yes")
    except EOFError:
        echo()
        return False
