"""The files that ``morse create`` and ``morse add`` write.

Templates are in ``data/templates/<kind>/``. Their names are those of the resulting files plus ``.tpl``. ``@env@``,
``@name@``, ``@classname@`` and ``@shortdesc@`` are replaced in paths and contents. A template that begins with a line
``#APPEND`` is appended to an existing file.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
from dataclasses import dataclass
from pathlib import Path

from morse.cli.messages import CommandError
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
