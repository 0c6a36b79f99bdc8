"""Requests and the servers that answer them, see `morse.core.requests`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self, TypeVar

if TYPE_CHECKING:
    from collections.abc import Sequence

_Q = TypeVar("_Q", contravariant=True)


class Server(Protocol[_Q]):
    """Answers requests of one kind."""

    def serve(self, requests: Sequence[_Q]) -> None:
        """Answer requests, all of which belong to this server, for the present state of the world."""


class Request(Protocol):
    """A query that must be answered before each action of a component; the server writes the answer into it."""

    @property
    def server(self) -> Server[Self]:
        """The server that answers the request."""
