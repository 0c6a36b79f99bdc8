"""The folders of a project around a scene script, and the files that it imports, read without executing them."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.formats import is_model
from morse.system.regular_files import folders_above, read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

#: number of folders above a script that may contain the project
_LEVELS = 4


def source_folders(script: Path) -> list[str]:
    """Folders of Python packages: ``src`` beside the script or above it, nearest first; then that of the script.

    A model that is run as a scene is data: it brings no code.
    """
    if is_model(script):
        return []
    return [*_named("src", script), str(script.parent)]


def resource_folders(script: Path) -> list[str]:
    """Folders of models: ``data`` beside the script or above it, nearest first; then that of the script."""
    return [*_named("data", script), str(script.parent)]


def _named(name: str, script: Path) -> list[str]:
    folders = [folder / name for folder in folders_above(script)[:_LEVELS]]
    return [str(folder) for folder in folders if folder.is_dir()]


def project_files(script: Path, directories: Iterable[str]) -> Iterator[ast.Module]:
    """The syntax trees of a script and of the modules that it imports from the directories, directly or not.

    Files that cannot be parsed are left out.
    """
    places = list(directories)
    visited: set[Path] = set()
    queue = [script]
    while queue:
        file = queue.pop()
        if file in visited:
            continue
        visited.add(file)
        try:
            tree = ast.parse(read_regular(file))
        except (OSError, SyntaxError, ValueError):
            continue
        yield tree
        for node in ast.walk(tree):
            queue += [path for name in _modules(node) for path in _files(name, places)]


def _modules(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        # only the last words of a relative import are known: all directories are searched for them
        return [node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)]
    return []


def _files(module: str, directories: list[str]) -> list[Path]:
    path = Path(*module.split(".")) if module else Path()
    candidates = [Path(directory) / path for directory in directories]
    files = [file for stem in candidates for file in (stem.with_suffix(".py"), stem / "__init__.py")]
    # a script in a checkout of MORSE does not make MORSE a part of its project
    is_project = module.partition(".")[0] not in ("", "morse", "pymorse")
    return [file for file in files if is_project and file.is_file()]
