"""``morse check``: report installed and missing requirements."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich import box
from rich.table import Table
from rich.text import Text

from morse.assets import search
from morse.assets.formats import suffixes
from morse.cli.check_component import check_components
from morse.cli.check_model import check_model
from morse.cli.check_scene import check_scene
from morse.cli.findings import Finding, findings
from morse.cli.messages import CommandError, existing_file, nearest, say
from morse.cli.sites import Sites
from morse.core.reports import printing
from morse.core.reports.printing import echo
from morse.middleware import registry
from morse.version import __version__

#: characters of a line that has room for the columns of the table
_WIDTH_OF_TABLE = 72


def command(
    what: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE | MODEL | component FILE_OR_NAME",
            help="A scene script or environment: list what needs a change, and whether it runs. A model file: what is "
            "read, what is left out, and a picture. Or components: classes of scene scripts, or files with classes of "
            "your own.",
            show_default=False,
        ),
    ] = None,
    robot: Annotated[
        str | None,
        typer.Option(
            "--robot",
            metavar="CLASS",
            help="Robot for the components: a robot of MORSE, or package.module.Class of the project.",
        ),
    ] = None,
    fix: Annotated[
        bool, typer.Option("--fix", help="Write a mended copy beside the scene script, which is not changed.")
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            "--picture",
            metavar="FILE.png",
            help="The picture of a model file (default: MODEL_check.png in the present folder).",
            show_default=False,
        ),
    ] = None,
) -> int:
    """Check the requirements of MORSE and optional programs; or a scene script; or components.

    `morse check SCENE` executes a scene script, lists all lines that need a change, e.g. since MORSE 1.4, and ends with
    "runs" or "does not run". `morse check MODEL` lists the content of a model file, and draws it. `morse check
    component NAME` runs a component in small simulations and reports violated rules of the contract.
    """
    if what and what[0] == "component":
        return check_components(what[1:], robot)
    if what:
        return _check_scene(what, fix=fix, picture=picture)
    if fix:
        raise CommandError("--fix belongs to `morse check SCENE`.", status=2)
    if robot is not None:
        raise CommandError("--robot belongs to `morse check component FILE_OR_NAME...`.", status=2)
    echo(f"MORSE {__version__}")
    results = list(findings())
    console = printing.console()
    if console.width < _WIDTH_OF_TABLE:
        for result in results:  # columns would cut words
            console.print(_mark(result), f"{result.name}: {result.detail}", highlight=False, markup=False)
    else:
        console.print(_table(results))
    say(f"Available middlewares: {', '.join(registry.installed())}.")
    _say_places()
    problems = [result for result in results if result.required and not result.found]
    for result in problems:
        say(f"Missing: {result.name} ({result.detail}). To install it: {result.install}")
    for result in results:
        if not result.found and not result.required and result.install:
            say(f"Optional: {result.name} ({result.gives}): {result.install}")
    if problems:
        raise typer.Exit(1)
    say("All requirements of MORSE are met.")
    return 0


def _check_scene(words: list[str], *, fix: bool, picture: Path | None) -> int:
    model = _model(words[0])
    if model is not None:
        return check_model(model, picture)
    if picture is not None:
        raise CommandError("--picture belongs to `morse check MODEL`; `morse render` draws scenes.", status=2)
    try:
        return check_scene(words, fix=fix)
    except CommandError as error:
        hint = nearest(words[0], ["component"])
        raise CommandError(f"{error}{hint}") if hint else error from None


def _model(name: str) -> Path | None:
    """The model file of that name, or in a folder of that name; None for a script or an environment."""
    path = Path(name).expanduser()
    if path.is_dir():
        from morse.assets.model_folders import CONFIG, model_file

        return model_file(path) if (path / CONFIG).is_file() else None
    if path.suffix.lower() not in suffixes():
        return None
    return existing_file(path)


def _table(results: list[Finding]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("", "What", "Found", "Gives"):
        table.add_column(heading)
    for result in results:
        table.add_row(_mark(result), result.name, Text(result.detail, overflow="fold"), Text(result.gives))
    return table


def _mark(result: Finding) -> Text:
    if result.found:
        return Text("yes", style="green")
    return Text("NO", style="bold red") if result.required else Text("no", style="yellow")


def _say_places() -> None:
    """Print the directories of data, each on a separate line, for copying."""
    own, *others = search.component_dirs()
    say(f"MORSE data directory: {own}")
    for name, directories in (("MORSE_ROOT", others), ("MORSE_RESOURCE_PATH", search.resource_dirs())):
        for path in directories:
            say(f"Searched as well ({name}): {path}" + ("" if path.is_dir() else ", which does not exist"))
    sites = Sites()
    say(f"Configuration: {sites.path}. {sites.known()}")
