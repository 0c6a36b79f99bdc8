"""Takes the messages of clients into the data of a component, after a check."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.declarations import data_fields
from morse.core.values import nearest

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.object import Object

_MAX_EXTRA = 64
_MAX_INTEGER = 2**63


class WrongMessage(ValueError):
    """A message does not fit the component.

    Attributes:
        field: which part of it, or an empty text.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(message)
        self.field = field


class Fields:
    """The fields that a component has, and what they may hold.

    What a field holds now tells what it may hold: a number, a truth value, a text, a list (of numbers,
    at least as many), a dictionary; a field that holds nothing yet, or something else, takes anything.

    Args:
        component: whose ``local_data`` messages go to.
    """

    def __init__(self, component: Object) -> None:
        self._component = component
        declared = {name: field.default for name, field in data_fields(type(component)).items()}
        # what a field holds says more than its default, which may be a text such as "initial position"
        self._checks = {
            name: _check_for(declared.get(name) if value is None else value)
            for name, value in component.local_data.items()
        }
        self._extra: set[str] = set()

    def merge(self, message: Any) -> str | None:
        """Take the fields of a message; the others stay as they are.

        Returns:
            What to tell the user of fields that the component does not have, once for each.

        Raises:
            WrongMessage: it is no dictionary, or a value does not fit; then nothing has changed.
        """
        if not isinstance(message, dict):
            raise WrongMessage("", f"expected a JSON object with some of {self._known()}, got {message!r:.80}")
        accepted = {}
        unknown = []
        for name, value in message.items():
            check = self._checks.get(name)
            if check is None:
                unknown.append(name)
                continue
            try:
                accepted[name] = check(value)
            except (ValueError, OverflowError) as error:
                raise WrongMessage(name, f"'{name}' is {value!r:.80}, expected {error}") from None
        self._component.local_data.update(accepted)
        return self._take_extra({name: message[name] for name in unknown}) if unknown else None

    def _take_extra(self, extra: dict[str, Any]) -> str | None:
        # components may read fields that they do not declare
        new = [name for name in extra if name not in self._extra][: _MAX_EXTRA - len(self._extra)]
        self._extra.update(new)
        self._component.local_data.update({name: extra[name] for name in extra if name in self._extra})
        if not new:
            return None
        return "; ".join(f"it declares no field '{name:.80}'{nearest(name, sorted(self._checks))}" for name in new)

    def _known(self) -> str:
        return ", ".join(self._checks) or "its fields"


def _check_for(default: Any) -> Callable[[Any], Any]:
    if isinstance(default, bool):
        return _truth
    if isinstance(default, float):
        return _number
    if isinstance(default, int):
        return _whole_or_real
    if isinstance(default, str):
        return _text
    if isinstance(default, dict):
        return _dictionary
    if hasattr(default, "__len__") and hasattr(default, "__iter__"):
        return _list_for(default)
    return _anything


def _anything(value: Any) -> Any:
    return value


def _number(value: Any) -> float:
    if type(value) is float and value == value:  # only NaN differs from itself
        return value
    if isinstance(value, (int, float)) and not isinstance(value, bool) and not math.isnan(value):
        return float(value)
    raise ValueError("a number")


def _whole_or_real(value: Any) -> int | float:
    if type(value) is int and -_MAX_INTEGER <= value < _MAX_INTEGER:
        return value
    if isinstance(value, float) and not math.isnan(value):
        return value
    raise ValueError("a number")


def _truth(value: Any) -> bool:
    if isinstance(value, bool) or (type(value) is int and value in (0, 1)):
        return bool(value)
    raise ValueError("true or false")


def _text(value: Any) -> str:
    if isinstance(value, str):
        return value
    raise ValueError("a text")


def _dictionary(value: Any) -> dict[Any, Any]:
    if isinstance(value, dict):
        return value
    raise ValueError("an object such as {...}")


def _list_for(default: Any) -> Callable[[Any], list[Any]]:
    length = len(default)
    numeric = length > 0 and all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in default)
    expected = f"a list of {length} numbers" if numeric and length > 1 else "a list of numbers" if numeric else "a list"

    def check(value: Any) -> list[Any]:
        if not isinstance(value, list) or (numeric and length > 1 and len(value) < length):
            raise ValueError(expected)
        if not numeric:
            return value
        try:
            return [_number(item) for item in value]
        except (ValueError, OverflowError):
            raise ValueError(expected) from None

    return check
