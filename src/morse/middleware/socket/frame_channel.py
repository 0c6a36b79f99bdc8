"""The binary stream of one component, and who reads it."""

from __future__ import annotations

from typing import Any


class FrameChannel:
    """One stream; changed in the network thread only.

    Args:
        name: of the component.
        number: of the stream in its frames.
        readers: who waits for a message of the component; the clients of the stream are added.

    Attributes:
        name: of the component.
        number: of the stream in its frames.
        every: clients that get every message.
        ready: clients that wait for one message; they ask for the next one when they want it.
    """

    def __init__(self, name: str, number: int, readers: set[object]) -> None:
        self.name = name
        self.number = number
        self.every: set[Any] = set()
        self.ready: set[Any] = set()
        self._readers = readers

    def add(self, client: object, *, latest: bool) -> None:
        """A client wants every message, or one message."""
        (self.ready if latest else self.every).add(client)
        self._readers.add(client)

    def discard(self, client: object) -> None:
        """A client wants no more messages."""
        self.every.discard(client)
        self.ready.discard(client)
        self._readers.discard(client)
