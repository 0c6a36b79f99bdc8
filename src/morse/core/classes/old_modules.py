"""Modules of MORSE under the paths by which scripts of earlier versions import them.

A plug-in names such paths by entry points, whose values are the present paths. Both paths are one module, also of what
is below it::

    [project.entry-points."morse.old_modules"]
    "morse.middleware.zenoh" = "my_lab.zenoh"
"""

from __future__ import annotations

import logging
import sys
import threading
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from typing import TYPE_CHECKING

from morse.core.classes.plugins import PluginError, attempt, entry_points
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import ModuleType

#: packages whose modules may be elsewhere today
_PACKAGES = ("morse.builder", "morse.builder.robots", "morse.core", "morse.helpers", "morse.middleware")


logger = logging.getLogger(__name__)


class _Search(threading.local):
    """The modules that this thread looks for at the moment."""

    def __init__(self) -> None:
        self.names: list[str] = []


_search = _Search()

#: are called with the old and the present path of each such module that is imported for the first time
observers: list[Callable[[str, str], None]] = []


def present_module(old: str) -> str | None:
    """The present path of a module; None if there is none."""
    paths = {point.name: point.value for point in entry_points("morse.old_modules")}
    found = max((path for path in paths if f"{old}.".startswith(f"{path}.")), key=len, default=None)
    return None if found is None else paths[found] + old.removeprefix(found)


def _found(old: str, present: str) -> ModuleSpec | None:
    """The specification of the present module; None, with a warning, if an entry point names what is not there."""
    reason = "the present path leads back to it"
    if old not in _search.names:
        _search.names.append(old)
        try:
            if (spec := attempt(lambda: find_spec(present))) is not None:
                return spec
            reason = "there is no such module"
        except PluginError as error:
            reason = str(error)
        finally:
            _search.names.pop()
    logger.warning("the old module '%s' is left out, which is '%s' today: %s", old, present, reason, extra=OF_MACHINE)
    return None


class OldModules:
    """Finds and loads these modules (`importlib.abc.MetaPathFinder`, whose import costs time)."""

    def install(self) -> None:
        """Install this finder before those of Python, which would load what is below such a package once more."""
        if not any(isinstance(finder, OldModules) for finder in sys.meta_path):
            sys.meta_path.insert(0, self)

    def find_spec(self, name: str, path: Sequence[str] | None, _target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        parent = name.rpartition(".")[0]
        if parent in _PACKAGES:
            there = PathFinder.find_spec(name, path)
            # a folder without a module is what an older checkout has left there
            if there is not None and there.origin is not None:
                return None
        # below a package of today, all modules are where they seem to be
        elif not parent.startswith("morse.") or parent not in sys.modules or sys.modules[parent].__name__ == parent:
            return None
        present = present_module(name)
        if present is None or (found := _found(name, present)) is None:
            return None
        for observer in observers:
            observer(name, present)
        is_package = found.submodule_search_locations is not None
        return ModuleSpec(name, self, origin=present, is_package=is_package)  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """See `importlib.abc.Loader`."""
        module = import_module(str(spec.origin))
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """See `importlib.abc.Loader`."""
        # it has been executed under its present path; Python has given it the specification of the old one
        if module.__spec__ is not None:
            module.__spec__ = module.__spec__.loader_state
