"""Modules that scripts of MORSE 1.4 import, and that are elsewhere today or not there."""

from __future__ import annotations

import importlib
import sys
from importlib.machinery import ModuleSpec, PathFinder
from typing import TYPE_CHECKING

from morse.builder.legacy import bpy
from morse.builder.legacy.notices import notice
from morse.builder.legacy.removed import MODULES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

#: a module of 1.4, and the one that has its names today
OLD_MODULES = {
    "morse.builder.robots.human": "morse.builder.robots",
    "morse.builder.robots.morserobots": "morse.builder.robots",
    "morse.builder.robots.pr2": "morse.builder.robots",
    "morse.builder.robots.segway": "morse.builder.robots",
    "morse.builder.robots.segwayrmp400": "morse.builder.robots",
    "morse.builder.robots.victim": "morse.builder.robots",
    "morse.core.morse_time": "morse.scene",
    **{old: there for old, (there, _) in MODULES.items()},
}


class OldModules:
    """Finds these modules, and those of the stand-in for ``bpy``, for the code of a scene script and its project."""

    def __init__(self) -> None:
        self._names: list[str] = []

    def forget(self) -> None:
        """Leave none of these modules to other programs and scripts of the process."""
        for name in self._names:
            sys.modules.pop(name, None)
            parent, _, last = name.rpartition(".")
            if parent in sys.modules:
                vars(sys.modules[parent]).pop(last, None)
        self._names.clear()

    def find_spec(self, name: str, path: Sequence[str] | None, _target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        if name not in OLD_MODULES and not _is_of_blender(name, path):
            return None
        self._names.append(name)
        return ModuleSpec(name, _Loader(), is_package=True)  # type: ignore[arg-type] # importlib.abc costs time


def _is_of_blender(name: str, path: Sequence[str] | None) -> bool:
    """Whether a module of Blender is imported that is not installed."""
    if name in bpy.COMPANIONS:
        return PathFinder.find_spec(name) is None
    # a stand-in has no folders; the folders of an installed bpy have other submodules
    return not path and name.partition(".")[0] in (bpy.NAME, *bpy.COMPANIONS) and "." in name


class _Loader:
    """Creates the modules that `OldModules` finds."""

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """See `importlib.abc.Loader`."""
        return bpy.StandIn(spec.name) if spec.name not in OLD_MODULES else None

    def exec_module(self, module: ModuleType) -> None:
        """See `importlib.abc.Loader`."""
        name = module.__name__
        if name not in OLD_MODULES:
            return
        if name in MODULES:
            notice(f"Python has removed the module {name}; write {MODULES[name][1]}")
        elif name.startswith("morse."):
            new = "morse.builder" if name.startswith("morse.core.") else OLD_MODULES[name]
            notice(f"{name} is an old name, write {new}", name, new)
        there = importlib.import_module(OLD_MODULES[name])
        public = getattr(there, "__all__", None) or [word for word in vars(there) if not word.startswith("_")]
        module.__dict__.update({word: getattr(there, word) for word in public}, __all__=list(public))
