"""Imports of the modules of a project, isolated from those of the process.

Each simulation has its own copies of the modules of its project. Several simulations, even of one project, do not share
modules, and no module remains in the process afterwards.
"""

from __future__ import annotations

import builtins
import functools
import importlib
import linecache
import os
import sys
import sysconfig
import threading
from contextlib import contextmanager
from importlib.machinery import PathFinder
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType, TracebackType

_switching = threading.RLock()


class ProjectImports:
    """The modules of a project; inside ``with project:`` they can be imported normally.

    Within the block, the directories of the project come first on ``sys.path``, its modules are in ``sys.modules``, and
    ``sys.argv`` contains the arguments of its script. Only one thread at a time can be in such a block. Import
    statements in the code of the project enter the block automatically.

    Args:
        directories: directories of the packages of the project and of its scene script.
        argv: ``sys.argv`` for the script.
        finders: meta path finders that take precedence inside the block.
        from_source: whether to compile every module, even if Python has a cached compiled file.
        as_imported: returns a module of the process as the code of the project sees it.
        names: what the code of the project can use without importing it, as the built-in functions.
    """

    def __init__(
        self,
        directories: Iterable[str] = (),
        argv: Sequence[str] = (),
        finders: Sequence[Any] = (),
        *,
        from_source: bool = False,
        as_imported: Callable[[ModuleType], ModuleType] = lambda module: module,
        names: Mapping[str, object] = MappingProxyType({}),
    ) -> None:
        self._as_imported = as_imported
        self._directories = list(directories)
        self._argv = list(argv)
        self._modules: dict[str, ModuleType] = {}
        self._names: set[str] = set()
        self._depth = 0
        self._from_source = self._renewing = from_source
        self._finders: list[Any] = [*finders, self]
        self._builtins = {**vars(builtins), **names, "__import__": self._import}
        self._former: tuple[list[str], list[str], dict[str, ModuleType]] = ([], [], {})

    def offer(self, name: str, module: ModuleType) -> None:
        """Let the project import a module under the given name."""
        self._names.add(name)
        self._modules[name] = module

    def module(self, name: str) -> ModuleType | None:
        """Return the module of the project with that name, or None if it has not been imported."""
        if name.partition(".")[0] not in self._names:
            return None
        return sys.modules.get(name) if self._depth else self._modules.get(name)

    def sources(self) -> dict[str, str]:
        """Return the imported modules of the project and their files."""
        table = sys.modules if self._depth else self._modules
        paths = {}
        for name, module in list(table.items()):
            file = getattr(module, "__file__", None)
            if name.partition(".")[0] in self._names and isinstance(file, str) and file.endswith(".py"):
                paths[name] = file
        return paths

    @contextmanager
    def renewed(self, names: Iterable[str]) -> Iterator[None]:
        """Reimport modules from their files, all or none; an error in the block restores the old modules.

        Raises:
            Exception: any exception of a module.
        """
        with self:
            before = {name: sys.modules.pop(name) for name in names if name in sys.modules}
            importlib.invalidate_caches()
            linecache.checkcache()
            self._renewing = True
            try:
                for name in before:
                    _with_submodules(importlib.import_module(name))
                self._renewing = self._from_source
                yield
            except BaseException:
                for name in before:
                    sys.modules.pop(name, None)
                sys.modules.update(before)
                for module in before.values():
                    _bind(module)
                raise
            finally:
                self._renewing = self._from_source

    def own_modules(self) -> dict[str, ModuleType]:
        """Return the imported modules of the project by name."""
        modules = sys.modules if self._depth else self._modules
        return {name: module for name, module in list(modules.items()) if name.partition(".")[0] in self._names}

    def __enter__(self) -> ProjectImports:
        _switching.acquire()
        self._depth += 1
        if self._depth == 1:
            self._switch_in()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._depth == 1:
            self._switch_out()
        self._depth -= 1
        _switching.release()

    def stay(self) -> None:
        """Enter permanently, for a process that runs only this simulation."""
        with _switching:
            self._depth += 1
            if self._depth == 1:
                self._switch_in()

    def leave(self) -> None:
        """Undo `stay`, before another project replaces this one."""
        with _switching:
            self._depth -= 1
            if self._depth == 0:
                self._switch_out()

    def _switch_in(self) -> None:
        hides = self._names | {name for name in self._offered() if not _is_library(name)}
        modules = {name: module for name, module in sys.modules.items() if name.partition(".")[0] in hides}
        self._former = (list(sys.path), list(sys.argv), modules)
        for name in modules:
            del sys.modules[name]
        sys.modules.update(self._modules)
        sys.path[:0] = self._directories
        if self._argv:
            sys.argv[:] = self._argv
        place = sys.meta_path.index(PathFinder) if PathFinder in sys.meta_path else len(sys.meta_path)
        sys.meta_path[place:place] = self._finders

    def _switch_out(self) -> None:
        path, argv, modules = self._former
        for name in [name for name in sys.modules if name.partition(".")[0] in self._names]:
            self._modules[name] = sys.modules.pop(name)
        sys.modules.update(modules)
        # entries that the script added to the path are for its own modules
        new_entries = [entry for entry in sys.path if entry not in path and entry not in self._directories]
        self._directories += new_entries
        sys.path[:], sys.argv[:] = path, argv
        sys.meta_path[:] = [finder for finder in sys.meta_path if all(finder is not own for own in self._finders)]
        self._former = ([], [], {})

    def _offered(self) -> set[str]:
        """Return the modules imported in the process whose names are also names of files of the project."""
        names: set[str] = set()
        for directory in self._directories:
            try:
                entries = os.listdir(directory or ".")
            except OSError:
                continue
            names.update(name for entry in entries if (name := entry.partition(".")[0]) in sys.modules)
        return names

    # -- finding ---------------------------------------------------------------------------

    def find_spec(self, name: str, path: Sequence[str] | None, target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        if path is None:
            spec = PathFinder.find_spec(name, self._directories)
            if spec is None or (spec.origin is None and _is_module(PathFinder.find_spec(name))):
                # a directory of that name does not hide a library
                return None
            self._names.add(name)
        elif name.partition(".")[0] in self._names:
            spec = PathFinder.find_spec(name, path)
        else:
            return None
        if spec is not None and spec.loader is not None and hasattr(spec.loader, "exec_module"):
            spec.loader = _Loader(spec.loader, self._builtins, self._renewing)  # type: ignore[assignment]
        return spec

    def _import(
        self,
        name: str,
        globals: Any = None,
        locals: Any = None,
        fromlist: Any = (),
        level: int = 0,
    ) -> object:
        """Implementation of the import statement for the code of the project."""
        if level == 0 and name.partition(".")[0] not in self._names and name in sys.modules:
            return self._as_imported(builtins.__import__(name, globals, locals, fromlist, level))
        if not self._depth:
            there = self._imported(name, globals, fromlist, level)
            if there is not None:
                return there
        # needed even while another thread has entered, because that thread may leave during this import
        with self:
            return self._as_imported(builtins.__import__(name, globals, locals, fromlist, level))

    def _imported(self, name: str, globals: Any, fromlist: Any, level: int) -> ModuleType | None:
        """Fast path for modules that are already imported, because an import statement may run in every tick."""
        if level:
            package = str((globals or {}).get("__package__") or "")
            if package.count(".") < level - 1:
                return None
            above = package.rsplit(".", level - 1)[0] if level > 1 else package
            name = f"{above}.{name}" if name else above
        module = self._modules.get(name)
        if module is None or getattr(getattr(module, "__spec__", None), "_initializing", False):
            return None
        if not fromlist:
            return self._modules.get(name.partition(".")[0])
        return module if "*" not in fromlist and all(hasattr(module, part) for part in fromlist) else None

    def prepare(self, module: ModuleType) -> None:
        """Install the project's import function in a module that is about to be executed."""
        module.__dict__["__builtins__"] = self._builtins


def offers(package: str) -> bool:
    """Whether the project whose block is entered contains a package; nothing is imported."""
    projects = [finder for finder in sys.meta_path if isinstance(finder, ProjectImports)]
    return any(project.find_spec(package, None) is not None for project in projects)


def _bind(module: ModuleType) -> None:
    """Set a module as the attribute of its package."""
    package, _, name = module.__name__.rpartition(".")
    if package in sys.modules:
        setattr(sys.modules[package], name, module)


def _with_submodules(package: ModuleType) -> None:
    """Set the submodules that were not reimported as attributes of a reimported package."""
    for name, module in list(sys.modules.items()):
        if name.rpartition(".")[0] == package.__name__:
            _bind(module)


def _is_library(name: str) -> bool:
    """Whether an imported module belongs to Python, to MORSE or to an installed package, and is shared by projects."""
    if name in sys.stdlib_module_names or name in ("__main__", "morse", "pymorse"):
        return True
    spec = getattr(sys.modules[name], "__spec__", None)
    origin = getattr(spec, "origin", None)
    return isinstance(origin, str) and (origin in ("built-in", "frozen") or origin.startswith(_libraries()))


@functools.cache
def _libraries() -> tuple[str, ...]:
    paths = sysconfig.get_paths()
    return tuple({paths[name] + os.sep for name in ("stdlib", "platstdlib", "purelib", "platlib")})


def _is_module(spec: ModuleSpec | None) -> bool:
    return spec is not None and spec.origin is not None


class _Loader:
    """Wraps the loader of a module of a project, so that it is executed with the imports of the project."""

    def __init__(self, loader: Any, names: dict[str, Any], from_source: bool) -> None:
        self._loader = loader
        self._names = names
        self._from_source = from_source

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """See `importlib.abc.Loader`."""
        module: ModuleType | None = self._loader.create_module(spec)
        return module

    def exec_module(self, module: ModuleType) -> None:
        """See `importlib.abc.Loader`."""
        module.__dict__["__builtins__"] = self._names
        path = str(getattr(self._loader, "path", ""))
        # checked, because a saved file may have become a pipe, which the loaders of Python would wait for
        source = read_regular(path) if path.endswith(".py") else None
        if self._from_source and source is not None:
            # a cached compiled file is only compared with its source by the second of modification
            exec(compile(source, path, "exec", dont_inherit=True), module.__dict__)
        else:
            self._loader.exec_module(module)

    def __getattr__(self, name: str) -> Any:
        if name == "_loader":
            raise AttributeError(name)
        return getattr(self._loader, name)
