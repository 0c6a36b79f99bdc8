"""Maps the parts of a simulation, and the variables of its project, to names in states and back."""

from __future__ import annotations

import inspect
import sys
from enum import Enum
from pathlib import Path
from types import FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

from morse.core.object import Object
from morse.core.state import StateError
from morse.physics import GameObject

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.values import StateData
    from morse.simulation.running import Running

_PLAIN = (type(None), bool, int, float, complex, str, bytes, tuple, frozenset, ModuleType, Enum)


class StateParts:
    """See `morse.core.state.References`."""

    def __init__(self, simulation: Running) -> None:
        self._simulation = simulation
        self._classes: dict[str, type] = {}
        self._globals: dict[int, str] = {}
        self._by_name: StateData = {}

    def look_up(self) -> None:
        """Look up the present values of the variables of the project."""
        self._by_name = dict(self._variables())
        self._globals = {id(value): name for name, value in reversed(self._by_name.items())}

    # -- the simulation --------------------------------------------------------------------

    def _fixed(self) -> StateData:
        context = self._simulation.context
        return {
            "context": context,
            "clock": context.clock,
            "world": context.world,
            "scene": context.scene,
            "services": context.services,
        }

    def name_of(self, value: object) -> str | None:
        """Return the name of a part, or None."""
        if isinstance(value, GameObject):
            return f"object {value.name}"
        if isinstance(value, Object):
            return f"component {value.name()}"
        return next((name for name, part in self._fixed().items() if part is value), None)

    def find(self, name: str) -> object:
        """The part of that name."""
        kind, _, rest = name.partition(" ")
        context = self._simulation.context
        part: Any = None
        if kind == "object":
            part = context.world.objects_by_name.get(rest)
        elif kind == "component":
            part = context.component(rest)
        else:
            part = self._fixed().get(name)
        if part is None:
            raise StateError(f"there is no {name!r:.80}")
        return part

    # -- the project -----------------------------------------------------------------------

    def met_class(self, cls: type) -> None:
        """Record a class whose objects are in the simulation."""
        self._classes[f"{cls.__module__}:{cls.__qualname__}"] = cls

    def global_name(self, value: object) -> str | None:
        """Return ``module:NAME``, or ``module:Class.NAME``, if the object is the value of a variable of the project."""
        return self._globals.get(id(value))

    def find_global(self, name: str) -> object:
        """Return the value of a variable of the project."""
        if name not in self._by_name:
            raise StateError(f"the project has no variable {name!r:.80}")
        return self._by_name[name]

    def find_class(self, path: str) -> type | None:
        """Return a class of MORSE, of the project, or of a module in the same directory as a component of the scene."""
        module_name, _, name = path.partition(":")
        cls: Any = self._module(module_name)
        for word in name.split("."):
            cls = vars(cls).get(word) if isinstance(cls, (type, ModuleType)) else None
        # names that a module has imported from elsewhere are ignored
        if isinstance(cls, type) and (cls.__module__, cls.__qualname__) == (module_name, name):
            return cls
        return self._classes.get(path)

    def _module(self, name: str) -> ModuleType | None:
        own = getattr(self._simulation.scene.project, "module", lambda _name: None)(name)
        if isinstance(own, ModuleType):
            return own
        module = sys.modules.get(name)
        if name.startswith("morse.") or module is None:
            return module
        folder = _folder_of(module)
        return module if folder is not None and folder in {_folder_of(m) for m in self._component_modules()} else None

    def _component_modules(self) -> list[ModuleType]:
        """Return the modules of the components of the user."""
        context = self._simulation.context
        project = getattr(self._simulation.scene.project, "module", lambda _name: None)
        parts: list[object] = [*context.robots.values(), *context.components.values(), *context.overlays.values()]
        parts += self._simulation.loaded.modifier_objects
        names = {cls.__module__ for part in parts for cls in type(part).__mro__}
        users = sorted(name for name in names if not name.startswith("morse.") and name not in sys.stdlib_module_names)
        modules = [project(name) or sys.modules.get(name) for name in users]
        return [module for module in modules if module is not None]

    def _variables(self) -> Iterator[tuple[str, object]]:
        """Iterate over the objects and functions that are variables of modules and classes of the project."""
        own = list(getattr(self._simulation.scene.project, "own_modules", dict)().values())
        modules = {id(module): module for module in [*own, *self._component_modules()]}
        for module in modules.values():
            for name, value in list(vars(module).items()):
                if name.startswith("__") or isinstance(value, _PLAIN):
                    continue
                if isinstance(value, type):
                    if value.__module__ == module.__name__:
                        yield from _constants(value)
                elif isinstance(value, FunctionType):
                    if value.__module__ == module.__name__:
                        yield f"{module.__name__}:{name}", value
                elif not inspect.isroutine(value):
                    yield f"{module.__name__}:{name}", value


def _constants(cls: type) -> Iterator[tuple[str, object]]:
    for name, value in list(vars(cls).items()):
        if name.startswith("__") or isinstance(value, (*_PLAIN, type, property, staticmethod, classmethod)):
            continue
        if not inspect.isroutine(value) and not inspect.isdatadescriptor(value):
            yield f"{cls.__module__}:{cls.__qualname__}.{name}", value


def _folder_of(module: ModuleType) -> Path | None:
    file = getattr(module, "__file__", None)
    return Path(file).parent if isinstance(file, str) else None
