"""Writes the stubs of `morse.builder`: declarations of the derived classes for editors and type checkers.

Usage: python -m tools stubs
"""

from __future__ import annotations

import inspect
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import morse.builder
from morse.builder import actuators, robots, sensors
from morse.builder.names.catalog import load_class
from morse.core import declarations

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

FOLDER = Path(__file__).resolve().parents[2] / "src" / "morse" / "builder"
HEADER = "# Written by `python -m tools` from what the components declare: do not edit.\n"

#: types of declarations; properties of other types accept any value
TYPES = {
    "bool": "bool",
    "boolean": "bool",
    "double": "float",
    "float": "float",
    "int": "int",
    "integer": "int",
    "str": "str",
    "string": "str",
}


def stubs() -> dict[str, str]:
    """Contents of the files below `FOLDER`, by name."""
    texts = {f"{module.__name__.rpartition('.')[2]}.pyi": derived(module) for module in (sensors, actuators, robots)}
    texts["__init__.pyi"] = star_import()
    return {name: formatted(text, name) for name, text in texts.items()}


def formatted(text: str, name: str) -> str:
    """A text as formatted by ruff."""
    command = [sys.executable, "-m", "ruff", "format", "--stdin-filename", str(FOLDER / name), "-"]
    return subprocess.run(command, input=text, capture_output=True, encoding="utf-8", check=True).stdout


def derived(module: ModuleType) -> str:
    """The stub of a module of builder classes."""
    members = {name: getattr(module, name) for name in module.__all__}
    own = {name: cls for name, cls in members.items() if cls.__module__ == module.__name__}
    bases = {base for cls in own.values() for base in cls.__bases__}
    others = {cls.__name__: cls for cls in (*members.values(), *bases) if cls not in own.values()}
    bodies = [line for name, cls in own.items() for line in ("", *class_lines(name, cls))]
    typing = "Any, Literal" if any("Literal[" in line for line in bodies) else "Any"
    lines = [HEADER, f"from typing import {typing}", *sorted(imported(name, cls) for name, cls in others.items())]
    lines += [f"__all__ = {sorted(members)!r}"]
    return "\n".join(lines + bodies) + "\n"


def imported(name: str, cls: type) -> str:
    """The line that imports and re-exports a class."""
    return f"from {cls.__module__} import {name} as {name}"


def class_lines(name: str, cls: type[Any]) -> Iterator[str]:
    """The stub of a class."""
    yield f"class {name}({', '.join(base.__name__ for base in cls.__bases__)}):"
    yield f"    {docstring(cls)}"
    known = declarations.properties(load_class(cls._classpath)).values()
    given = [f"{prop.name}: {type_of(prop)} = ..." for prop in known if prop.name.isidentifier()]
    if given:
        yield f"    def properties(self, *, {', '.join(given)}, **kwargs: Any) -> None: ..."


def type_of(prop: declarations.Property) -> str:
    """The annotation of a property."""
    if prop.choices:
        return f"Literal[{', '.join(map(repr, prop.choices))}]"
    return TYPES.get(prop.type, "Any")


def docstring(cls: type) -> str:
    """The documentation of a class as a literal."""
    text = (inspect.getdoc(cls) or cls.__name__).replace("\\", "\\\\").replace('"""', "'''")
    return f'"""{text}"""'.replace("\n", "\n    ")


def star_import() -> str:
    """The stub of the package: every name that ``from morse.builder import *`` provides."""
    lines, variables, classes = [], [], []
    for name in morse.builder.__all__:
        value = getattr(morse.builder, name)
        if inspect.ismodule(value):
            parent, _, last = value.__name__.rpartition(".")
            known = {"posixpath": "os.path"}.get(value.__name__, value.__name__)
            lines.append(f"from {parent} import {last} as {name}" if parent else f"import {known} as {name}")
        elif inspect.isclass(value) and value.__module__ == morse.builder.__name__:
            # of a plug-in
            classes += ["", *class_lines(name, value)]
            lines += [imported(base.__name__, base) for base in value.__bases__]
        elif inspect.isclass(value):
            lines.append(imported(name, value))
        else:
            variables.append(f"{name}: {type(value).__module__}.{type(value).__name__}")
    # modules that scripts may also use as attributes of the package
    lines += [f"from morse.builder import {name} as {name}" for name in ("actuators", "robots", "sensors")]
    body = [*variables, *classes]
    names = [name for name in ("Any", "Literal") if any(f" {name}" in line for line in body)]
    if names:
        lines.append(f"from typing import {', '.join(names)}")
    return "\n".join([HEADER, *sorted(set(lines)), f"__all__ = {sorted(morse.builder.__all__)!r}", *body]) + "\n"


def main() -> None:
    """Write the files."""
    for file, stub in stubs().items():
        (FOLDER / file).write_text(stub, encoding="utf-8", newline="\n")
        print(FOLDER / file)
