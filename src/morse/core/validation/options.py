"""Validation of the options that a script passes to modifiers, streams and middlewares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown
from morse.core.validation.errors import OptionError
from morse.core.validation.fields import spec_of_option

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.declarations import Option
    from morse.core.values import Fields, Value


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
