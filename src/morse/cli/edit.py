"""``morse edit``: open the model of a scene's world in Blender."""

from __future__ import annotations

import ast
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from morse.assets import search
from morse.cli import blender
from morse.cli.messages import CommandError, say
from morse.cli.run import check_geometry
from morse.cli.scenes import resolve
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from morse.cli.scenes import ResolvedScene

CONTEXT_SETTINGS = {"allow_interspersed_args": False}


def command(
    scene: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE [ARGUMENTS]",
            help="As for `morse run`.",
            show_default=False,
        ),
    ] = None,
    base: Annotated[
        str | None, typer.Option("-b", "--base", help="The .blend file to open, instead of the world of the scene.")
    ] = None,
    name: Annotated[str | None, typer.Option("--name", help="Accepted as in `morse run`.")] = None,
    geometry: Annotated[
        str | None,
        typer.Option("-g", "--geometry", metavar="WxH[+dx,dy]", help="Size and position of the window of Blender."),
    ] = None,
) -> int:
    """Open the model of a scene's world in Blender, without starting the simulation."""
    check_geometry(geometry)
    resolved = resolve(scene or [])
    search.set_project_dirs(resolved.resource_paths)
    for path in _models_of_project(resolved):
        say(f"A model of this project: {path}")
    model = _model(base) if base is not None else _world(resolved.script)
    program, why_not = blender.find()
    if program is None:
        raise CommandError(f"{model} is to be edited with Blender, but {why_not}. To install it: {blender.INSTALL}")
    if model.is_relative_to(search.MORSE_COMPONENTS):
        say(
            f"{model} belongs to MORSE. Save your version in the `data` folder of your project, "
            "and give its path to Environment(...) in the scene."
        )
    say(f"Opening {model} in Blender. Save it there, then start the scene with `morse run`.")
    return subprocess.run([program, *_window(geometry), str(model)], check=False).returncode


def _window(geometry: str | None) -> list[str]:
    """The option of Blender for ``WxH[+dx,dy]``."""
    if geometry is None:
        return []
    size, _, offset = geometry.partition("+")
    width, height = size.split("x")
    x, y = offset.split(",") if offset else ("0", "0")
    return ["--window-geometry", x, y, width, height]


def _model(name: str) -> Path:
    try:
        return search.find(name, "environments")
    except (search.AssetNotFoundError, ValueError) as error:
        raise CommandError(f"Which file to open? {error}") from None


def _world(script: Path) -> Path:
    """The model of the world of a scene."""
    if script.suffix == ".blend":
        return script
    name = _environment_name(script)
    if name is None:
        raise CommandError(
            f"{script} does not contain the name of its world as a literal, as in Environment('sandbox'): give the "
            ".blend file to open with `morse edit -b FILE`."
        )
    return _model(name)


def _environment_name(script: Path) -> str | None:
    """The name in the first ``Environment('name')`` of a script; the script is parsed, but not executed."""
    try:
        tree = ast.parse(read_regular(script), str(script))
    except (OSError, SyntaxError, ValueError) as error:
        raise CommandError(f"{script} is not valid Python: {error}.") from None
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Environment":
            values = [*node.args[:1], *(keyword.value for keyword in node.keywords if keyword.arg == "filename")]
            for value in values:
                if isinstance(value, ast.Constant) and isinstance(value.value, str):
                    return value.value
    return None


def _models_of_project(scene: ResolvedScene) -> list[Path]:
    return sorted(path for folder in scene.resource_paths for path in Path(folder).rglob("*.blend"))
