"""Assigns requests to pages: every page numbers its own requests from one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from morse.viewer.page_messages import CancelService

if TYPE_CHECKING:
    from morse.viewer.page_messages import ViewEvent
    from morse.viewer.view_messages import Answer


class Requests:
    """Gives requests unique numbers, and restores the original numbers in answers."""

    def __init__(self) -> None:
        self._asked: dict[int, tuple[int, int]] = {}
        self._last = 0

    def number(self, page: int, event: ViewEvent) -> ViewEvent:
        """The event for the simulation."""
        own = getattr(event, "request", None)
        if own is None:
            return event
        if isinstance(event, CancelService):
            number = next((number for number, asked in self._asked.items() if asked == (page, own)), 0)
        else:
            self._last = number = self._last + 1
            self._asked[number] = (page, own)
        return msgspec.structs.replace(event, request=number)

    def take(self, answer: Answer) -> tuple[int, Answer]:
        """The page that sent the request (0: disconnected, or already answered), and the answer for the page."""
        page, own = self._asked.pop(answer.request, (0, 0))
        return page, msgspec.structs.replace(answer, request=own)

    def forget(self, page: int) -> None:
        """Forget the requests of a page that has disconnected."""
        self._asked = {number: asked for number, asked in self._asked.items() if asked[0] != page}
