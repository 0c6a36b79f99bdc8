"""Scene scripts of earlier versions, or for other programs, as plug-ins understand them.

A plug-in is a subclass of `Compatibility`, of which an entry point names an object::

    [project.entry-points."morse.compatibility"]
    my_lab = "my_lab.old_scripts:COMPATIBILITY"

What scripts write today does not ask for it: it is asked for names, forms and mistakes that the builder does not know.
A plug-in that fails is named in the log, and not asked again.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from morse.core.classes.plugins import PluginError, attempt, entry_points, load
from morse.core.exceptions import MorseError
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from importlib.metadata import EntryPoint
    from pathlib import Path

_T = TypeVar("_T")

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
        """Set an attribute that an object of the builder lacks; False if it is unknown.

        Raises:
            MorseError, TypeError, ValueError: the script gives a wrong value.
        """
        return False

    def call(self, owner: object, method: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments of a call, by name, in the form of today; arguments of earlier versions may be among them.

        Raises:
            MorseError, TypeError, ValueError: the script gives a wrong argument.
        """
        return arguments

    def value(self, kind: str, value: object, what: str) -> object:
        """A value in the form of today.

        Args:
            kind: what is expected: ``number``, ``boolean`` or ``names``, a list of texts.
            value: the argument of the script.
            what: name of the argument in messages.

        Raises:
            MorseError, TypeError, ValueError: the script gives a wrong value.
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


#: what a plug-in may raise for a mistake of a script
_OF_SCRIPTS = (MorseError, TypeError, ValueError)


class _Contained(Compatibility):
    """A plug-in of which nothing is asked any more after it has failed: the builder goes on without it.

    Args:
        entry: the plug-in.
        place: what its entry point names.
    """

    def __init__(self, entry: Compatibility, place: str) -> None:
        self._entry, self._place = entry, place
        self._is_on = True

    def _ask(self, answer: Callable[[], _T], otherwise: _T, kinds: type | tuple[type, ...] = object) -> _T:
        """Return an answer of the plug-in of one of these classes, else another one."""
        if not self._is_on:
            return otherwise
        try:
            found = attempt(answer)
            if isinstance(found, kinds):
                return found
            reason = f"it returns {found!r:.80}, expected {otherwise!r:.80}"
        except PluginError as error:
            reason = str(error)
        self._is_on = False
        _warn(self._place, reason)
        return otherwise

    def _ask_of_script(self, answer: Callable[[], _T], otherwise: _T, kinds: type = object) -> _T:
        """`_ask`, for what raises errors for mistakes of a script."""
        mistakes: list[Exception] = []

        def answered() -> _T:
            try:
                return answer()
            except _OF_SCRIPTS as mistake:
                mistakes.append(mistake)
                return otherwise

        found = self._ask(answered, otherwise, kinds)
        for mistake in mistakes:
            raise mistake
        return found

    def arguments(self, script: Path, words: Sequence[str], directories: Iterable[str]) -> list[str] | None:
        return self._ask(lambda: self._entry.arguments(script, words, directories), None, (list, type(None)))

    def modules(self) -> ScriptModules:
        def copied() -> ScriptModules:
            given = self._entry.modules()
            return replace(given, finders=tuple(given.finders), offered=dict(given.offered), names=dict(given.names))

        modules = self._ask(copied, ScriptModules())
        return replace(
            modules,
            as_imported=lambda module: self._ask(lambda: modules.as_imported(module), module, ModuleType),
            close=lambda: self._ask(modules.close, None),
        )

    def attributes(self, owner: object) -> Iterable[str]:
        return self._ask(lambda: tuple(map(str, self._entry.attributes(owner))), ())

    def attribute(self, owner: object, name: str) -> Callable[[], object] | None:
        get = self._ask(lambda: self._entry.attribute(owner, name), None)
        return get if callable(get) else None

    def set_attribute(self, owner: object, name: str, value: object) -> bool:
        return self._ask_of_script(lambda: bool(self._entry.set_attribute(owner, name, value)), False)

    def call(self, owner: object, method: str, arguments: dict[str, Any]) -> dict[str, Any]:
        return self._ask_of_script(lambda: self._entry.call(owner, method, dict(arguments)), arguments, dict)

    def value(self, kind: str, value: object, what: str) -> object:
        return self._ask_of_script(lambda: self._entry.value(kind, value, what), value)

    def mend_of_syntax(self, error: SyntaxError) -> str:
        return self._ask(lambda: self._entry.mend_of_syntax(error), "", str)

    def mended_line(self, line: str) -> str:
        return self._ask(lambda: self._entry.mended_line(line), line, str)

    def mend_of_name(self, name: str) -> str:
        return self._ask(lambda: self._entry.mend_of_name(name), "", str)

    def name_of_today(self, name: str) -> str:
        return self._ask(lambda: self._entry.name_of_today(name), "", str)

    def mended_text(self, text: str) -> str:
        return self._ask(lambda: self._entry.mended_text(text), text, str)


def _warn(place: str, reason: str) -> None:
    logger.warning("the old scripts of an installed package (%s) are left out: %s", place, reason, extra=OF_MACHINE)


def installed() -> tuple[Compatibility, ...]:
    """Those of this installation; the log names those that fail."""
    return _loaded(entry_points("morse.compatibility"))


@lru_cache(maxsize=8)
def _loaded(points: tuple[EntryPoint, ...]) -> tuple[Compatibility, ...]:
    found: list[Compatibility] = []
    for point in points:
        try:
            found.append(_Contained(load(point, _checked), point.value))
        except PluginError as error:
            _warn(point.value, str(error))
    return tuple(found)


def _checked(entry: object) -> Compatibility:
    if not isinstance(entry, Compatibility):
        raise TypeError(f"it is not a morse.builder.compatibility.Compatibility, but {entry!r:.80}")
    return entry


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
