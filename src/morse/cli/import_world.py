"""``morse import-world``: write a scene script for a world of Gazebo."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from morse.cli.messages import CommandError, check_other, existing_file, say, sentence
from morse.system.regular_files import check_default_name


def command(
    world: Annotated[str, typer.Argument(help="SDF file with a world: NAME.sdf or NAME.world.")],
    output: Annotated[str, typer.Option("-o", "--output", help="The scene script to write.")] = "scene.py",
    force: Annotated[bool, typer.Option("-f", "--force", help="Replace an existing file.")] = False,
) -> None:
    """Write a scene script with the robots and objects of a world of Gazebo."""
    # imported on demand, because it loads numpy
    from morse.assets.sdf.script import scene_script

    path, target = existing_file(world).absolute(), Path(output).absolute()
    if os.path.lexists(target) and not force:
        raise CommandError(f"{target} exists. Replace it with -f, or name another file with -o.")
    check_other(target, path)
    try:
        check_default_name(target)
        target.write_text(scene_script(path, target.parent), encoding="utf-8")
    except (ValueError, OSError) as error:
        raise CommandError(sentence(error)) from None
    say(f"Wrote {target}. Start it with: morse run {output}")
