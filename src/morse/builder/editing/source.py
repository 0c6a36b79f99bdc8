"""The text of a scene script, with the places of its statements."""

from __future__ import annotations

import ast
import builtins
import keyword
from typing import TYPE_CHECKING

from morse.builder.editing.changes import UnwritableError

if TYPE_CHECKING:
    from collections.abc import Iterator


class Source:
    """A script and the replacements that are to be made in it.

    All places are counted in bytes, as `ast` counts columns.

    Attributes:
        tree: the script.
        block: the statements among which ``Environment(...)`` stands.
        environment: that statement.
        imports: names whose import is noted.

    Raises:
        UnwritableError: it is not valid Python, or does not create an environment.
    """

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        self._data = text.encode()
        self._newline = "\r\n" if "\r\n" in text else "\n"
        self._lines = self._data.splitlines(keepends=True)
        self._starts = [0]
        for line in self._lines:
            self._starts.append(self._starts[-1] + len(line))
        self.imports: set[str] = set()
        self._replacements: list[tuple[int, int, str]] = []
        try:
            self.tree = ast.parse(text)
        except SyntaxError as error:
            raise UnwritableError(f"{name}, line {error.lineno}, is not valid Python: {error.msg}") from None
        place = _block_of(self.tree.body)
        if place is None:
            raise UnwritableError(f"{name} does not contain Environment(...), before which new objects are written")
        self.block, self.environment = place
        self.quote = "'" if text.count("'") > text.count('"') else '"'

    @property
    def indent(self) -> str:
        """The indentation of the block."""
        return " " * self.environment.col_offset

    def names(self) -> set[str]:
        """Every name that the script uses, and those that have a meaning in Python."""
        used = {node.id for node in ast.walk(self.tree) if isinstance(node, ast.Name)}
        used |= {node.attr for node in ast.walk(self.tree) if isinstance(node, ast.Attribute)}
        used |= {node.name for node in ast.walk(self.tree) if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        return used | set(dir(builtins)) | {*keyword.kwlist, *keyword.softkwlist}

    def segment(self, node: ast.expr) -> str:
        """The text of an expression."""
        begin, end = self.span(node)
        return self._data[begin:end].decode()

    def span(self, node: ast.stmt | ast.expr | ast.alias) -> tuple[int, int]:
        """Begin and end."""
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return (
            self._starts[node.lineno - 1] + node.col_offset,
            self._starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def replace(self, begin: int, end: int, text: str) -> None:
        """Note a replacement."""
        self._replacements.append((begin, end, text))

    def insert_after(self, statement: ast.stmt, lines: list[str]) -> None:
        """Note new lines after a statement."""
        assert statement.end_lineno is not None
        text = "".join(f"{self.indent}{line}{self._newline}" if line else self._newline for line in lines)
        end = self._starts[statement.end_lineno]
        if not self._data[:end].endswith((b"\n", b"\r")):  # the last line of the file
            text = self._newline + text
        self.replace(end, end, text)

    def insert_top(self, statement: ast.stmt | None, line: str) -> None:
        """Note a line without indentation after a statement, or at the top."""
        place = 0 if statement is None or statement.end_lineno is None else self._starts[statement.end_lineno]
        self.replace(place, place, line + self._newline)

    def insert_before_environment(self, paragraphs: list[list[str]]) -> None:
        """Note new lines before the environment, and before the comments that belong to it."""
        row = self.environment.lineno - 1
        while row > 0 and self._lines[row - 1].lstrip().startswith(b"#"):
            row -= 1
        lines = [line for number, paragraph in enumerate(paragraphs) for line in ([""] * (number > 0) + paragraph)]
        if row > 0 and self._lines[row - 1].strip():
            lines.insert(0, "")
        text = "".join(f"{self.indent}{line}{self._newline}" if line else self._newline for line in [*lines, ""])
        self.replace(self._starts[row], self._starts[row], text)

    def remove(self, statement: ast.stmt) -> None:
        """Note that the lines of a statement are removed; a comment behind it goes with it."""
        assert statement.end_lineno is not None
        self.replace(self._starts[statement.lineno - 1], self._starts[statement.end_lineno], "")

    def text(self) -> str:
        """The script with all replacements."""
        data = self._data
        # those at one place stand in the order in which they were noted
        ordered = sorted(enumerate(self._replacements), key=lambda one: (one[1][0], one[1][1], one[0]), reverse=True)
        for _, (begin, end, text) in ordered:
            data = data[:begin] + text.encode() + data[end:]
        return data.decode()


def _makes_environment(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and name_of(node.func).rpartition(".")[2] == "Environment"


def name_of(node: ast.AST) -> str:
    """The dotted name of an expression; empty if it is none."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute) and (owner := name_of(node.value)):
        return f"{owner}.{node.attr}"
    return ""


def _block_of(block: list[ast.stmt]) -> tuple[list[ast.stmt], ast.stmt] | None:
    """The innermost list of statements that contains an environment, and the statement."""
    for statement in block:
        if not any(_makes_environment(node) for node in ast.walk(statement)):
            continue
        for inner in _blocks(statement):
            if (place := _block_of(inner)) is not None:
                return place
        return block, statement
    return None


def _blocks(statement: ast.stmt) -> Iterator[list[ast.stmt]]:
    for name in ("body", "orelse", "finalbody"):
        block = getattr(statement, name, None)
        if isinstance(block, list) and block and isinstance(block[0], ast.stmt):
            yield block
