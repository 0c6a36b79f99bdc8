"""``import bpy`` in a scene script: the scene that the script describes, under the names of Blender 2.6 and 2.7.

It has what scene scripts of MORSE 1.4 use: objects, materials, lamps, cameras, world, game settings, and the operators
that create and move objects. Everything else of Blender can be used without an error and without an effect; the log
names it with the line of the script.
"""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import Any

from morse.plugins.legacy.blender import Facade, Ignored

NAME = "bpy"
#: other modules of Blender; all their content is ignored
COMPANIONS = ("aud", "bgl", "blf", "bmesh", "bpy_extras")
_PARTS = {"context": "bpy_operators.Context", "data": "bpy_operators.Data", "ops": "bpy_operators.Operators"}


class App(Facade):
    """``bpy.app``."""

    _path = "bpy.app"
    version = (2, 79, 0)
    version_string = "2.79 (MORSE)"
    background = True
    binary_path = ""


class StandIn(ModuleType):
    """The module ``bpy``, or one of its submodules."""

    def __getattr__(self, name: str) -> Any:
        if self.__name__ == NAME and name in _PARTS:
            # loaded only for scripts that use it
            module, _, part = _PARTS[name].partition(".")
            self.__dict__[name] = getattr(importlib.import_module(f"morse.plugins.legacy.{module}"), part)()
            return self.__dict__[name]
        if name.startswith("__"):
            raise AttributeError(name)
        return Ignored(f"{self.__name__}.{name}")


def stand_in() -> StandIn:
    """The module, for one script."""
    module = StandIn(NAME, __doc__)
    module.__dict__.update(app=App(), __path__=[])
    return module
