"""``morse add``: create a robot, a sensor or an actuator from a template."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from morse.assets.search import MORSE_COMPONENTS
from morse.cli.messages import CommandError, nearest, say, warn
from morse.cli.names import class_name, component_name, environment_name
from morse.cli.sites import Sites
from morse.cli.templates import COMPONENT_KINDS, Values, behaviour_file, write_component
from morse.core.reports.printing import echo

# sensors and actuators in the template of a robot; a robot class of the same name would hide them
_EQUIPMENT_OF_ROBOTS = ("Keyboard", "Pose")


def command(
    kind: Annotated[str, typer.Argument(metavar="robot|sensor|actuator", help="Kind of component.")],
    name: Annotated[str, typer.Argument(help="Name of the component: letters and digits.")],
    env: Annotated[str, typer.Argument(help="A registered environment.")],
    force: Annotated[bool, typer.Option("-f", "--force", help="Replace a component of that name.")] = False,
) -> None:
    """Add a new robot, sensor or actuator to an environment, from a template."""
    if kind not in COMPONENT_KINDS:
        raise CommandError(
            f"'{kind}' is not a kind of component that can be added; expected one of "
            f"{', '.join(COMPONENT_KINDS)}.{nearest(kind, COMPONENT_KINDS)}",
            status=2,
        )
    directory = Sites().directory(env.rstrip("/"))
    package = _package(directory, environment_name(env))
    safe_name = component_name(name)
    if safe_name != name:
        warn(f"'{name}' is called '{safe_name}' in Python: names of components consist of letters and digits.")
    class_ = class_name(safe_name)
    if kind == "robot" and class_ in _EQUIPMENT_OF_ROBOTS:
        raise CommandError(f"A robot cannot be called '{name}': its class would hide the {class_} on it.")
    values = Values(package, safe_name, class_)
    if not force and (behaviour := behaviour_file(directory, kind, values)).exists():
        raise CommandError(
            f"There is already a {kind} '{safe_name}' in '{env}' ({behaviour}). Choose another name, or replace it "
            "with -f."
        )
    if kind != "robot":
        values = replace(values, shortdesc=_ask_for_description(kind, safe_name))
    paths = write_component(directory, kind, values)
    say(f"Added the {kind} '{safe_name}' to '{package}':")
    for path in paths:
        echo(f"    {path}")
    _explain(kind, package, safe_name, class_, directory)


def _package(directory: Path, name: str) -> str:
    """The package of an environment: its name, capitalised as the folder if the folder has capitals."""
    source = directory / "src"
    folders = [path.name for path in source.iterdir() if path.is_dir()] if source.is_dir() else []
    return name if name in folders else next((f for f in folders if f.lower() == name.lower()), name)


def _ask_for_description(kind: str, name: str) -> str:
    echo(f"* A short description of the {kind} '{name}', in one line: ", end="")
    if sys.stdin is None:
        return ""
    # bytes, because a description in an unknown encoding is not a reason to fail
    line = sys.stdin.buffer.readline()
    if not (sys.stdin.isatty() and line.endswith(b"\n")):
        echo()
    return line.decode("utf-8", errors="replace").strip()


def _explain(kind: str, package: str, name: str, class_: str, directory: Path) -> None:
    source = directory / "src" / package
    lines = [
        "",
        f"To use it, import it at the beginning of {directory / 'default.py'}"
        + ("" if kind == "robot" else f",\nor of a robot in {source / 'builder' / 'robots'}"),
        "",
        f"    from {package}.builder.{kind}s import {class_}",
        "",
    ]
    if kind == "robot":
        lines += [
            "and add one to the scene:",
            "",
            f"    robot = {class_}()",
            "    robot.translate(1.0, 0.0, 0.0)",
            "",
            f"Its behaviour:  {source / 'robots' / f'{name}.py'}",
            f"Its equipment:  {source / 'builder' / 'robots' / f'{name}.py'}",
            f"Its body:       {directory / 'data' / package / 'robots' / f'{name}.blend'} (edit it with Blender)",
            f"Models to start from are in {Path(MORSE_COMPONENTS) / 'props'}",
        ]
    else:
        lines += [
            f"and append it to a robot (`self.{name}` and `self.append` in the class of a robot):",
            "",
            f"    {name} = {class_}()",
            f"    robot.append({name})",
            "",
            f"What it does:          {source / f'{kind}s' / f'{name}.py'}",
            f"How scripts see it:    {source / 'builder' / f'{kind}s' / f'{name}.py'} (seldom has to be changed)",
            f"Does it follow the rules? morse check component {source / f'{kind}s' / f'{name}.py'}",
        ]
    echo("\n".join(lines))
