"""``morse create``, ``add``, ``import``, ``import-world`` and ``rm``: simulation environments and their files."""

from __future__ import annotations

import keyword
import os
import re
import shutil
import stat
import sys
import unicodedata
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from morse.assets.search import MORSE_COMPONENTS
from morse.cli.messages import CommandError, check_other, existing_file, nearest, say, sentence, warn
from morse.cli.sites import Sites
from morse.core.reports.printing import echo
from morse.core.validation.names import DEVICES
from morse.system.regular_files import check_default_name, home
from morse.system.source_text import inside_quotes

_PLACEHOLDER = re.compile(r"@(env|name|classname|shortdesc)@")
_APPEND = "#APPEND\n"

_TEMPLATES = {
    "basic": (
        "conftest.py",
        "default.py",
        "pyproject.toml",
        "scripts/@env@_client.py",
        "src/@env@/__init__.py",
        "src/@env@/builder/__init__.py",
        "tests/test_default.py",
    ),
    **{
        kind: (
            f"src/@env@/{kind}s/@name@.py",
            f"src/@env@/{kind}s/__init__.py",
            f"src/@env@/builder/{kind}s/@name@.py",
            f"src/@env@/builder/{kind}s/__init__.py",
        )
        for kind in ("robot", "sensor", "actuator")
    },
}
_MODELS = {"robot": ("robot.blend", "data/@env@/robots/@name@.blend")}

COMPONENT_KINDS = ("robot", "sensor", "actuator")


@dataclass(frozen=True, slots=True)
class Values:
    """The values of the placeholders.

    Attributes:
        env: name of the environment.
        name: safe name of the component.
        classname: name of its class.
        shortdesc: one line of free text.
    """

    env: str
    name: str = ""
    classname: str = ""
    shortdesc: str = ""

    def fill(self, text: str) -> str:
        """Replace the placeholders of a path or of a Python text."""
        values = {
            "env": self.env,
            "name": self.name,
            "classname": self.classname,
            "shortdesc": inside_quotes(self.shortdesc.strip()),
        }
        # in one pass, because a description may itself contain a placeholder
        return _PLACEHOLDER.sub(lambda match: values[match[1]], text)


def write_environment(directory: Path, values: Values) -> list[Path]:
    """Write the files of a new environment.

    Returns:
        The files written.
    """
    return [_write(directory, "basic", template, values) for template in _TEMPLATES["basic"]]


def behaviour_file(directory: Path, kind: str, values: Values) -> Path:
    """The file of the component class; if it exists, the component exists."""
    return directory / values.fill(_TEMPLATES[kind][0])


def write_component(directory: Path, kind: str, values: Values) -> list[Path]:
    """Write the files of a robot, sensor or actuator into an environment; existing files are overwritten.

    Args:
        directory: directory of the environment.
        kind: one of `COMPONENT_KINDS`.
        values: values of the placeholders.

    Returns:
        The files of the component, the file of the component class first.

    Raises:
        CommandError: a model of MORSE is missing.
    """
    model = _MODELS.get(kind)
    if model is not None and not (templates_directory() / model[0]).is_file():
        raise CommandError(f"The model {templates_directory() / model[0]} is missing: install MORSE again.")
    paths = [_write(directory, kind, template, values) for template in _TEMPLATES[kind]]
    if model is not None:
        target = directory / values.fill(model[1])
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(templates_directory() / model[0], target)
        paths.append(target)
    return paths


def templates_directory() -> Path:
    """The directory of the templates."""
    return Path(__file__).resolve().parents[1] / "data" / "templates"


def _write(directory: Path, kind: str, template: str, values: Values) -> Path:
    text = (templates_directory() / kind / f"{template}.tpl").read_text(encoding="utf-8")
    target = directory / values.fill(template)
    target.parent.mkdir(parents=True, exist_ok=True)
    if text.startswith(_APPEND):
        _append(target, values.fill(text.removeprefix(_APPEND)))
    elif target.name != "__init__.py" or not target.exists():
        # an existing package belongs to the user, whatever its content
        target.write_text(values.fill(text), encoding="utf-8", newline="\n")
    if text.startswith("#!"):
        os.chmod(target, target.stat().st_mode | stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH)
    return target


