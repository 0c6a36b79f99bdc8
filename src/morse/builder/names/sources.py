"""Reads class definitions from files without executing them."""

from __future__ import annotations

import pkgutil
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.classes.definitions import indexed

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.classes.definitions import Definition


def classes(package: str) -> Iterator[tuple[str, Definition]]:
    """The public classes in the files of a package, with the names of their modules.

    Raises:
        SyntaxError: one of the files cannot be parsed.
    """
    for module, file in files(package):
        for definition in classes_of(file):
            yield module, definition


def files(package: str) -> Iterator[tuple[str, Path]]:
    """The public modules of a package and their files; empty if the package does not exist."""
    try:
        spec = find_spec(package)
    except ModuleNotFoundError:
        spec = None
    for info in pkgutil.iter_modules(spec.submodule_search_locations if spec else ()):
        if info.ispkg or info.name.startswith("_"):
            continue
        finder = info.module_finder
        module = finder.find_spec(f"{package}.{info.name}", None)
        if module is None or module.origin is None:
            continue
        yield f"{package}.{info.name}", Path(module.origin)


def classes_of(file: Path) -> Iterator[Definition]:
    """The public classes of a file.

    Raises:
        SyntaxError: the file cannot be parsed.
    """
    yield from indexed(file)
