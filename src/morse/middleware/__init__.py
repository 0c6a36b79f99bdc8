"""The middlewares by which robot controllers connect to the simulation."""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from types import ModuleType

from morse.core.datastream import AbstractDatastream


class _OldModules(MetaPathFinder, Loader):
    """Finds the modules that middlewares declare as `old_modules`: under both paths they are one module.

    Scripts of MORSE 1.4 name such modules: `morse.middleware.socket_datastream`.
    """

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        parent = fullname.rpartition(".")[0]
        if parent == __name__:
            there = PathFinder.find_spec(fullname, path)
            # a folder without a module is what an older checkout has left there
            if there is not None and there.origin is not None:
                return None
        # below a package of today, all modules are where they seem to be
        elif not parent.startswith(f"{__name__}.") or sys.modules[parent].__name__ == parent:
            return None
        from morse.middleware.registry import present_module

        present = present_module(fullname)
        if present is None or (found := find_spec(present)) is None:
            return None
        return ModuleSpec(fullname, self, origin=present, is_package=found.submodule_search_locations is not None)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = import_module(str(spec.origin))
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        # it has been executed under its present path; Python has given it the specification of the old one
        if module.__spec__ is not None:
            module.__spec__ = module.__spec__.loader_state


# before the finders of Python, which would load what is below such a package once more
sys.meta_path.insert(0, _OldModules())

__all__ = ["AbstractDatastream"]
