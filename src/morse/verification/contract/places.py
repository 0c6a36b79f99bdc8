"""The file and line in which a component declares something."""

from __future__ import annotations

import ast
import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_KEPT = 64


class Places:
    """Finds declarations.

    Args:
        files: files of modules that only one simulation has imported, by name.
    """

    def __init__(self, files: Mapping[str, str]) -> None:
        self._files = dict(files)

    def of_class(self, cls: type) -> str:
        """File and line of a class, as ``path:line``; empty if it has no file."""
        file = self._file(cls)
        definition = _definition(cls, file)
        return _shown(file, definition.lineno) if definition is not None else ""

    def of(self, cls: type, function: str, name: str) -> str:
        """File and line in which a class or one of its bases declares something.

        Args:
            function: ``add_data``, ``add_property``, ``add_level``; ``def`` for a method.
            name: the name that is declared, as any of the first three arguments.
        """
        for base in cls.__mro__:
            file = self._file(base)
            definition = _definition(base, file)
            for line in () if definition is None else _declared(definition, function, name):
                return _shown(file, line)
        return self.of_class(cls)

    def _file(self, cls: type) -> str:
        file = self._files.get(cls.__module__)
        return file or str(getattr(sys.modules.get(cls.__module__), "__file__", "") or "")


def _declared(definition: ast.ClassDef, function: str, name: str) -> Iterator[int]:
    for statement in definition.body:
        if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
            if function == "def" and statement.name == name:
                yield statement.lineno
            continue
        for node in ast.walk(statement):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == function:
                words = [argument.value for argument in node.args[:3] if isinstance(argument, ast.Constant)]
                if name in words:
                    yield node.lineno


def _definition(cls: type, file: str) -> ast.ClassDef | None:
    return next((d for d in _classes(file) if d.name == cls.__name__), None) if file else None


@lru_cache(maxsize=_KEPT)
def _parsed(file: str, _modified: float) -> tuple[ast.ClassDef, ...]:
    tree = ast.parse(read_regular(file), file)
    return tuple(node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))


def _classes(file: str) -> tuple[ast.ClassDef, ...]:
    try:
        return _parsed(file, os.stat(file).st_mtime)
    except (OSError, SyntaxError, ValueError):
        return ()


def _shown(file: str, line: int) -> str:
    path, here = Path(file), Path.cwd()
    return f"{path.relative_to(here) if path.is_relative_to(here) else path}:{line}"
