"""Scene scripts of earlier versions, or for other programs, as plug-ins understand them.

A plug-in is a subclass of `Compatibility`, of which an entry point names an object::

    [project.entry-points."morse.compatibility"]
    my_lab = "my_lab.old_scripts:COMPATIBILITY"

What scripts write today does not ask for it: it is asked for names, forms and mistakes that the builder does not know.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from morse.core.classes.plugins import entry_points
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from importlib.metadata import EntryPoint
    from pathlib import Path
    from types import ModuleType

logger = logging.getLogger(__name__)


def _unchanged(module: ModuleType) -> ModuleType:
    return module


def _nothing() -> None:
    pass


@dataclass
class ScriptModules:
    """What the code of one scene script, and of its project, can import or use besides the modules that there are.

    Attributes:
        finders: finders of modules (`importlib.abc.MetaPathFinder`).
        offered: modules by name.
        names: objects that the code uses without importing them.
        as_imported: returns a module as this code sees it.
        close: is called when the script has run.
    """

    finders: Sequence[Any] = ()
    offered: Mapping[str, ModuleType] = field(default_factory=dict)
    names: Mapping[str, object] = field(default_factory=dict)
    as_imported: Callable[[ModuleType], ModuleType] = _unchanged
    close: Callable[[], None] = _nothing


class Compatibility:
    """What old scripts need; each method here leaves everything as it is.

    Attributes:
        purpose: which scripts it understands, in a few words, for lists of what is installed.
    """

    purpose = ""

    def arguments(self, script: Path, words: Sequence[str], directories: Iterable[str]) -> list[str] | None:
        """``sys.argv`` of a script; None for its path and the words after it.

        Args:
            script: the file of the scene.
            words: the words after the scene on the command line.
            directories: directories of the packages of its project.
        """

    def modules(self) -> ScriptModules:
        """What the code of one script can import."""
        return ScriptModules()

    def attributes(self, owner: object) -> Iterable[str]:
        """Names of attributes that an object of the builder, or a module, has for old scripts, for ``import *``."""
        return ()

    def attribute(self, owner: object, name: str) -> Callable[[], object] | None:
        """A function that returns an attribute which an object of the builder, or a module, lacks; None if unknown."""

    def set_attribute(self, owner: object, name: str, value: object) -> bool:
        """Set an attribute that an object of the builder lacks; False if it is unknown."""
        return False

    def call(self, owner: object, method: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments of a call, by name, in the form of today; arguments of earlier versions may be among them."""
        return arguments

    def value(self, kind: str, value: object, what: str) -> object:
        """A value in the form of today.

        Args:
            kind: what is expected: ``number``, ``boolean`` or ``names``, a list of texts.
            value: the argument of the script.
            what: name of the argument in messages.
        """
        return value

    def mend_of_syntax(self, error: SyntaxError) -> str:
        """How to correct a line that is not valid; empty if unknown."""
        return ""

    def mended_line(self, line: str) -> str:
        """A line that is not valid, as it is written today; unchanged if that is unknown."""
        return line

    def mend_of_name(self, name: str) -> str:
        """How a name that does not exist is written today; empty if unknown."""
        return ""

    def name_of_today(self, name: str) -> str:
        """The name, or the expression, that replaces one of an earlier language or version; empty if there is none."""
        return ""

    def mended_text(self, text: str) -> str:
        """A script with other old forms replaced that need no person, for ``morse check --fix``."""
        return text


def installed() -> tuple[Compatibility, ...]:
    """Those of this installation; the log names those that cannot be loaded."""
    return _loaded(entry_points("morse.compatibility"))


@lru_cache(maxsize=8)
def _loaded(points: tuple[EntryPoint, ...]) -> tuple[Compatibility, ...]:
    found: list[Compatibility] = []
    for point in points:
        try:
            entry = point.load()
            if not isinstance(entry, Compatibility):
                raise TypeError(f"it is no morse.builder.compatibility.Compatibility, but {entry!r:.80}")
            found.append(entry)
        except Exception as error:  # the package is third-party code
            logger.warning(
                "the old scripts of an installed package (%s) are left out: %s: %s",
                *(point.value, type(error).__name__, error),
                extra=OF_MACHINE,
            )
    return tuple(found)


def value_of_today(kind: str, value: object, what: str) -> Any:
    """See `Compatibility.value`."""
    for entry in installed():
        value = entry.value(kind, value, what)
    return value


def call_of_today(owner: object, method: str, known: Mapping[str, Any], earlier: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a call in the form of today; see `Compatibility.call`.

    Args:
        known: the arguments that the method has, by name.
        earlier: others that a script has given.

    Raises:
        TypeError: no version had such an argument.
    """
    arguments = {**known, **earlier}
    for entry in installed():
        arguments = entry.call(owner, method, arguments)
    unknown = next((name for name in arguments if name not in known), None)
    if unknown is not None:
        raise TypeError(f"{type(owner).__name__}.{method}() got an unexpected keyword argument '{unknown}'")
    return arguments


def first(method: str, *arguments: Any) -> Any:
    """What the first plug-in says that knows something by a method whose result is else None or empty."""
    results = (getattr(entry, method)(*arguments) for entry in installed())
    return next((result for result in results if result), "")
