"""The stream class of middlewares that carry message kinds, for all components."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from morse.core.clients.complaints import Complaints
from morse.core.clients.waiting import Waiting
from morse.core.datastream import AbstractDatastream
from morse.core.kinds import bind
from morse.core.reports.faults import summary
from morse.core.reports.quoting import shown
from morse.core.validation.commands import Commands
from morse.core.validation.errors import CommandError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.kinds import BoundKind
    from morse.core.object import Object

logger = logging.getLogger(__name__)

#: largest number of messages that are queued for the next action of an actuator
_MOST_WAITING = 64


class KindStream(AbstractDatastream):
    """Sends the messages of a component with the methods of its manager, or passes received messages to the component.

    Attributes:
        kinds: the message kinds that the component sends or receives.
    """

    def initialize(self) -> None:
        """Find the message kinds of the component, and the method of the manager for each."""
        self.kinds: tuple[BoundKind, ...] = self.find_kinds()
        self._outgoing = [(bound, self.manager.mapping(bound.kind.name)) for bound in self.kinds]
        self.complaints = Complaints(logger)
        self._arrived: Waiting[tuple[BoundKind, Mapping[str, Any], str]] = Waiting(
            _MOST_WAITING, self.complaints, self.component_name, "commands"
        )
        self._commands = Commands(self.component_instance) if self.direction == "IN" else None

    def find_kinds(self) -> tuple[BoundKind, ...]:
        """Return the message kinds of the component that the stream carries."""
        return bind(self.component_instance)

    def default(self, ci: Object | None = None) -> bool:
        """Publish the messages; or read the received messages and return True if there were any."""
        if self._commands is None:
            for bound, send in self._outgoing:
                if send is not None and self.manager.wanted(self, bound.topic):
                    send(self, bound.gather())
            return False
        taken = False
        while self._arrived:
            taken = self._take(*self._arrived.popleft(), self._commands) or taken
        return taken

    def receive(self, bound: BoundKind, slots: Mapping[str, Any], frame: str = "") -> None:
        """Queue a message for the component; may be called from any thread.

        Args:
            bound: one of `kinds`.
            slots: values by slot name.
            frame: frame of the first slot; empty for the frame of the fields.
        """
        self._arrived.append((bound, slots, frame))

    def _take(self, bound: BoundKind, slots: Mapping[str, Any], frame: str, commands: Commands) -> bool:
        try:
            fields, remark = bound.scatter(slots, frame)
            unknown = commands.take(fields)
        except CommandError as error:
            self.complain(f"field {error.field}", f"a message is refused: {error}")
            return False
        except Exception as error:  # a slot may contain anything, and a client must not stop the component
            self.complain("message", f"a message cannot be read ({summary(error)}): {shown(slots)}")
            return False
        for text in filter(None, (remark, unknown)):
            self.complain(text, text)
        return True

    def complain(self, kind: str, text: str) -> None:
        """Log a problem with a received message."""
        self.complaints.warn(kind, f"{self.component_name}: {text}")
