"""The stream of the contract of middlewares: it carries messages, and the methods of its manager give them a form."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from morse.core.clients.complaints import Complaints, Waiting
from morse.core.datastream import AbstractDatastream
from morse.core.kinds.binding import BoundKind, bind, general_kind
from morse.core.kinds.table import GENERAL
from morse.core.mapping import IN
from morse.core.validation import ClientCommands

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from morse.core.kinds import Message
    from morse.core.object import Object
    from morse.core.values import Fields

    #: returns the payload of a message of a stream
    Form = Callable[[object, Message], object]

#: largest number of messages that are queued for the next action of an actuator
_MOST_WAITING = 64


class _Slots(NamedTuple):
    """A command by slots of a kind."""

    kind: BoundKind
    values: Mapping[str, Any]
    frame: str


class KindStream(AbstractDatastream):
    """Sends the messages of a component in the form of its manager, or passes what has arrived to the component.

    A message is created if `DatastreamManager.wanted` returns True. The method of the manager for its kind
    (`morse.core.mapping.maps`) returns a payload, and `DatastreamManager.send` sends it. What arrives is queued by
    `receive` until the actuator acts; then a method of the manager reads it, and the values are validated.

    A subclass with ``encode()`` or ``decode(data)``, as in MORSE 1.4, has a form of its own: these methods return the
    payload, or the fields of a message.

    Attributes:
        kinds: the message kinds that the component sends or receives.
        complaints: the log of what clients do wrong.
    """

    #: whether it sends each kind by itself, instead of one message with all fields
    sends_kinds: bool = True
    #: what the middleware calls a message, in the log
    what: ClassVar[str] = "message"
    encode: Callable[[], Any] | None = None
    decode: Callable[[Any], Any] | None = None
    _commands: ClientCommands | None = None

    def initialize(self) -> None:
        """Find the message kinds of the component, and the method of the manager for each."""
        logger = logging.getLogger(type(self).__module__)
        self.kinds: tuple[BoundKind, ...] = self.find_kinds()
        self.sends_kinds = not self.manager.by_component
        if self.direction == IN:
            self._commands = ClientCommands(self.component_instance, logger, self.what)
            self.complaints = self._commands.complaints
            self._queue: Waiting[object] = Waiting(_MOST_WAITING, self.complaints, self.component_name, "commands")
        else:
            self.complaints = Complaints(logger)
            self._forms = tuple(self._find_forms())

    def find_kinds(self) -> tuple[BoundKind, ...]:
        """Return the message kinds of the component that the stream carries."""
        kinds = bind(self.component_instance)
        if not self.manager.by_component:
            return kinds
        return (next((one for one in kinds if not one.topic), None) or general_kind(self.component_instance),)

    def _find_forms(self) -> Iterator[tuple[BoundKind, Form]]:
        """Iterate over the kinds that are sent, and what returns their payloads."""
        encode = self.own_form()
        if encode is not None:
            yield self.kinds[0], lambda stream, message: encode()
            return
        for entry in self.kinds:
            form = self.manager.mapping(entry.kind.name)
            if form is not None:
                yield entry, form

    def own_form(self) -> Callable[[], object] | None:
        """Return the method of a class with a form of its own; None if the manager gives messages their form."""
        return self.encode

    def default(self, ci: Object | None = None) -> bool:
        """Publish the messages; or read what has arrived and return True if there was a command."""
        if self._commands is None:
            manager = self.manager
            for entry, form in self._forms:
                if manager.wanted(self, entry.topic) and not (entry.is_picture and entry.is_silent):
                    payload = form(self, entry.gather())
                    if payload is not None:
                        manager.send(self, payload)
            return False
        is_commanded = False
        for data in self.arrived():
            is_commanded = self._commands.take(self._read, data) or is_commanded
        return is_commanded

    @property
    def rests(self) -> bool:
        """Whether what arrives has to wait, because it took more than its share of the time."""
        return self._commands is not None and self._commands.rest

    # -- commands ----------------------------------------------------------------------------

    def receive(self, data: Any, slots: Mapping[str, Any] | None = None, frame: str = "") -> None:
        """Queue what has arrived for the next action of the component; may be called from any thread.

        Args:
            data: what a method of the manager with ``direction="IN"`` reads; without such a method, values by field
                name. Or one of `kinds`, whose ``slots`` follow.
            slots: values by slot name of that kind.
            frame: frame of the first slot; empty for the frame of the fields.
        """
        self._queue.append(data if slots is None else _Slots(data, slots, frame))

    def arrived(self) -> Iterable[Any]:
        """Remove what has arrived since the last action from the queue, and return it, the oldest first.

        While the stream `rests`, everything stays in the queue.
        """
        queue = self._queue
        return [queue.popleft() for _ in range(len(queue))] if queue and not self.rests else ()

    def _read(self, data: Any) -> Fields | None:
        """Return the fields that a command sets; None if it is none for this component."""
        if type(data) is _Slots:
            return self._scattered(*data)
        decode = self.decode
        if decode is not None:
            return decode(data)  # type: ignore[no-any-return] # validated like all fields
        general = self.manager.mapping(GENERAL, IN)
        if general is None:
            return data  # type: ignore[no-any-return] # validated like all fields
        commands = []
        for entry in self.kinds:
            form = self.manager.mapping(entry.kind.name, IN)
            values = form(self, entry, data) if form is not None else None
            if values is not None and form == general:
                commands.append(values)
            elif values:
                commands.append(self._scattered(entry, values))
        if len(commands) < 2:
            return commands[0] if commands else None
        return {name: value for command in commands for name, value in command.items()}

    def _scattered(self, entry: BoundKind, slots: Mapping[str, object], frame: str = "") -> Fields:
        fields, remark = entry.scatter(slots, frame)
        if remark is not None:
            self.complain(remark, remark)
        return fields

    def complain(self, kind: str, text: str) -> None:
        """Log a problem of a client, at most once in a while for each kind."""
        self.complaints.warn(kind, f"{self.component_name}: {text}")
