"""One client: its send queue, and its limits."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Protocol

from websockets.exceptions import ConnectionClosed

from morse.core.clients.budgets import ENTRY, Budget
from morse.core.clients.web_connection import sender_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from websockets.asyncio.server import ServerConnection

    from morse.core.clients.budgets import Sender

#: processor time of a part of a message, s
_PART = 1e-4


class Several(Protocol):
    """A message that is sent in parts; its length is that of all of them."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[str]: ...


Frame = str | bytes | Several


def _size(frame: Frame) -> int:
    return len(frame) + ENTRY


class WebClient:
    """A connection; all functions run in the network thread.

    If a client reads too slowly, its data are dropped, the oldest first. Responses are never dropped: a client that
    does not read them is disconnected.

    Attributes:
        connection: the WebSocket.
        memory: for its queued messages, and for everything that it leaves behind; data give way to the rest.
        peer: address and port of the client.
    """

    def __init__(self, connection: ServerConnection) -> None:
        self.connection = connection
        address = connection.remote_address
        self.peer = f"{address[0]}:{address[1]}" if address else "?"
        self._waiting: dict[int, tuple[object, Frame]] = {}
        self._of_key: dict[object, deque[int]] = {}
        self.memory = Budget()
        self._serial = 0
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
        is_alone = not self._waiting
        self._add(None, frame)
        self._make_room()
        if self.memory.left < 0 and not is_alone:
            self.connection.transport.abort()

    def keep(self, count: int, what: str) -> None:
        """Reserve memory for something that the client leaves behind; `memory.give` releases it.

        Args:
            count: of bytes, in addition to an entry of a table.
            what: for the message, such as ``a subscription``.

        Raises:
            OverBudget: the client has used its memory.
        """
        while self.memory.left < count + ENTRY and self._drop_oldest():
            pass
        self.memory.charge(count + ENTRY, what)

    def release(self, count: int) -> None:
        """Release what `keep` has reserved."""
        self.memory.give(count + ENTRY)

    def offer(self, key: object, frame: Frame, depth: int) -> bool:
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
        return self._make_room() and is_fast

    def _make_room(self) -> bool:
        """Drop data until the queue fits the memory; return whether that was unnecessary."""
        is_small = True
        while self.memory.left < 0 and self._drop_oldest():
            is_small = False
        return is_small

    def _add(self, key: object, frame: Frame) -> None:
        self._serial += 1
        self._waiting[self._serial] = (key, frame)
        self.memory.force(_size(frame))
        self._wake.set()

    def _drop(self, number: int) -> None:
        self.memory.give(_size(self._waiting.pop(number)[1]))

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
                    self.memory.give(_size(frame))
                    if key is not None:
                        self._of_key[key].popleft()
                    if isinstance(frame, (str, bytes)):
                        await self.connection.send(frame)
                    else:
                        await self._send_parts(frame)
        except ConnectionClosed:
            pass  # the receiving task handles the end

    async def _send_parts(self, frame: Several) -> None:
        """Send the parts of a message; a client that wants too many waits for them, and no other one does."""
        sender = sender_of(self.connection)
        for part in frame:
            await self.connection.send(part)
            sender.spend(_PART)
            await sender.rest()

    # -- receiving ---------------------------------------------------------------------------

    async def receive_forever(self, sender: Sender) -> None:
        """Receive messages until the connection is closed; a client that sends too much is throttled."""
        async for frame in self.connection:
            with sender.measured():
                self.received(frame)
            await sender.rest()
