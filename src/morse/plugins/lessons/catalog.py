"""Finds lessons, and writes the files with which a student starts."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import textwrap
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from morse.core.classes.plugins import PluginError, attempt, entry_points, load, use_project_here
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest

if TYPE_CHECKING:
    from pathlib import Path
    from types import ModuleType

_GROUP = "morse.lessons"
#: the file of a student
PROGRAM = "controller.py"


class LessonError(MorseError):
    """A lesson does not exist, cannot be loaded, or cannot be written."""


@dataclass(frozen=True, slots=True)
class Lesson:
    """A lesson.

    Attributes:
        name: the name of its module, and of the folder of a student.
        module: the module with ``scene``, ``START`` and ``check``.
    """

    name: str
    module: ModuleType

    @property
    def title(self) -> str:
        """What it is about, in a few words."""
        return (inspect.getdoc(self.module) or self.name).partition("\n")[0].rstrip(".")

    @property
    def task(self) -> str:
        """What the student does, in Markdown."""
        return (inspect.getdoc(self.module) or "").partition("\n")[2].strip()

    def scene_script(self) -> str:
        """The scene as a script for ``morse run``."""
        lines = inspect.getsource(self.module.scene).splitlines()[1:]
        return f'"""{self.title}."""\n\n{textwrap.dedent(chr(10).join(lines)).strip()}\n'

    def write(self, folder: Path) -> None:
        """Write the files of a student.

        Raises:
            LessonError: the folder has a program already, or another file of these names.
        """
        if (folder / PROGRAM).exists():
            raise LessonError(f"{folder / PROGRAM} exists already: `morse lesson check {self.name}` checks it")
        folder.mkdir(parents=True, exist_ok=True)
        show, check = (f"`morse lesson {action} {self.name}`" for action in ("show", "check"))
        texts = {
            "README.md": f"# {self.title}\n\n{self.task}\n\n{show} shows your robot, {check} checks it.\n",
            "scene.py": self.scene_script(),
            PROGRAM: self.module.START.lstrip(),
        }
        taken = [name for name in texts if (folder / name).exists()]
        if taken:
            raise LessonError(f"{folder / taken[0]} exists already: start the lesson in another folder (--folder)")
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")


def lessons() -> tuple[dict[str, Lesson], list[str]]:
    """All lessons by name in the order of the course, and what is wrong with others."""
    use_project_here()
    found: dict[str, Lesson] = {}
    wrong: list[str] = []
    # ours come first
    for point in sorted(entry_points(_GROUP), key=lambda point: not point.value.startswith("morse.")):
        try:
            modules = load(point, _modules_of)
        except PluginError as error:
            wrong.append(f"the lessons of {point.value} are left out: {error}")
            continue
        for name in modules:
            try:
                each = attempt(partial(_load, name))
            except PluginError as error:
                wrong.append(f"the lesson {name} is left out: {error}")
            else:
                found.setdefault(each.name, each)
    return found, wrong


def lesson(name: str) -> Lesson:
    """The lesson of that name.

    Raises:
        LessonError: there is no such lesson.
    """
    found, wrong = lessons()
    if name not in found:
        reasons = "".join(f"; {reason}" for reason in wrong)
        raise LessonError(f"there is no lesson '{name}'{nearest(name, found)}: `morse lesson` lists them all{reasons}")
    return found[name]


def _modules_of(module: object) -> list[str]:
    """The names of the modules of lessons of an entry point."""
    if not inspect.ismodule(module):
        raise LessonError(f"it is {module!r:.80}, expected a module or a package")
    if hasattr(module, "check"):
        return [module.__name__]
    names = sorted(info.name for info in pkgutil.iter_modules(getattr(module, "__path__", ())))
    return [f"{module.__name__}.{name}" for name in getattr(module, "ORDER", names)]


def _load(name: str) -> Lesson:
    return _lesson_of(importlib.import_module(name))


def _lesson_of(module: ModuleType) -> Lesson:
    missing = [name for name in ("scene", "check") if not inspect.isfunction(getattr(module, name, None))]
    missing += [name for name in ("START",) if not isinstance(getattr(module, name, None), str)]
    if missing:
        raise LessonError(f"{module.__name__} is no lesson: it lacks {', '.join(missing)}")
    return Lesson(module.__name__.rpartition(".")[2], module)
