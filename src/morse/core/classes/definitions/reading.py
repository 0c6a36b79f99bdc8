"""Reads the definitions of classes from the text of a file, without executing it."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from morse.core.values import Value


@dataclass(frozen=True, slots=True)
class Definition:
    """A class in a file.

    Attributes:
        name: name of the class.
        doc: its docstring, or None.
        bases: the class paths of its base classes as far as the file says: relative to the file for a class of the
            same file (``.Name``) and for a relative import.
        attributes: the attributes in its body whose values are plain literals.
        defaults: the literal arguments of each call of ``..Defaults(...)`` assigned to ``_builder`` and ``_products``.
    """

    name: str
    doc: str | None
    bases: tuple[str, ...]
    attributes: dict[str, Value]
    defaults: dict[str, list[dict[str, Value]]]


def definitions(text: bytes, name: str) -> list[Definition]:
    """The public classes in the text of a file.

    Args:
        text: content of the file.
        name: name of the file, for error messages.

    Raises:
        SyntaxError: the text is not valid Python.
    """
    tree = ast.parse(text, name)
    imports = dict(_imported(tree))
    classes = (statement for statement in tree.body if isinstance(statement, ast.ClassDef))
    return [_definition(cls, imports) for cls in classes if not cls.name.startswith("_")]


def _imported(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """The names that a file imports, and their class paths."""
    for statement in tree.body:
        if isinstance(statement, ast.ImportFrom):
            # a file is the module "." of its package: an import from "." is one level above
            module = "." * (statement.level + 1 if statement.level else 0) + (statement.module or "")
            for name in statement.names:
                yield name.asname or name.name, f"{module.removesuffix('.')}.{name.name}"
        elif isinstance(statement, ast.Import):
            for name in statement.names:
                yield (
                    name.asname or name.name.partition(".")[0],
                    (name.name if name.asname else name.name.partition(".")[0]),
                )


def _base(base: ast.expr, imports: Mapping[str, str]) -> str:
    first, dot, rest = ast.unparse(base).partition(".")
    return f"{imports.get(first, f'.{first}')}{dot}{rest}"


def _definition(cls: ast.ClassDef, imports: Mapping[str, str]) -> Definition:
    return Definition(
        cls.name,
        ast.get_docstring(cls),
        tuple(_base(base, imports) for base in cls.bases),
        _literals(_assignments(cls)),
        {name: list(_declared_defaults(cls, name)) for name in ("_builder", "_products")},
    )


def _assignments(definition: ast.ClassDef) -> Iterator[tuple[str, ast.expr]]:
    for statement in definition.body:
        if isinstance(statement, ast.Assign):
            for target in statement.targets:
                if isinstance(target, ast.Name):
                    yield target.id, statement.value
        elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name) and statement.value:
            yield statement.target.id, statement.value


def _literals(values: Iterator[tuple[str, ast.expr]]) -> dict[str, Value]:
    literals = {}
    for name, value in values:
        try:
            literals[name] = ast.literal_eval(value)
        except (ValueError, TypeError):
            continue
    return literals


def _declared_defaults(cls: ast.ClassDef, attribute: str) -> Iterator[dict[str, Value]]:
    for name, value in _assignments(cls):
        if name == attribute:
            calls = value.elts if isinstance(value, (ast.Tuple, ast.List)) else [value]
            yield from (_arguments(call) for call in calls if isinstance(call, ast.Call))


def _arguments(call: ast.Call) -> dict[str, Value]:
    function = call.func.id if isinstance(call.func, ast.Name) else ""
    # the first argument without a keyword: the name of a product, the model of a robot
    first = "model" if function == "RobotDefaults" else "name"
    arguments = [(first, value) for value in call.args[:1]]
    arguments += [(keyword.arg, keyword.value) for keyword in call.keywords if keyword.arg is not None]
    return _literals(iter(arguments))
