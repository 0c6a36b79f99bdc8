"""Reads class definitions from files without executing them."""

from __future__ import annotations

import ast
import pkgutil
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator


def classes(package: str) -> Iterator[tuple[str, ast.ClassDef]]:
    """The public classes in the files of a package, with the names of their modules.

    Raises:
        SyntaxError: in one of the files.
    """
    for module, file in files(package):
        for definition in classes_of(file):
            yield module, definition


def files(package: str) -> Iterator[tuple[str, Path]]:
    """The public modules of a package and their files; none if there is no such package."""
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


def classes_of(file: Path) -> Iterator[ast.ClassDef]:
    """The public classes of a file.

    Raises:
        SyntaxError: in the file.
    """
    tree = ast.parse(file.read_bytes(), str(file))
    for statement in tree.body:
        if isinstance(statement, ast.ClassDef) and not statement.name.startswith("_"):
            yield statement


def _assignments(definition: ast.ClassDef) -> Iterator[tuple[str, ast.expr]]:
    for statement in definition.body:
        if isinstance(statement, ast.Assign):
            for target in statement.targets:
                if isinstance(target, ast.Name):
                    yield target.id, statement.value
        elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name) and statement.value:
            yield statement.target.id, statement.value


def literals(definition: ast.ClassDef) -> dict[str, Any]:
    """The attributes in the body of a class whose values are plain literals."""
    found = {}
    for name, value in _assignments(definition):
        try:
            found[name] = ast.literal_eval(value)
        except (ValueError, TypeError):
            continue
    return found


def declared_defaults(definition: ast.ClassDef, attribute: str) -> Iterator[dict[str, Any]]:
    """The literal arguments of each call of ``..Defaults(...)`` that is assigned to an attribute of a class."""
    for name, value in _assignments(definition):
        if name == attribute:
            calls = value.elts if isinstance(value, (ast.Tuple, ast.List)) else [value]
            yield from (_arguments(call) for call in calls if isinstance(call, ast.Call))


def _arguments(call: ast.Call) -> dict[str, Any]:
    function = call.func.id if isinstance(call.func, ast.Name) else ""
    # the first argument without a keyword: the name of a product, the model of a robot
    first = "model" if function == "RobotDefaults" else "name"
    given = [(first, value) for value in call.args[:1]]
    given += [(keyword.arg, keyword.value) for keyword in call.keywords if keyword.arg is not None]
    arguments = {}
    for name, value in given:
        try:
            arguments[name] = ast.literal_eval(value)
        except (ValueError, TypeError):
            continue
    return arguments
