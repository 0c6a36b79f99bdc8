"""The binary stream of one component, and its readers."""

from __future__ import annotations

from typing import Any


class FrameChannel:
    """One stream; modified only in the network thread.

    Args:
        name: name of the component.
        number: id of the stream in its frames.
        readers: the clients that wait for a message of the component; the clients of the stream are added.

    Attributes:
        name: name of the component.
        number: id of the stream in its frames.
        every: clients that get every message.
        ready: clients that wait for one message; they request each further message.
    """

    def __init__(self, name: str, number: int, readers: set[object]) -> None:
        self.name = name
        self.number = number
        self.every: set[Any] = set()
        self.ready: set[Any] = set()
        self._readers = readers

    def add(self, client: object, *, latest: bool) -> None:
        """Add a client for every message, or for one message."""
        (self.ready if latest else self.every).add(client)
        self._readers.add(client)

    def discard(self, client: object) -> None:
        """Remove a client."""
        self.every.discard(client)
        self.ready.discard(client)
        self._readers.discard(client)
