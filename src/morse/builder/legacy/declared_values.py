"""Values of properties and options in the forms of MORSE 1.4: texts for numbers and truth values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder.legacy import values
from morse.core.validation.fields import spec_of_option, spec_of_property

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option, Property
    from morse.core.validation.spec import Spec
    from morse.core.values import Options, Properties, Value


def properties(owner: str, declarations: Mapping[str, Property], parameters: Mapping[str, object]) -> Properties:
    """Return the properties of a component, with numbers and truth values instead of the texts for them."""
    return {
        name: _value(spec_of_property(declarations[name], script=True), value, f"the property '{name}' of {owner}")
        if name in declarations
        else value
        for name, value in parameters.items()
    }


def options(owner: str, declarations: Mapping[str, Option], parameters: Mapping[str, object]) -> Options:
    """Return the options of a modifier, with numbers and truth values instead of the texts for them."""
    return {
        name: _option(declarations[name], value, f"the option '{name}' of {owner}") if name in declarations else value
        for name, value in parameters.items()
    }


def _option(option: Option, value: object, what: str) -> object:
    if not isinstance(option.type, tuple):
        return _value(spec_of_option(option), value, what)
    if float not in option.type or str in option.type:
        return value
    # a number for each axis
    if isinstance(value, dict) and dict in option.type:
        return {axis: _number(part, f"{what} ({axis})") for axis, part in value.items()}
    return _number(value, what)


def _number(value: object, what: str) -> object:
    return values.number(value, what) if isinstance(value, str) else value


def _value(spec: Spec, value: object, what: str) -> Value:
    if not isinstance(value, str):
        return value
    if spec.kind in ("number", "integer"):
        return values.number(value, what)
    return values.boolean(value, what) if spec.kind == "boolean" else value
