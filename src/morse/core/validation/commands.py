"""Validates messages and stores them in the data of a component."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, NoReturn

from morse.core.clients.complaints import Complaints
from morse.core.declarations import fields_of_component
from morse.core.reports.quoting import nearest, shown
from morse.core.validation.fields import spec_of_field
from morse.core.validation.spec import CommandError, check_plain, size_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.clients.budgets import Sender
    from morse.core.interfaces import Component
    from morse.core.values import Fields


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
        self._checks: dict[str, Callable[[object], object]] = {
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


#: number of letters of a message in the log
_SHOWN = 80
#: number of fields of clients that are known to be refused at present
_MOST_REFUSED = 256


class ClientCommands:
    """The commands of the clients of a stream.

    Args:
        component: their target.
        logger: of the middleware.
        what: what the middleware calls a message.

    Attributes:
        complaints: the log of refused messages.
    """

    def __init__(self, component: Component, logger: logging.Logger, what: str = "message") -> None:
        self._component, self._logger, self._what = component, logger, what
        self._commands = Commands(component)
        self.complaints = Complaints(logger)
        self._sender: Sender = component.context.arrivals.sender()
        #: the clients and fields whose last value was refused
        self._refused: set[tuple[str, str]] = set()

    @property
    def rest(self) -> bool:
        """Whether messages have to wait, because earlier ones took more than their share of the time."""
        return self._sender.until is not None and self._sender.rests

    def take(self, decode: Callable[[object], object], message: object) -> bool:
        """Write the fields of a message into the data of the component; whether that was possible.

        If the simulation is not paced by the wall clock, its clients wait for it, and messages never wait.

        Args:
            decode: returns the fields of the message, or None if it has none. It may be code of a user: an exception
                only refuses the message.
            message: as it has arrived; bytes may have the attribute ``client``, the address of their client.
        """
        if not self._component.context.paced():
            return self._take(decode, message)
        with self._sender.measured():
            command = self._take(decode, message)
        self._sender.rest_if_due()
        return command

    def _take(self, decode: Callable[[object], object], message: object) -> bool:
        client = getattr(message, "client", "") if isinstance(message, bytes) else ""
        try:
            fields = decode(message)
        except CommandError as error:
            self._refuse_field(client, error)
            return False
        except Exception as error:
            text = shown(message[:_SHOWN] if isinstance(message, (bytes, str)) else message)
            self._refuse(client, "read", f"this {self._what} cannot be read ({type(error).__name__}: {error}): {text}")
            return False
        if fields is None:
            return False
        try:
            remark = self._commands.take(fields)
        except CommandError as error:
            self._refuse_field(client, error)
            return False
        if self._refused and isinstance(fields, dict):
            accepted = {
                "read",
                "field ",
                *(f"field {field}" for field in self._component.local_data if field in fields),
            }
            self._refused = {(one, kind) for one, kind in self._refused if one != client or kind not in accepted}
        if remark is not None:
            self._logger.warning("%s: %s", self._component.name(), remark)
        return True

    def _refuse_field(self, client: str, error: CommandError) -> None:
        self._refuse(client, f"field {error.field}", f"a {self._what} is refused: {error}")

    def complain(self, kind: str, text: str) -> None:
        """Log a problem of a client, at most once in a while for each kind."""
        self.complaints.warn(kind, f"{self._component.name()}: {text}")

    def _refuse(self, client: str, kind: str, text: str) -> None:
        """Log a refused message: at once if the last one of this client was accepted, else once in a while."""
        begins = (client, kind) not in self._refused
        if begins and len(self._refused) < _MOST_REFUSED:
            self._refused.add((client, kind))
        is_strict = self._component.context.strict
        level, prefix = (logging.ERROR, "[ERROR][MORSE] ") if is_strict else (logging.WARNING, "")
        self.complaints.log(level, kind, f"{prefix}{self._component.name()}: {text}", begins=begins)
