"""Specs that are derived from declarations."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.declarations import properties
from morse.core.reports.quoting import nearest, shown
from morse.core.validation.spec import OptionError, PropertyError, Spec

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option
    from morse.core.declarations.fields import DataField, OptionFields, Property
    from morse.core.interfaces import Component
    from morse.core.values import Fields, Value


_TYPE_KINDS: dict[object, str] = {
    float: "number", int: "integer", bool: "boolean", str: "string", list: "list", tuple: "list", dict: "dict",
}  # fmt: skip
_WORDS = {
    "float": "number", "double": "number", "int": "integer", "integer": "integer", "bool": "boolean",
    "boolean": "boolean", "string": "string", "str": "string",
}  # fmt: skip


def spec_of_field(field: DataField | None, value: object) -> Spec:
    """Return the spec of a data field: as declared, or derived from its value if it is not declared.

    Args:
        field: its declaration, or None if the component added the field without a declaration.
        value: value of the field before the first command. The declared default may be only a string such as "initial
            position".
    """
    default = value if value is not None or field is None else field.default
    if field is None:
        return _like(default)._replace(allow=_occurring(default))
    allow = frozenset(field.allow) | _occurring(default)
    like = _like(default) if field.shape is None else Spec("list", field.shape, dtype=field.dtype)
    return like._replace(allow=allow, low=field.low, high=field.high, unit=field.unit)


def spec_of_property(prop: Property, *, script: bool = False) -> Spec:
    """Return the spec of a property.

    Args:
        script: whether the property is set in the scene script, which may set infinity if no range is declared.
    """
    default = prop.default
    allow = frozenset(prop.allow) | _occurring(default)
    has_bounds = prop.low is not None or prop.high is not None
    if script and not has_bounds:
        allow |= {"inf", "-inf"}
    if default is None and (has_bounds or prop.choices):
        like = Spec(_WORDS.get(prop.type, "number" if has_bounds else "any"))
    else:
        like = _like(default)
    if like.kind == "number" and _WORDS.get(prop.type) == "integer":
        like = Spec("integer")
    return like._replace(low=prop.low, high=prop.high, choices=prop.choices, unit=prop.unit, allow=allow)


def spec_of_option(option: OptionFields) -> Spec:
    """Return the spec of an option of a script; an option with several types accepts any value of these types."""
    kind = _TYPE_KINDS.get(option.type, "any") if option.shape is None else "list"
    allow = frozenset(option.allow) | _occurring(option.default)
    return Spec(
        kind, option.shape, low=option.low, high=option.high, choices=option.choices, unit=option.unit, allow=allow
    )


def _like(default: object) -> Spec:
    if isinstance(default, bool):
        return Spec("boolean")
    if isinstance(default, (int, float)):
        return Spec("number", whole=isinstance(default, int))
    if isinstance(default, str):
        return Spec("string")
    if isinstance(default, dict):
        return Spec("dict")
    if hasattr(default, "__len__") and hasattr(default, "__iter__"):
        flat = [isinstance(item, (int, float)) and not isinstance(item, bool) for item in default]
        return Spec("list", least=len(flat) if all(flat) else 0)
    return Spec("any")


def _occurring(default: object) -> frozenset[str]:
    """Return the special values in a default, which are always accepted."""
    if default is None:
        return frozenset({"none"})
    if isinstance(default, float) and not math.isfinite(default):
        return frozenset({str(float(default))})
    return frozenset()


def checked_options(owner: str, declarations: Mapping[str, Option], values: Mapping[str, object]) -> Fields:
    """Return the given options as they are to be stored.

    Args:
        owner: owner of the options, for messages.
        declarations: declared options by name.
        values: values by name.

    Raises:
        OptionError: the message contains the option and the expected value, or the nearest name.
    """
    result = {}
    for name, value in values.items():
        option = declarations.get(name)
        if option is None:
            raise OptionError(f"{owner} has no option {shown(name)}{nearest(name, declarations)}")
        result[name] = _checked(owner, name, option, value)
    return result


def _checked(owner: str, name: str, option: Option, value: object) -> Value:
    try:
        if isinstance(option.type, tuple) and not isinstance(value, option.type):
            raise ValueError(" or ".join(one.__name__ for one in option.type))
        return spec_of_option(option).check()(value)
    except ValueError as error:
        raise OptionError(f"option '{name}' of {owner} is {shown(value)}, expected {error}") from None


def with_defaults(declarations: Mapping[str, Option], values: Mapping[str, object]) -> Fields:
    """Return all options: the given values, and the defaults of the others."""
    return {name: values.get(name, option.default) for name, option in declarations.items()}


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


def check_settable(owner: str, prop: Property) -> None:
    """Raise an error for a property that only its class of scripts writes.

    Args:
        owner: owner of the property, for messages.

    Raises:
        PropertyError: the message contains what writes it.
    """
    if prop.written_by:
        raise PropertyError(f"property '{prop.name}' of {owner} is written by {prop.written_by} of the script alone")


def checked_property(component: Component, name: object, value: object) -> tuple[str, object]:
    """The name of a property in Python, and the value as it is to be stored.

    Raises:
        PropertyError: the property does not exist, or the value is not valid.
    """
    by_name = {prop.name: (python_name, prop) for python_name, prop in properties(type(component)).items()}
    if not isinstance(name, str) or name not in by_name:
        raise PropertyError(f"{component.name()} has no property {shown(name)}{nearest(name, sorted(by_name))}")
    python_name, prop = by_name[name]
    check_settable(component.name(), prop)
    return python_name, checked_value(component.name(), prop, value)
