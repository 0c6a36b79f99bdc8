"""Validation of the values of properties."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import properties
from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown
from morse.core.validation.errors import PropertyError
from morse.core.validation.fields import spec_of_property

if TYPE_CHECKING:
    from morse.core.declarations import Property
    from morse.core.interfaces import Component
    from morse.core.values import Value


def checked_value(owner: str, prop: Property, value: object, *, script: bool = False) -> object:
    """The value of a property as it is to be stored.

    Args:
        owner: owner of the property, for messages.
        script: whether the property is set in the scene script.

    Raises:
        PropertyError: the message contains the property, the value and the expected value.
    """
    try:
        return spec_of_property(prop, script=script).check()(value)
    except ValueError as error:
        raise PropertyError(f"property '{prop.name}' of {owner} is {shown(value)}, expected {error}") from None


def checked_property(component: Component, name: object, value: object) -> tuple[str, Value]:
    """The name of a property in Python, and the value as it is to be stored.

    Raises:
        PropertyError: the property does not exist, or the value is not valid.
    """
    by_name = {prop.name: (python_name, prop) for python_name, prop in properties(type(component)).items()}
    if not isinstance(name, str) or name not in by_name:
        raise PropertyError(f"{component.name()} has no property {shown(name)}{nearest(name, sorted(by_name))}")
    python_name, prop = by_name[name]
    return python_name, checked_value(component.name(), prop, value)
