"""Which components and modifiers MORSE has, read from their files without running them.

A scene that uses three sensors should not wait until forty are loaded, nor fail because one of
those is broken. A class counts if its body sets ``_name`` (components) or ``_names`` (modifiers).
"""

from __future__ import annotations

import ast
import pkgutil
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True, slots=True)
class Entry:
    """A class of the catalogue.

    Attributes:
        name: as scene scripts know it.
        classpath: where it is.
        doc: one sentence on what it is.
        attributes: the class attributes whose values are plain literals.
    """

    name: str
    classpath: str
    doc: str
    attributes: dict[str, Any]


@cache
def components(package: str) -> dict[str, Entry]:
    """The components of ``morse.sensors``, ``morse.actuators`` or ``morse.robots`` by name, sorted."""
    found = {}
    for module, definition in _classes(package):
        attributes = _literals(definition)
        if isinstance(attributes.get("_name"), str):
            name = _builder_name(definition) or definition.name
            doc = attributes.get("_short_desc") or ast.get_docstring(definition) or attributes["_name"]
            found[name] = Entry(name, f"{module}.{definition.name}", str(doc).strip(), attributes)
    return dict(sorted(found.items()))


@cache
def modifiers() -> tuple[Entry, ...]:
    """The modifiers of ``morse.modifiers``."""
    return tuple(
        Entry(definition.name, f"{module}.{definition.name}", ast.get_docstring(definition) or "", attributes)
        for module, definition in _classes("morse.modifiers")
        if "_names" in (attributes := _literals(definition))
    )


def _classes(package: str) -> Iterator[tuple[str, ast.ClassDef]]:
    spec = find_spec(package)
    for info in pkgutil.iter_modules(spec.submodule_search_locations if spec else ()):
        if info.ispkg or info.name.startswith("_"):
            continue
        finder = info.module_finder
        module = finder.find_spec(f"{package}.{info.name}", None)
        if module is None or module.origin is None:
            continue
        tree = ast.parse(Path(module.origin).read_text(encoding="utf-8"), module.origin)
        for statement in tree.body:
            if isinstance(statement, ast.ClassDef) and not statement.name.startswith("_"):
                yield f"{package}.{info.name}", statement


def _assignments(definition: ast.ClassDef) -> Iterator[tuple[str, ast.expr]]:
    for statement in definition.body:
        if isinstance(statement, ast.Assign):
            for target in statement.targets:
                if isinstance(target, ast.Name):
                    yield target.id, statement.value
        elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name) and statement.value:
            yield statement.target.id, statement.value


def _literals(definition: ast.ClassDef) -> dict[str, Any]:
    literals = {}
    for name, value in _assignments(definition):
        try:
            literals[name] = ast.literal_eval(value)
        except (ValueError, TypeError):
            continue
    return literals


def _builder_name(definition: ast.ClassDef) -> str | None:
    """The first argument, or the argument ``name``, of ``_builder = BuilderDefaults(...)``."""
    for attribute, value in _assignments(definition):
        if attribute == "_builder" and isinstance(value, ast.Call):
            names = [*value.args[:1], *(k.value for k in value.keywords if k.arg == "name")]
            for name in names:
                if isinstance(name, ast.Constant) and isinstance(name.value, str):
                    return name.value
    return None
