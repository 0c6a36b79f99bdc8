"""Finds methods of components that user code hides by accident, such as ``self.name = "left"``, or that run nothing."""

from __future__ import annotations

import inspect
from types import FunctionType
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.clock import Clock
from morse.core.context import Context
from morse.core.robot import Robot
from morse.core.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.interfaces import Component


#: without these methods and attributes no component works; MORSE 1.4 had the same
_ESSENTIAL = ("action", "clock", "completed", "context", "default_action", "interrupt", "name")
#: names of the methods that every component has
_METHODS = frozenset(
    name
    for base in (Sensor, Actuator, Robot)
    for cls in base.__mro__
    if cls is not object
    for name, value in vars(cls).items()
    if isinstance(value, FunctionType) and not name.startswith("__")
)
#: attributes that the simulation itself uses, and their types
_ATTRIBUTES = {"clock": Clock, "context": Context}


def hidden_methods(component: object) -> list[tuple[str, bool]]:
    """Return a line for each attribute that hides a method of all components.

    Args:
        component: a component; the classes of MORSE itself are not examined.

    Returns:
        The lines, and whether the component cannot work without the method. The others have been added since MORSE 1.4,
        so that older components may use their names.
    """
    cls = type(component)
    names = []
    for name, value in _hidden(component):
        what = f"{name}() is a method of all components" if name in _METHODS else f"the simulation needs .{name}"
        text = (
            f"{cls.__name__} has the attribute {name!r} ({type(value).__name__}), but {what}: rename it, e.g. my_{name}"
        )
        names.append((text, name in _ESSENTIAL))
    return names


def lazy_methods(component: Component) -> list[tuple[str, bool]]:
    """Return a line for each method whose call runs nothing of it, because it is a generator or a coroutine.

    Args:
        component: a component; the classes of MORSE itself are not examined.

    Returns:
        The lines, and whether the method is a service or one without which no component works.
    """
    lines = []
    for base in type(component).__mro__:
        if base.__module__.startswith("morse."):
            break
        for name, value in vars(base).items():
            is_service = hasattr(value, "_morse_service")
            function = inspect.unwrap(getattr(value, "__func__", value))
            reason = laziness(function) if is_service or name in _METHODS else ""
            if reason:
                text = (
                    f"{base.__name__}.{name} {reason}: a call of it runs nothing. A component does a part of its work "
                    "in each call of default_action, and returns"
                )
                lines.append((text, is_service or name in _ESSENTIAL))
    return lines


def laziness(function: object) -> str:
    """Return why a call of a function runs nothing of it; empty if it runs."""
    if inspect.iscoroutinefunction(function) or inspect.isasyncgenfunction(function):
        return "is declared by 'async def'"
    return "contains 'yield'" if inspect.isgeneratorfunction(function) else ""


def uncover(component: object) -> list[str]:
    """Remove attributes that hide methods without which a running component does not work; return a line for each."""
    lines = [text for text, is_essential in hidden_methods(component) if is_essential]
    for name in _ESSENTIAL:
        if lines and name in _METHODS and not callable(vars(component).get(name, len)):
            del vars(component)[name]
    return lines


def _hidden(component: object) -> Iterator[tuple[str, object]]:
    own = vars(component)
    names_so_far = set()
    for base in type(component).__mro__:
        if base.__module__.startswith("morse."):
            break
        for name in sorted(vars(base).keys() & _METHODS):
            value = vars(base)[name]
            if name not in own and name not in names_so_far and not (callable(value) or hasattr(value, "__func__")):
                yield name, value
            names_so_far.add(name)
    for name in sorted(own.keys() & _METHODS):
        if not callable(own[name]):
            yield name, own[name]
    for name, kind in _ATTRIBUTES.items():
        if not isinstance(own.get(name), kind):
            yield name, own.get(name)
