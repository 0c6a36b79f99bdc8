"""Validates messages and stores them in the data of a component."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from morse.core.declarations import fields_of_component
from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown
from morse.core.validation.errors import CommandError
from morse.core.validation.fields import spec_of_field
from morse.core.validation.plain import check_plain, size_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.interfaces import Component
    from morse.core.values import Fields, Value

#: largest number of undeclared fields that a component keeps
_MOST_EXTRA = 64
_LONGEST_NAME = 100
#: largest number of fields of a message: to check more of them takes longer than a tick
_MOST_FIELDS = 4096
_MOST_BYTES = 1 << 20


class Commands:
    """Validates commands for a component and stores them in its ``local_data``.

    A declared field accepts the values of its declaration. Without a declaration, a field accepts values like its
    present value: a number, a boolean, a string, a list (of at least as many numbers), a dictionary. A field without a
    value, or with a value of another type, accepts anything.

    Args:
        component: the component whose ``local_data`` receives the messages.
    """

    def __init__(self, component: Component) -> None:
        self._component = component
        fields = fields_of_component(component)
        self._checks: dict[str, Callable[[Value], object]] = {
            name: spec_of_field(fields.get(name), value).check() for name, value in component.local_data.items()
        }
        self._extra: dict[str, int] = {}
        self._is_full = False

    def fitting(self, message: object) -> Fields:
        """Return the fields of a message as they would be stored; undeclared fields are refused.

        Raises:
            CommandError: the message is not a dictionary, a value is not valid, or the component has no such field.
        """
        fields, unknown = self.checked(message)
        if unknown:
            self._refuse(unknown)
        return fields

    def take(self, message: object) -> str | None:
        """Store the fields of a message; other fields stay unchanged.

        Returns:
            A message for the user about undeclared fields, once for each field, else None.

        Raises:
            CommandError: the message is not a dictionary, or a value is not valid, or the simulation is strict and the
                component does not declare a field. Then nothing has changed.
        """
        fields, unknown = self.checked(message)
        remark = self._take_unknown(unknown) if unknown else None
        self._component.local_data.update(fields)
        return remark

    def checked(self, message: object) -> tuple[Fields, Fields]:
        """Return the fields of a message as they would be stored, and the undeclared fields.

        Raises:
            CommandError: the message is not a dictionary, or a value is not valid.
        """
        if not isinstance(message, dict):
            fields = ", ".join(self._checks) or "its fields"
            raise CommandError("", f"expected a JSON object with some of {fields}, got {shown(message)}")
        if len(message) > _MOST_FIELDS:
            raise CommandError("", f"a message has at most {_MOST_FIELDS} fields, got {len(message)}")
        accepted: Fields = {}
        unknown: Fields = {}
        checks = self._checks
        for name, value in message.items():
            check = checks.get(name)
            if check is None:
                unknown[name] = value
                continue
            try:
                accepted[name] = check(value)
            except ValueError as error:
                raise CommandError(name, f"'{name}' is {shown(value)}, expected {error}") from None
        return accepted, unknown

    def _refuse(self, unknown: Fields) -> NoReturn:
        name = next(iter(unknown))
        raise CommandError(shown(name), self._remark(name))

    def _take_unknown(self, unknown: Fields) -> str | None:
        if self._component.context.strict:
            self._refuse(unknown)
        values, remarks = {}, []
        for name, value in unknown.items():
            size = self._size(name, value)
            new = name not in self._extra
            if new and len(self._extra) >= _MOST_EXTRA:
                continue
            if sum(self._extra.values()) - self._extra.get(name, 0) + size > _MOST_BYTES:
                if not self._is_full:  # logged once, because each message may have such a field
                    remarks.append(f"the field {shown(name)}, which it does not declare, is too large and left out")
                self._is_full = True
                continue
            if new:
                remarks.append(self._remark(name))
            self._extra[name] = size
            values[name] = value
        self._component.local_data.update(values)
        return "; ".join(remarks) or None

    def _size(self, name: object, value: object) -> int:
        if not isinstance(name, str) or len(name) > _LONGEST_NAME:
            raise CommandError(
                shown(name), f"{shown(name)} is not the name of a field: expected a string of up to {_LONGEST_NAME}"
            )
        try:
            check_plain(name)
            check_plain(value)
        except ValueError as error:
            raise CommandError(shown(name), f"{shown(name)} is {shown(value)}, expected {error}") from None
        return len(name) + size_of(value)

    def _remark(self, name: object) -> str:
        return f"it declares no field {shown(name)}{nearest(name, self._checks)}"
