"""``morse check``: what is there, what is missing and what it would give."""

from __future__ import annotations

import typer
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from morse.assets import search
from morse.cli.findings import Finding, findings
from morse.cli.messages import say
from morse.cli.sites import Sites
from morse.middleware import registry
from morse.version import __version__


def command() -> None:
    """Check that MORSE has all it needs, and say what else it could use."""
    typer.echo(f"MORSE {__version__}")
    results = list(findings())
    Console().print(_table(results))
    say(f"Middlewares that MORSE speaks: {', '.join(registry.installed())}.")
    _say_places()
    missing = [result for result in results if result.required and not result.found]
    for result in missing:
        say(f"Missing: {result.name} ({result.detail}). To install it: {result.install}")
    for result in results:
        if not result.found and not result.required and result.install:
            say(f"Not needed, but {result.name} would give: {result.gives}. To get it: {result.install}")
    if missing:
        raise typer.Exit(1)
    say("All that MORSE requires is there.")


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
    """Print the folders that users look for, each in a line of its own, to be copied."""
    own, *others = search.component_dirs()
    say(f"MORSE data directory: {own}")
    for name, directories in (("MORSE_ROOT", others), ("MORSE_RESOURCE_PATH", search.resource_dirs())):
        for path in directories:
            say(f"Searched as well ({name}): {path}" + ("" if path.is_dir() else ", which does not exist"))
    sites = Sites()
    say(f"Configuration: {sites.path}. {sites.known()}")
