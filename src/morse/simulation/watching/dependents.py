"""Determines which modules of a project have to be reimported when some of them have changed."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING

from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping


def to_renew(changed: Iterable[str], running: Iterable[str], sources: Mapping[str, str]) -> set[str]:
    """Return the changed modules and the modules that import them, as far as running classes need them.

    Args:
        changed: names of modules.
        running: the modules of the classes in use.
        sources: the modules of the project, and their files.

    Raises:
        SyntaxError: a file is not valid Python.
        OSError: a file cannot be read.
    """
    imports = {name: set(_imports(name, Path(file), sources)) for name, file in sources.items()}
    importers = {name: {other for other in imports if name in imports[other]} for name in sources}
    return _reached(changed, importers) & _reached(running, imports)


def _reached(first: Iterable[str], ways: Mapping[str, set[str]]) -> set[str]:
    dependents: set[str] = set()
    waiting = [name for name in first if name in ways]
    while waiting:
        name = waiting.pop()
        if name not in dependents:
            dependents.add(name)
            waiting += ways[name]
    return dependents


def _imports(module: str, path: Path, modules: Mapping[str, str]) -> Iterator[str]:
    """Iterate over the known modules that a file imports, at any place in the file."""
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in ast.walk(ast.parse(read_regular(path), str(path))):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            names = [base, *(f"{base}.{alias.name}" for alias in node.names)]
        yield from (name for name in names if name in modules and name != module)
