"""Writes a module with the types of a running simulation, for editors and type checkers."""

from __future__ import annotations

import contextlib
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

from pymorse.errors import MorseServiceError, MorseTimeoutError
from pymorse.stream import TIMEOUT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pymorse.component import Component
    from pymorse.pymorse import Morse

_HEAD = '''"""The types of a simulation; written by `python -m pymorse`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypedDict

from pymorse import Morse

if TYPE_CHECKING:
    from collections.abc import Callable

    from pymorse import Component, MorseFuture
    from pymorse import Robot as AnyRobot
'''
_READING = """    def get(self, timeout: float | None = None) -> {data} | None: ...
    def last(self, n: int = 1) -> {data} | None: ...
    def subscribe(self, callback: Callable[[{data}], object], latest: bool = False) -> None: ...
    def unsubscribe(self, callback: Callable[[{data}], object]) -> None: ...
"""
_SIMULATION = '''

class Simulation(Morse):
    """This simulation."""

    if TYPE_CHECKING:'''
_END = ""
_DEEPEST = 8
_NAMES = {bool: "bool", int: "int", float: "float", str: "str", type(None): "Any"}


def stubs(morse: Morse) -> str:
    """Return the text of a module with a class ``Simulation``."""
    classes = [line for name in filter(_is_attribute, morse.robots) for line in _classes(morse[name])]
    lines = [_HEAD, *("    " + line if line else "" for line in "\n".join(classes).splitlines())]
    names = [f"        {name}: {_class_name(morse[name])}" for name in morse.robots if _is_attribute(name)]
    return "\n".join([*lines, _SIMULATION, *(names or ["        pass"]), _END])


def _is_attribute(name: str) -> bool:
    """Whether a name that a server sent can be an attribute; any other text could be a statement of the module."""
    return name.isidentifier() and not iskeyword(name)


def _class_name(component: Component) -> str:
    # a robot may be called robot, or simulation
    words = (component.fqn if "." in component.fqn else f"{component.fqn}.robot").replace(".", "_").split("_")
    name = "".join(word[:1].upper() + word[1:] for word in words)
    return "".join(letter if f"_{letter}".isidentifier() else "_" for letter in f"_{name}"[not name[:1].isdigit() :])


def _classes(component: Component) -> Iterator[str]:
    """The classes of a component and of its parts, the innermost first."""
    parts = {attribute: part for attribute, part in component._parts.items() if _is_attribute(attribute)}
    for part in parts.values():
        yield from _classes(part)
    name, data, fields = _class_name(component), f"{_class_name(component)}Data", _fields(component)
    if component._directions:
        entries = ", ".join(f"{field!r}: {_type_of(value)!r}" for field, value in fields.items())
        # only sensors tell their fields
        of_type = f"TypedDict({data!r}, {{{entries}}}, total=False)" if fields else "dict[str, Any]"
        yield f"\n\n{data} = {of_type}"
    base = "AnyRobot" if not component.fqn.count(".") else "Component"
    body = [f"    {attribute}: {_class_name(part)}" for attribute, part in parts.items()]
    if "OUT" in component._directions:
        body.append(_READING.format(data=data).rstrip())
    if "IN" in component._directions:
        body.append(f"    def publish(self, msg: {data}) -> None: ...")
    services = filter(_is_attribute, component._services)
    body += [f"    def {service}(self, *args: Any) -> MorseFuture: ..." for service in services]
    yield "\n".join([f"\n\nclass {name}({base}):", *(body or ["    pass"])])


def _fields(component: Component) -> dict[str, Any]:
    with contextlib.suppress(MorseServiceError, MorseTimeoutError, KeyError):
        fields = component._morse.rpc_t(TIMEOUT, component.fqn, component._services["get_local_data"])
        if isinstance(fields, dict):
            return {name: value for name, value in fields.items() if isinstance(name, str)}
    return {}


def _type_of(value: object, depth: int = 0) -> str:
    if isinstance(value, list):
        kinds = {_type_of(item, depth + 1) for item in value[:100]} if depth < _DEEPEST else set()
        return f"list[{kinds.pop() if len(kinds) == 1 else 'Any'}]"
    return "dict[str, Any]" if isinstance(value, dict) else _NAMES.get(type(value), "Any")
