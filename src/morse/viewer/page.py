"""One page that watches: what waits to be sent to it."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from websockets.exceptions import ConnectionClosed

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

    from morse.viewer.page_messages import Watch
    from morse.viewer.view_messages import Subject

WINDOW = 15
"""Frames of poses on their way to a page, at most: a quarter of a second."""

MOST_WAITING = 5000
"""Messages that wait for a page, at most; one that falls behind further is given up."""


class Page:
    """A connected page.

    A newer message replaces an older one on the same subject that is not yet sent. A slow page gets fewer messages, not
    late ones.

    Attributes:
        number: by which the others know it.
        watch: what it shows.
    """

    def __init__(self, number: int, connection: ServerConnection) -> None:
        self.number = number
        self.connection = connection
        self.watch: Watch | None = None
        self._waiting: dict[Subject | int, str | bytes] = {}
        self._unique = 0
        self._poses: bytes | None = None
        self._sent = 0
        self._taken = 0
        self._wake = asyncio.Event()

    def tell(self, subject: Subject | None, frame: str | bytes) -> None:
        """Have a message sent."""
        key: Subject | int
        if subject is None:
            self._unique += 1
            key = self._unique
        else:
            key = subject
            self._waiting.pop(key, None)
        self._waiting[key] = frame
        self._wake.set()

    def show(self, poses: bytes) -> bool:
        """Have the newest poses sent, instead of older ones that still wait.

        Returns:
            Whether the page can take them now: then they count as sent, and are the caller's to send.
        """
        self._poses = poses
        if self._sent - self._taken >= WINDOW:
            return False
        if self._waiting or self.connection.transport.get_write_buffer_size():
            self._wake.set()
            return False
        self._poses = None
        self._sent += 1
        return True

    def took(self, count: int) -> None:
        """Note how many frames of poses the page has received."""
        self._taken = min(count, self._sent)
        if self._poses is not None:
            self._wake.set()

    @property
    def hopeless(self) -> bool:
        """So far behind that it will not catch up."""
        return len(self._waiting) > MOST_WAITING

    async def send_forever(self) -> None:
        """Send what waits, until the connection ends."""
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                # messages first: poses may belong to a world that one of them announces
                while self._waiting:
                    await self.connection.send(self._waiting.pop(next(iter(self._waiting))))
                if self._poses is not None and self._sent - self._taken < WINDOW:
                    poses, self._poses = self._poses, None
                    self._sent += 1
                    await self.connection.send(poses)
        except ConnectionClosed:
            pass  # the task that receives from the page notices the end, too
