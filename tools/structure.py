"""The size of the sources: files, lines, imports, modules with one importer, lines that give up types, tests."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

_ROOT = Path(__file__).parents[1]
_SHORT = 60


def _module(file: Path) -> str:
    parts = file.relative_to(_ROOT / "src").with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imports(tree: ast.Module, modules: set[str]) -> set[str]:
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            whole = {f"{node.module}.{name.name}" for name in node.names}
            found |= (whole & modules) or {node.module}
    return found & modules


def _header(tree: ast.Module) -> int:
    """The lines of imports at the top level, with those for types only."""
    return sum(
        (node.end_lineno or 0) - node.lineno + 1
        for node in tree.body
        if isinstance(node, (ast.Import, ast.ImportFrom))
        or (isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING")
    )


def _outside_of_functions(file: Path) -> tuple[int, int, int]:
    """The lines of a file of tests, those outside of its test functions, and the blank lines among the latter."""
    lines = file.read_text(encoding="utf-8").splitlines()
    outside = set(range(1, len(lines) + 1))
    for node in ast.walk(ast.parse("\n".join(lines))):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.name.startswith("test_"):
            first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
            outside -= set(range(first, (node.end_lineno or first) + 1))
    return len(lines), len(outside), sum(not lines[number - 1].strip() for number in outside)


def lines_with_any(texts: Iterable[str], aliases: str) -> int:
    """The lines of code, without comments and texts, that contain `Any` or an alias of it in `morse.core.values`."""
    names = {"Any"}
    for name, definition in re.findall(r"^(\w+): TypeAlias = (.+)$", aliases, re.MULTILINE):
        if names & set(re.findall(r"\w+", definition)):
            names.add(name)
    return sum(
        len(
            {
                token.start[0]
                for token in tokenize.generate_tokens(io.StringIO(text).readline)
                if (token.type == tokenize.NAME and token.string in names)
                or (token.type == tokenize.STRING and token.string.strip("\"'") in names)
            }
        )
        for text in texts
    )


def main() -> int:
    """Print the table."""
    files = [file for file in sorted((_ROOT / "src").rglob("*.py")) if "/morse/data/" not in file.as_posix()]
    texts = {file: file.read_text(encoding="utf-8") for file in files}
    trees = {file: ast.parse(text) for file, text in texts.items()}
    lines = {file: text.count("\n") for file, text in texts.items()}
    modules = {_module(file) for file in files}
    users = Counter(name for file, tree in trees.items() for name in _imports(tree, modules) - {_module(file)})
    plugins = [file for file in files if "/morse/plugins/" in file.as_posix()]
    single = [file for file in files if users[_module(file)] == 1 and file.name != "__init__.py"]
    tests = [_outside_of_functions(file) for file in (_ROOT / "tests").rglob("*.py")]
    values = texts[_ROOT / "src" / "morse" / "core" / "values.py"]
    rows = {
        "files of Python, core and plug-ins": len(files),
        "files in plug-ins": len(plugins),
        "lines, core and plug-ins": sum(lines.values()),
        "lines in plug-ins": sum(lines[file] for file in plugins),
        "lines of imports, %": round(100.0 * sum(map(_header, trees.values())) / sum(lines.values()), 1),
        f"files of less than {_SHORT} lines": sum(count < _SHORT for count in lines.values()),
        "modules with one importer": len(single),
        f"of these with less than {_SHORT} lines": sum(lines[file] < _SHORT for file in single),
        "longest file, lines": max(lines.values()),
        "lines with Any or a name for it": lines_with_any(texts.values(), values),
        "lines of tests": sum(whole for whole, _, _ in tests),
        "of these outside of test functions": sum(outside for _, outside, _ in tests),
        # the formatter puts two between functions
        "of these blank": sum(blank for _, _, blank in tests),
    }
    print("\n".join(f"| {name} | {value:,} |" for name, value in rows.items()))
    return 0
