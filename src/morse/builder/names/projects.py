"""Builder classes for the components of a project, derived from their files.

``from ranger_sim.builder.sensors import Sonar`` works as soon as a file in ``src/ranger_sim/sensors/`` contains a class
``Sonar``: the builder class is derived from it. A class of that name in a file in ``src/ranger_sim/builder/sensors/``
takes precedence.
"""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from morse.builder import workspace
from morse.builder.derive import builder_class
from morse.builder.names import catalog, frames
from morse.builder.names.catalog import KINDS, load_class
from morse.core.classes import builder_defaults

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from types import ModuleType

    from morse.builder.names.catalog import Entry

#: the builder class of each component class that a script has called
_called: WeakKeyDictionary[type, type] = WeakKeyDictionary()


def describe(cls: type, *args: object, **kwargs: object) -> Any:
    """The builder object of a component class that a scene script calls; None if the caller is not a scene script."""
    if not workspace.is_being_described():
        return None
    code = sys._getframe(2).f_code
    if not frames.is_users(code) or frames.is_library(code):
        return None
    if cls not in _called:
        _called[cls] = builder_class(cls)
    return _called[cls](*args, **kwargs)


class ProjectFinder:
    """Finds ``<project>.builder`` and ``<project>.builder.<kind>``, whether they have files or not."""

    def install(self) -> None:
        """Install this finder before the path finder, once per process."""
        builder_defaults.describe = describe
        if not any(isinstance(finder, ProjectFinder) for finder in sys.meta_path):
            sys.meta_path.insert(0, self)

    def find_spec(self, name: str, path: Sequence[str] | None, _target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        project, _, kind = name.rpartition(".")
        if kind in KINDS and project.endswith(".builder"):
            package = f"{project.removesuffix('.builder')}.{kind}"
        elif kind == "builder" and project:
            package = project
        else:
            return None
        if project.partition(".")[0] == "morse":
            return None
        spec = PathFinder.find_spec(name, path)
        if kind == "builder":
            # also used for projects without a file for builder classes
            return spec or (ModuleSpec(name, None, is_package=True) if any(_files(project)) else None)
        if spec is None or spec.loader is None or spec.origin is None:
            if not any(True for _ in catalog.files(package)):
                return spec
            folders = [] if spec is None else list(spec.submodule_search_locations or ())
            spec = ModuleSpec(name, _Derived(), is_package=True)  # type: ignore[arg-type] # importlib.abc costs time
            spec.submodule_search_locations = folders
        elif type(spec.loader) is SourceFileLoader:
            spec.loader = _Completed(spec.loader.name, spec.loader.path)
        return spec


def _files(project: str) -> Iterator[str]:
    return (module for kind in KINDS for module, _ in catalog.files(f"{project}.{kind}"))


class _Derived:
    """Creates a module of builder classes without a file."""

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """See `importlib.abc.Loader`."""
        return None

    def exec_module(self, module: ModuleType) -> None:
        """See `importlib.abc.Loader`."""
        names = _Classes(module)
        module.__doc__ = f"The classes for scene scripts of {names.package}, derived from its components."
        module.__dict__.update(__getattr__=names.get, __dir__=names.all, __all__=names.all())


class _Completed(SourceFileLoader):
    """Executes the file of a package of builder classes, and adds the classes that are missing in the file."""

    def exec_module(self, module: ModuleType) -> None:
        """See `importlib.abc.Loader`."""
        super().exec_module(module)
        names = _Classes(module)
        module.__dict__.setdefault("__getattr__", names.get)
        module.__dict__.setdefault("__dir__", names.all)


class _Classes:
    """The builder classes of one kind, derived from the components of a project.

    Args:
        module: module of the new classes, ``<project>.builder.<kind>``.
    """

    def __init__(self, module: ModuleType) -> None:
        project, _, kind = module.__name__.rpartition(".")
        self._module = module.__name__
        self._variables = module.__dict__
        self.package = f"{project.removesuffix('.builder')}.{kind}"

    def get(self, name: str) -> Any:
        """The class of that name.

        Raises:
            AttributeError: no file of the project contains such a class.
            SyntaxError: a file cannot be parsed, and no other file contains the class.
            MorseBuilderNoComponentError: the class cannot be loaded.
        """
        broken: SyntaxError | None = None
        if not name.startswith("__"):
            for file in catalog.files(self.package):
                try:
                    for entry in self._entries(*file):
                        if entry.name == name:
                            return self._variables.setdefault(name, self._class(entry))
                except SyntaxError as error:
                    broken = error
        if broken is not None:
            raise broken
        raise AttributeError(f"module '{self._module}' has no attribute '{name}'", name=name)

    def all(self) -> list[str]:
        """The names of the classes and of the attributes of the module, sorted."""
        names = {name for name in self._variables if not name.startswith("_")}
        for file in catalog.files(self.package):
            try:
                names.update(entry.name for entry in self._entries(*file) if "_name" in entry.attributes)
            except SyntaxError:
                continue
        return sorted(names)

    def _entries(self, module: str, file: Any) -> Iterator[Entry]:
        for definition in catalog.classes_of(file):
            if definition.bases:
                yield from catalog.entries(module, definition, with_name=True)

    def _class(self, entry: Entry) -> type:
        return builder_class(load_class(entry.classpath), entry.product, self._module)
