"""Runs the cells of a notebook without Jupyter."""

from __future__ import annotations

import ast
import json
import linecache
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).parents[2] / "examples"


def run_cells(name: str, **changes: str) -> tuple[dict[str, Any], list[Any]]:
    """Run a notebook of the examples; returns its variables, and the value of each cell of code.

    Args:
        name: the file in ``examples``.
        changes: texts in the place of others: ``duration="0.5"`` changes ``duration=5``.
    """
    values: dict[str, Any] = {"__name__": "__main__"}
    shown = []
    cells = json.loads((EXAMPLES / name).read_text(encoding="utf-8"))["cells"]
    for number, cell in enumerate(cells):
        if cell["cell_type"] != "code":
            continue
        text, file = "".join(cell["source"]), f"<cell {number}>"
        tree = ast.parse(text)
        for node in ast.walk(tree):
            if isinstance(node, ast.keyword) and node.arg in changes:
                node.value = ast.copy_location(ast.parse(changes[node.arg], mode="eval").body, node.value)
                ast.fix_missing_locations(node.value)
        # as IPython does: the sources of functions are found, and the last expression is the value of the cell
        linecache.cache[file] = len(text), None, text.splitlines(True), file
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, file, "exec"), values)
        shown.append(eval(compile(ast.Expression(last.value), file, "eval"), values) if last is not None else None)
    return values, shown