def _append(target: Path, addition: str) -> None:
    present = target.read_text(encoding="utf-8") if target.exists() else ""
    if addition.strip() in (line.strip() for line in present.splitlines()):
        return
    if present and not present.endswith("\n"):
        present += "\n"
    target.write_text(present + addition, encoding="utf-8", newline="\n")


# Names of environments and components: as file names and as names of Python modules and classes.

_OWN_PACKAGES = {"morse", "pymorse", "numpy", "mujoco", "msgspec", "websockets", "typer", "rich"}


def environment_name(text: str) -> str:
    """Validate the name of an environment, which is also the name of its directory and of its Python package.

    Raises:
        CommandError: the name is a path, or not a valid name of a Python module, or the environment would hide a
            module.
    """
    name = text.rstrip("/\\") if text.strip("/\\") else text
    if any(separator in name for separator in "/\\") or name in ("", ".", "..") or ":" in name:
        raise CommandError(
            f"'{text}' is a path: give the plain name of the environment, which is created in the current directory."
        )
    package = _identifier(name, keep="_", replace="_")
    if package != name:
        raise CommandError(
            f"'{text}' cannot be the name of an environment, because it is not a valid name of a Python package. "
            + (f"Use '{package}', for example." if package.strip("_") else "Use letters, digits and underscores.")
        )
    if name in sys.stdlib_module_names or name in _OWN_PACKAGES:
        raise CommandError(
            f"'{text}' would hide the Python module '{name}' from your scripts. Use, for example, '{name}_sim'."
        )
    return name


def registered_name(text: str) -> str:
    """A name for an existing directory in the configuration file.

    Raises:
        CommandError: the configuration file cannot contain the name.
    """
    name = text.strip()
    if not name or not name.isprintable() or name[0] in "#;[" or any(c in "=:/\\" for c in name):
        raise CommandError(f"'{text}' cannot be the name of an environment: use letters, digits and underscores.")
    return name


def component_name(text: str) -> str:
    """The safe form of the name of a component: only its letters and digits.

    Raises:
        CommandError: the name is a path, has no letters and digits, or is a reserved word.
    """
    if any(separator in text for separator in "/\\") or text in (".", ".."):
        raise CommandError(f"'{text}' is a path: give the plain name of the component.")
    name = _identifier(text, keep="", replace="")
    if not name:
        raise CommandError(f"'{text}' cannot be the name of a component: use letters and digits.")
    word = name.removeprefix("_")
    if _is_reserved(word):
        raise CommandError(
            f"'{text}' cannot be the name of a component: the word is reserved. Use, for example, '{word}1'."
        )
    return name


def class_name(name: str) -> str:
    """The name of the class of a component, e.g. ``Ranger`` for ``ranger`` and ``Mybot`` for ``myBot``."""
    return unicodedata.normalize("NFKC", name.capitalize())


def _is_reserved(name: str) -> bool:
    """Whether a name, or that of its class, is a keyword of Python, or the name is that of a device on Windows."""
    return keyword.iskeyword(name) or keyword.iskeyword(name.capitalize()) or name.lower() in DEVICES


def _identifier(text: str, keep: str, replace: str) -> str:
    """A form of the text that is valid as the name of a Python module, of a class and of a file."""
    # Python normalises identifiers to this form, but file systems do not
    normal = unicodedata.normalize("NFKC", text)
    name = "".join(c if c in keep or (c.isalnum() and ("a" + c).isidentifier()) else replace for c in normal)
    if not name:
        return ""
    return "_" + name if _is_reserved(name) or not name.isidentifier() else name


# ``morse create``: create a new simulation environment.


def create(
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
    # a pytest of another Python does not find MORSE
    say(f"Test it with:            python -m pytest {name}    (once before: python -m pip install pytest)")
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


# ``morse import``: register a directory as a simulation environment.


def import_environment(
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


# ``morse import-world``: write a scene script for a world of Gazebo.


def import_world(
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


# ``morse rm``: delete a simulation environment.


def remove(
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


# ``morse add``: create a robot, a sensor or an actuator from a template.

# sensors and actuators in the template of a robot; a robot class of the same name would hide them
_EQUIPMENT_OF_ROBOTS = ("Keyboard", "Pose")


def add(
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
