"""``morse create``: create a new simulation environment."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Annotated

import typer

from morse.cli.messages import CommandError, say
from morse.cli.names import environment_name
from morse.cli.sites import Sites
from morse.cli.templates import Values, write_environment
from morse.core.reports.printing import echo


def command(
    env: Annotated[str, typer.Argument(help="Name of the new environment: letters, digits and underscores.")],
    force: Annotated[bool, typer.Option("-f", "--force", help="Replace an existing directory.")] = False,
) -> None:
    """Create a new simulation environment in the current directory, with an example scene."""
    name = environment_name(env)
    sites = Sites()
    directory = Path.cwd() / name
    registered = sites.find(name)
    if registered is not None and not force:
        raise CommandError(
            f"The environment '{name}' already exists, at {registered}. Choose another name, replace it with `morse "
            f"create -f {name}`, or remove it with `morse rm {name}`."
        )
    _make_room(directory, force)
    paths = write_environment(directory, Values(name))
    sites.register(name, directory)

    say(f"Created the environment '{name}' in {directory}:")
    for path in paths:
        echo(f"    {path.relative_to(directory.parent)}")
    say(f"Start it with:           morse run {name}")
    say(f"Change the scene in:     {directory / 'default.py'}")
    say(f"Drive its robot from:    {directory / 'scripts' / f'{name}_client.py'}")
    say(f"Test it with:            pytest {name}")
    say(f"Add your own robot: morse add robot rover {name}")


def _make_room(directory: Path, force: bool) -> None:
    if not directory.exists() and not directory.is_symlink():
        return
    if not directory.is_dir() or directory.is_symlink():
        raise CommandError(f"{directory} exists and is not a directory: move it, or choose another name.")
    if not force:
        raise CommandError(
            f"{directory} exists already. Register it with `morse import {directory.name}`, choose another name, or "
            f"replace it and everything in it with `morse create -f {directory.name}`."
        )
    shutil.rmtree(directory)
