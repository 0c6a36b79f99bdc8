"""One connected page: its send queue."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from websockets.exceptions import ConnectionClosed

from morse.core.clients.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Mapping

    from websockets.asyncio.server import ServerConnection

    from morse.viewer.page_messages import Watch
    from morse.viewer.view_messages import Subject

WINDOW = 15
"""Maximum number of pose frames in transit to a page: a quarter of a second."""

MOST_WAITING = 5000
"""Maximum number of messages that wait for a page, besides those that it began with; a slower page is disconnected."""


class Page:
    """A connected page.

    A newer message replaces an unsent older one on the same subject. A slow page gets fewer messages, but no late
    messages.

    Attributes:
        number: its id for other pages.
        watch: what it shows.
        drawn: whether it has drawn the world.
        memory: for its requests without an answer, and for unsent messages that no newer ones replace.
    """

    def __init__(self, number: int, connection: ServerConnection) -> None:
        self.number = number
        self.connection = connection
        self.watch: Watch | None = None
        self.drawn = False
        self.memory = Budget()
        self._waiting: dict[Subject | int, str | bytes] = {}
        self._unique = 0
        self._most_waiting = MOST_WAITING
        self._poses: bytes | None = None
        self._frame_count = 0
        self._receipts = 0
        self._wake = asyncio.Event()

    def tell(self, subject: Subject | None, frame: str | bytes) -> None:
        """Queue a message."""
        key: Subject | int
        if subject is None:
            self._unique += 1
            key = self._unique
            self.memory.force(len(frame))
        else:
            key = subject
            self._waiting.pop(key, None)
        self._waiting[key] = frame
        self._wake.set()

    def show(self, poses: bytes) -> bool:
        """Queue the newest poses; they replace older ones in the queue.

        Returns:
            Whether the page can take them now: then they count as sent, and the caller has to send them.
        """
        self._poses = poses
        if self._frame_count - self._receipts >= WINDOW:
            return False
        if self._waiting or self.connection.transport.get_write_buffer_size():
            self._wake.set()
            return False
        self._poses = None
        self._frame_count += 1
        return True

    def took(self, count: int) -> None:
        """Set the number of pose frames that the page has received."""
        self._receipts = min(count, self._frame_count)
        if self._poses is not None:
            self._wake.set()

    @property
    def hopeless(self) -> bool:
        """Whether it is so far behind that it cannot catch up."""
        return len(self._waiting) > self._most_waiting or self.memory.left < 0

    def begin(self, messages: Mapping[Subject, str | bytes]) -> None:
        """Queue the lasting messages, of which a scene with many components has thousands."""
        self._waiting.update(messages.items())
        self._most_waiting = MOST_WAITING + len(messages)
        self._wake.set()

    async def send_forever(self) -> None:
        """Send queued messages until the connection is closed."""
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                # messages first: poses may belong to a world that one of them announces
                while self._waiting:
                    key = next(iter(self._waiting))
                    frame = self._waiting.pop(key)
                    if isinstance(key, int):
                        self.memory.give(len(frame))
                    await self.connection.send(frame)
                if self._poses is not None and self._frame_count - self._receipts < WINDOW:
                    poses, self._poses = self._poses, None
                    self._frame_count += 1
                    await self.connection.send(poses)
        except ConnectionClosed:
            pass  # the receiving task handles the end
