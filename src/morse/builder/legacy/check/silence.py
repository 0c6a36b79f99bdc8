"""Leaves out the statement of a script that raised an error, so that the next error can be seen."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from collections.abc import Iterator


class Silence:
    """The statements that have been left out.

    A statement that uses a name which such a statement should have set fails because of that alone.
    """

    def __init__(self, tree: ast.Module) -> None:
        self._tree = tree
        self._missing: set[str] = set()

    def leave_out(self, line: int) -> bool | None:
        """Replace the innermost statement at a line by ``pass``.

        Returns:
            Whether it fails by itself, not because of an earlier one; None if there is no statement.
        """
        place = next(iter(sorted(self._at(line), key=lambda entry: _length(entry[1][entry[2]]))), None)
        if place is None:
            return None
        owner, body, index = place
        statement = body[index]
        by_itself = not self._missing & set(_read(statement))
        self._missing.update(_written(statement))
        body[index] = ast.copy_location(ast.Pass(), statement)
        ast.fix_missing_locations(owner)
        return by_itself

    def _at(self, line: int) -> Iterator[tuple[ast.AST, list[ast.stmt], int]]:
        for node in ast.walk(self._tree):
            for field in ("body", "orelse", "finalbody"):
                body = getattr(node, field, None)
                # the body of a lambda is an expression
                for index, statement in enumerate(body) if isinstance(body, list) else ():
                    inside = statement.lineno <= line <= (statement.end_lineno or statement.lineno)
                    if inside and not isinstance(statement, ast.Pass):
                        yield node, cast("list[ast.stmt]", body), index


def _length(statement: ast.stmt) -> int:
    return (statement.end_lineno or statement.lineno) - statement.lineno


def _read(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self":
            yield f"self.{node.attr}"


def _written(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        match node:
            case ast.Name(id=name, ctx=ast.Store()):
                yield name
            case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                yield f"self.{name}"
            case ast.alias(name=name, asname=other):
                yield other or name.partition(".")[0]
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                yield name
