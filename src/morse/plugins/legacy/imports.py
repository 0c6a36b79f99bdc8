"""The command line of scripts as it was, and modules that are elsewhere today or that Python has removed."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import sys
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any

from morse.builder.compatibility import ScriptModules
from morse.builder.names.project_files import project_files
from morse.builder.workspace import notice
from morse.core.classes import old_modules
from morse.plugins.legacy import bpy, earlier
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

#: under Blender, the arguments of a script follow this word
MARK = "--"


def argv(script: Path, arguments: Sequence[str], directories: Iterable[str]) -> list[str]:
    """``sys.argv`` for a script: its path and its arguments.

    A script of MORSE 1.4 finds its own arguments by ``sys.argv[sys.argv.index('--') + 1:]``. If the script, or a module
    of its project, has the word ``'--'``, it precedes the arguments. Otherwise it is left out: ``argparse`` reads it as
    the end of the options.

    Args:
        script: the file of the scene.
        arguments: the words after the scene on the command line.
        directories: directories of the packages of its project.
    """
    if not _is_written_in(script) and not any(_has_mark(tree) for tree in project_files(script, directories)):
        return [str(script), *arguments]
    return [str(script), MARK, *(arguments[1:] if list(arguments[:1]) == [MARK] else arguments)]


def _is_written_in(script: Path) -> bool:
    """Whether a script that cannot be parsed contains the word."""
    try:
        source = read_regular(script)
        ast.parse(source)
    except OSError:
        return False
    except (SyntaxError, ValueError):
        return any(f"{quote}{MARK}{quote}".encode() in source for quote in "'\"")
    return False


def _has_mark(tree: ast.AST) -> bool:
    return any(isinstance(node, ast.Constant) and node.value == MARK for node in ast.walk(tree))


_HERE = "morse.plugins.legacy.substitutes"
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


class OldModules:
    """Finds modules that Python has removed, and those of the stand-in for ``bpy``, for the code of a scene script."""

    def __init__(self) -> None:
        # those that another program of the process has imported are told in this script, too
        self._names = [name for name in sys.modules if _is_told(name)]
        self._forget()
        old_modules.observers.append(self._tell)

    def close(self) -> None:
        """Leave none of these modules to other programs and scripts of the process."""
        old_modules.observers.remove(self._tell)
        self._forget()

    def _forget(self) -> None:
        for name in self._names:
            sys.modules.pop(name, None)
            parent, _, last = name.rpartition(".")
            if parent in sys.modules:
                vars(sys.modules[parent]).pop(last, None)
        self._names.clear()

    def _tell(self, old: str, present: str) -> None:
        """Log the new path of a module."""
        if _is_told(old):
            self._names.append(old)
            today = "morse.builder" if old.startswith("morse.core.") else present
            notice(f"{old} is an old name, write {today}", old, today)

    def find_spec(self, name: str, path: Sequence[str] | None, _target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        if name not in MODULES and not _is_of_blender(name, path):
            return None
        self._names.append(name)
        return ModuleSpec(name, _Loader(), is_package=True)  # type: ignore[arg-type] # importlib.abc costs time


def _is_told(name: str) -> bool:
    """Whether a script is told the new path of a module; others are known well, and are no mistake."""
    return name.startswith("morse.builder.robots.") or name == "morse.core.morse_time"


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
        return bpy.StandIn(spec.name) if spec.name not in MODULES else None

    def exec_module(self, module: ModuleType) -> None:
        """See `importlib.abc.Loader`."""
        if module.__name__ not in MODULES:
            return
        there, today = MODULES[module.__name__]
        notice(f"Python has removed the module {module.__name__}; write {today}")
        substitute = importlib.import_module(there)
        public = getattr(substitute, "__all__", None) or [word for word in vars(substitute) if not word.startswith("_")]
        module.__dict__.update({word: getattr(substitute, word) for word in public}, __all__=list(public))


def script_modules() -> ScriptModules:
    """What the code of one script can import or use."""
    old = OldModules()
    offered: dict[str, ModuleType] = {}
    if _lacks("mathutils"):
        offered["mathutils"] = importlib.import_module("morse.mathutils")
    if _lacks(bpy.NAME):
        offered[bpy.NAME] = bpy.stand_in()
    names = {name: getattr(earlier, name) for name in earlier.__all__}
    return ScriptModules([old], offered, names, as_imported, old.close)


def _lacks(name: str) -> bool:
    """Whether a module is missing that scripts of 1.4 import because Blender contained it."""
    spec = importlib.util.find_spec(name)
    # a folder of that name on the path is not a module
    return spec is None or spec.origin is None
