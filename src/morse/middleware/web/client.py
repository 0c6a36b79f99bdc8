"""One client: its send queue, and its limits."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING

from websockets.exceptions import ConnectionClosed

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

    from morse.core.web_crowd import Pace

MOST_BYTES = 16 << 20
"""Maximum size of the send queue of a client, bytes; newer data replace older data."""

_MOST_TOLD = 4096


class WebClient:
    """A connection; all functions run in the network thread.

    If a client reads too slowly, its data are dropped, the oldest of a topic first. Responses are never dropped: a
    client that does not read them is disconnected.

    Attributes:
        connection: the WebSocket.
        peer: address and port of the client.
    """

    def __init__(self, connection: ServerConnection) -> None:
        self.connection = connection
        address = connection.remote_address
        self.peer = f"{address[0]}:{address[1]}" if address else "?"
        self._waiting: dict[int, tuple[object, str | bytes]] = {}
        self._of_key: dict[object, deque[int]] = {}
        self._serial = self._size = self._told = 0
        self._wake = asyncio.Event()

    @property
    def is_behind(self) -> bool:
        """Whether messages are queued."""
        return bool(self._waiting)

    def begin(self) -> None:
        """The connection is open: send the first messages of the protocol."""

    def received(self, frame: str | bytes) -> None:
        """A message has arrived."""
        raise NotImplementedError

    def ended(self) -> None:
        """The connection is closed."""

    # -- sending -----------------------------------------------------------------------------

    def tell(self, frame: str | bytes) -> None:
        """Queue a response."""
        self._told += 1
        if self._told > _MOST_TOLD or self._size > 4 * MOST_BYTES:
            self.connection.transport.abort()
            return
        self._add(None, frame)

    def offer(self, key: object, frame: str | bytes, depth: int) -> bool:
        """Queue data if the client is fast enough.

        Args:
            key: identifies the topic of the data.
            frame: the message.
            depth: maximum number of queued messages with that key.

        Returns:
            False if older data were dropped.
        """
        numbers = self._of_key.setdefault(key, deque())
        is_fast = len(numbers) < depth
        while len(numbers) >= depth:
            self._drop(numbers.popleft())
        self._add(key, frame)
        numbers.append(self._serial)
        while self._size > MOST_BYTES and self._drop_oldest():
            is_fast = False
        return is_fast

    def _add(self, key: object, frame: str | bytes) -> None:
        self._serial += 1
        self._waiting[self._serial] = (key, frame)
        self._size += len(frame)
        self._wake.set()

    def _drop(self, number: int) -> None:
        self._size -= len(self._waiting.pop(number)[1])

    def _drop_oldest(self) -> bool:
        oldest = next((number for number, (key, _) in self._waiting.items() if key is not None), None)
        if oldest is None or oldest == self._serial:
            return False
        self._of_key[self._waiting[oldest][0]].remove(oldest)
        self._drop(oldest)
        return True

    async def send_forever(self) -> None:
        """Send queued messages until the connection is closed."""
        try:
            while True:
                await self._wake.wait()
                self._wake.clear()
                while self._waiting:
                    number = next(iter(self._waiting))
                    key, frame = self._waiting.pop(number)
                    self._size -= len(frame)
                    if key is None:
                        self._told -= 1
                    else:
                        self._of_key[key].popleft()
                    await self.connection.send(frame)
        except ConnectionClosed:
            pass  # the receiving task handles the end

    # -- receiving ---------------------------------------------------------------------------

    async def receive_forever(self, pace: Pace) -> None:
        """Receive messages until the connection is closed; a client that sends too much is throttled."""
        spent = 0.0
        async for frame in self.connection:
            begin = pace.now()
            self.received(frame)
            spent = await pace.rest(spent + pace.now() - begin)
