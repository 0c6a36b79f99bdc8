"""Prevents files of a user from hiding libraries."""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from importlib.machinery import ModuleSpec


class LibrariesFirst:
    """Finds libraries although the directory of the scene script comes first on the path.

    Otherwise, a script ``random.py`` or ``rich.py`` would be executed again instead of the library at each import.

    Args:
        script: name of the scene script, without suffix; it is never imported.
        directories: other directories whose files do not hide the standard library.
    """

    def __init__(self, script: str, directories: Iterable[str]) -> None:
        self._script = script
        self._directories = list(directories)

    def find_spec(self, name: str, path: Sequence[str] | None, _target: object = None) -> ModuleSpec | None:
        """See `importlib.abc.MetaPathFinder`."""
        if path is not None or (name != self._script and name not in sys.stdlib_module_names):
            return None
        if PathFinder.find_spec(name, self._directories) is None:
            return None  # no file hides the library
        hiding = {Path(directory).resolve() for directory in self._directories}
        spec = PathFinder.find_spec(name, [entry for entry in sys.path if Path(entry).resolve() not in hiding])
        # a folder of that name is not a library
        return None if spec is None or spec.loader is None else spec
