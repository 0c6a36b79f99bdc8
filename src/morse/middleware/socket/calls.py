"""Active asynchronous calls, and their clients."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import uuid

    from morse.middleware.socket.service_client import ServiceClient

#: maximum number of ids of a client that are stored
_REMEMBERED = 1024


class Calls:
    """The active asynchronous calls of all clients; every operation takes constant time."""

    def __init__(self) -> None:
        self._callers: dict[uuid.UUID, tuple[ServiceClient, str]] = {}
        self._of_request: dict[str, dict[uuid.UUID, None]] = {}
        self._of_client: dict[ServiceClient, dict[str, dict[uuid.UUID, None]]] = {}
        self._numbers: dict[ServiceClient, dict[str, None]] = {}

    def __len__(self) -> int:
        return len(self._callers)

    def issued(self, client: ServiceClient, request: str) -> None:
        """Note that a client has used that request id."""
        ids = self._numbers.setdefault(client, {})
        ids[request] = None
        if len(ids) > _REMEMBERED:
            del ids[next(iter(ids))]

    def add(self, call: uuid.UUID, client: ServiceClient, request: str) -> None:
        """Add an active call."""
        self._callers[call] = (client, request)
        self._of_request.setdefault(request, {})[call] = None
        self._of_client.setdefault(client, {}).setdefault(request, {})[call] = None
        client.calls += 1

    def remove(self, call: uuid.UUID) -> tuple[ServiceClient, str]:
        """Remove a call that has ended; returns its client and request id."""
        client, request = self._callers.pop(call)
        _remove(self._of_request, request, call)
        _remove(self._of_client[client], request, call)
        if not self._of_client[client]:
            del self._of_client[client]
        client.calls -= 1
        return client, request

    def find(self, client: ServiceClient, request: str) -> uuid.UUID | None:
        """The latest call with that id: of the client, or of another one if this client has never used the id."""
        own = self._of_client.get(client, {}).get(request)
        if own:
            return next(reversed(own))
        if request in self._numbers.get(client, ()):
            return None
        others = self._of_request.get(request)
        return next(reversed(others)) if others else None

    def forget(self, client: ServiceClient) -> list[uuid.UUID]:
        """Remove a client that has disconnected; returns its active calls."""
        self._numbers.pop(client, None)
        return [call for calls in self._of_client.get(client, {}).values() for call in calls]


def _remove(index: dict[str, dict[uuid.UUID, None]], request: str, call: uuid.UUID) -> None:
    calls = index[request]
    del calls[call]
    if not calls:
        del index[request]
