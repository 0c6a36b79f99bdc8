"""Names that Python has removed since the time of MORSE 1.4, for the code of scene scripts and their projects.

They work as before, and the log says how to write them today.
"""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from morse.builder.legacy.notices import notice

if TYPE_CHECKING:
    from collections.abc import Mapping

_HERE = "morse.builder.legacy.substitutes"
_ABC = (
    "Awaitable", "Callable", "Container", "Coroutine", "Generator", "Hashable", "ItemsView", "Iterable", "Iterator",
    "KeysView", "Mapping", "MappingView", "MutableMapping", "MutableSequence", "MutableSet", "Sequence", "Set", "Sized",
    "ValuesView",
)  # fmt: skip

#: module to removed names, each with what stands for it today
REMOVED: Mapping[str, Mapping[str, str]] = {
    "base64": {"decodestring": "base64.decodebytes", "encodestring": "base64.encodebytes"},
    "collections": {name: f"collections.abc.{name}" for name in _ABC},
    "fractions": {"gcd": "math.gcd"},
    "inspect": {"getargspec": "inspect.getfullargspec"},
    "platform": dict.fromkeys(("dist", "linux_distribution"), "platform.freedesktop_os_release"),
    "time": {"clock": "time.perf_counter"},
}

#: removed names whose replacement has another result
_ADAPTED = {
    "inspect.getargspec": f"{_HERE}.getargspec",
    "platform.dist": f"{_HERE}.distribution",
    "platform.linux_distribution": f"{_HERE}.distribution",
}

#: removed modules, and the modules with the same names; how to write them today
MODULES: Mapping[str, tuple[str, str]] = {
    "imp": (f"{_HERE}", "importlib"),
    "xml.etree.cElementTree": ("xml.etree.ElementTree", "xml.etree.ElementTree"),
}


class WithRemoved(ModuleType):
    """A module of Python with the names that were removed from it."""

    def __init__(self, module: ModuleType) -> None:
        super().__init__(module.__name__, module.__doc__)
        # names of the module are looked up without a detour
        self.__dict__.update(vars(module))

    def __getattr__(self, name: str) -> Any:
        replacement = REMOVED[self.__name__].get(name)
        if replacement is None:
            raise AttributeError(f"module '{self.__name__}' has no attribute '{name}'", name=name, obj=self)
        old = f"{self.__name__}.{name}"
        notice(f"Python has removed {old}; write {replacement}", old, replacement)
        module, _, value = _ADAPTED.get(old, replacement).rpartition(".")
        return getattr(importlib.import_module(module), value)


_modules: dict[str, WithRemoved] = {}


def as_imported(module: ModuleType) -> ModuleType:
    """A module as code of the time of MORSE 1.4 knows it."""
    name = module.__name__
    if name not in REMOVED or sys.modules.get(name) is not module:
        return module
    if name not in _modules:
        _modules[name] = WithRemoved(module)
    return _modules[name]
