"""Assigns requests to pages: every page numbers its own requests from one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from morse.viewer.page_messages import CancelService, ViewEvent

if TYPE_CHECKING:
    from morse.viewer.view_messages import Answer

MOST_REQUESTS = 256
"""Maximum number of requests of one page that have no answer yet."""


class PageLeft(ViewEvent, frozen=True):
    """A page has disconnected; no page can send this message.

    Attributes:
        requests: its requests that have no answer yet.
    """

    requests: list[int]


class Requests:
    """Gives requests unique numbers, and restores the original numbers in answers."""

    def __init__(self) -> None:
        #: page, number of the page, size
        self._entries: dict[int, tuple[int, int, int]] = {}
        self._last = 0

    def number(self, page: int, event: ViewEvent, size: int = 0) -> ViewEvent:
        """The event for the simulation.

        Args:
            page: number of the page.
            event: as the page has sent it.
            size: bytes that `take` returns.
        """
        own = getattr(event, "request", None)
        if own is None:
            return event
        if isinstance(event, CancelService):
            number = next((number for number, request in self._entries.items() if request[:2] == (page, own)), 0)
        else:
            self._last = number = self._last + 1
            self._entries[number] = (page, own, size)
        return msgspec.structs.replace(event, request=number)

    def is_full(self, page: int, event: ViewEvent) -> bool:
        """Whether a page has too many requests without an answer to send another one."""
        if isinstance(event, CancelService) or getattr(event, "request", None) is None:
            return False
        return sum(request[0] == page for request in self._entries.values()) >= MOST_REQUESTS

    def take(self, answer: Answer) -> tuple[int, Answer, int]:
        """The page that sent the request (0: disconnected, or already answered), the answer for it, and the size."""
        page, own, size = self._entries.pop(answer.request, (0, 0, 0))
        return page, msgspec.structs.replace(answer, request=own), size

    def forget(self, page: int) -> list[int]:
        """Forget the requests of a page that has disconnected; returns those without an answer."""
        numbers = [number for number, request in self._entries.items() if request[0] == page]
        for number in numbers:
            del self._entries[number]
        return numbers
