"""Finds classes by the dotted names that scenes and configurations use."""

from __future__ import annotations

import importlib
import inspect
import sys

from morse.core.exceptions import MorseError
from morse.core.reports.quoting import closest
from morse.system.source_text import source_line

#: modules that users do not write
_OURS = ("morse.", "builtins", "abc", "typing")


class ClassPathError(MorseError):
    """A class path does not refer to a class that can be imported."""


def _read_sources(cls: type) -> None:
    """Read the source of a class of the user, which messages about its errors quote.

    Within a tick, there may be no file descriptor left to read it.
    """
    for base in cls.__mro__:
        file = getattr(sys.modules.get(base.__module__), "__file__", None)
        if file and not base.__module__.startswith(_OURS):
            source_line(file, 1)


def load_class(classpath: str) -> type:
    """Return the class that ``package.module.Class`` refers to.

    Raises:
        ClassPathError: the module or class does not exist, or the module cannot be imported.
    """
    module_name, _, class_name = classpath.rpartition(".")
    if not module_name:
        raise ClassPathError(f"'{classpath}' is not a class path: expected package.module.Class")
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        if error.name and (module_name == error.name or module_name.startswith(error.name + ".")):
            raise ClassPathError(
                f"the module '{module_name}' of '{classpath}' does not exist ('{error.name}' was not found); "
                "is its directory in src/ of the simulation or on PYTHONPATH?"
            ) from None
        raise
    cls = getattr(module, class_name, None)
    if inspect.isclass(cls):
        _read_sources(cls)
        return cls
    if module_name == "__main__":
        file = class_name.lower()
        raise ClassPathError(
            f"the class {class_name} of a component is in the script itself and needs a file of its own: move it to "
            f"{file}.py beside the script, and write `from {file} import {class_name}`"
        )
    classes = [name for name, member in vars(module).items() if inspect.isclass(member)]
    close = closest(class_name, classes)
    hint = f"did you mean '{close}'?" if close else f"it has: {', '.join(classes) or 'no class at all'}"
    raise ClassPathError(f"the module '{module_name}' has no class '{class_name}'; {hint}")
