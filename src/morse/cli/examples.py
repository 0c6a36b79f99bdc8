"""The examples of MORSE: scenes with their clients, in ``morse/data/examples``."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path

from morse.cli.messages import CommandError, nearest

FOLDER = Path(__file__).resolve().parents[1] / "data" / "examples"


@dataclass(frozen=True, slots=True)
class Example:
    """A scene script and a client program for it.

    Attributes:
        name: name of its folder.
        what: a description in one line.
    """

    name: str
    what: str

    @property
    def scene(self) -> Path:
        """The scene script."""
        return FOLDER / self.name / "scene.py"

    @property
    def client(self) -> Path:
        """The program; it ends by itself."""
        return FOLDER / self.name / "client.py"


def examples() -> dict[str, Example]:
    """All examples by name, sorted."""
    return {path.parent.name: _read(path) for path in sorted(FOLDER.glob("*/scene.py"))}


def example(name: str) -> Example:
    """The example of that name.

    Raises:
        CommandError: there is no such example.
    """
    by_name = examples()
    if name not in by_name:
        raise CommandError(f"There is no example '{name}'.{nearest(name, by_name)} `morse demo` lists all examples.")
    return by_name[name]


def _read(scene: Path) -> Example:
    text = ast.get_docstring(ast.parse(scene.read_text(encoding="utf-8"))) or ""
    return Example(scene.parent.name, text.partition("\n")[0])
