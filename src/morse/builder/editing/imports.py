"""Imports that new lines of a scene script need."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.builder.editing.source import Source

BUILDER = "morse.builder"


def import_names(source: Source, names: set[str], module: str = BUILDER) -> None:
    """Note an import of each name that the script does not import from a module."""
    imports = [node for node in ast.walk(source.tree) if isinstance(node, ast.ImportFrom) and node.module == module]
    present = {alias.asname or alias.name for node in imports for alias in node.names}
    missing = sorted(names - present - source.imports)
    if "*" in present or not missing:
        return
    source.imports.update(missing)
    if imports:
        end = source.span(imports[0].names[-1])[1]
        source.replace(end, end, "".join(f", {name}" for name in missing))
        return
    # after the other imports, or at the top of a script that has none
    others = [node for node in source.tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
    source.insert_top(others[-1] if others else None, f"from {module} import {', '.join(missing)}")
