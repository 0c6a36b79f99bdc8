"""``morse import``: register a directory as a simulation environment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from morse.cli.messages import CommandError, say
from morse.cli.names import registered_name
from morse.cli.sites import Sites


def command(
    path: Annotated[str, typer.Argument(help="Existing directory with scenes.")],
    name: Annotated[
        str | None, typer.Argument(help="Name of the environment (default: name of the directory).")
    ] = None,
    force: Annotated[bool, typer.Option("-f", "--force", help="Take the name from another environment.")] = False,
) -> None:
    """Register an existing directory as a simulation environment."""
    directory = Path(path).absolute()
    if not directory.is_dir():
        what = "a file, not a directory" if directory.exists() else "not there"
        raise CommandError(f"{directory} is {what}. `morse create NAME` creates a new environment.")
    name = registered_name(name if name is not None else directory.resolve().name)
    sites = Sites()
    registered = sites.find(name)
    if registered is not None and not force:
        raise CommandError(
            f"The environment '{name}' already exists, at {registered}. Give another name: `morse import {path} "
            "NAME`, or take the name from it with -f."
        )
    sites.register(name, directory.resolve())
    say(f"Registered the environment '{name}': {directory.resolve()}")
    say(f"Start it with: morse run {name}")
