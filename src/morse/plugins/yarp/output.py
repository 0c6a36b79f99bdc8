"""A connection from a port of the simulation to a port of another program."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from typing import TYPE_CHECKING

from morse.plugins.yarp import wire

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.plugins.yarp.names import Address

#: limits of the messages that wait for a reader: their number, and the bytes of all but the newest
_MOST, _MOST_BYTES = 64, 8 << 20
#: wall-clock seconds for the begin of a connection
_TIMEOUT = 5.0


class Output:
    """Sends messages in their order; a reader that is too slow loses the oldest ones.

    Args:
        source: name of the port of the simulation.
        target: name of the other port.
        carrier: ``tcp``, which waits until a message is acknowledged before it sends the next one, or ``fast_tcp``.
        on_loss: called with this connection when it has ended.
        slow: called with this connection when messages are dropped.
    """

    def __init__(
        self,
        source: str,
        target: str,
        carrier: str,
        on_loss: Callable[[Output], object],
        slow: Callable[[Output], object],
    ) -> None:
        self.source, self.target, self.carrier = source, target, carrier
        self._on_loss, self._slow = on_loss, slow
        self._queue: deque[bytes] = deque()
        self._size = 0
        self._has_data, self._free = asyncio.Event(), asyncio.Event()
        self._tasks: list[asyncio.Task[None]] = []
        self._writer: asyncio.StreamWriter | None = None

    async def open(self, address: Address) -> None:
        """Connect.

        Raises:
            OSError: the port cannot be reached.
            wire.WireError: it does not speak the protocol.
        """
        try:
            async with asyncio.timeout(_TIMEOUT):
                reader, writer = await asyncio.open_connection(*address)
                self._writer = writer
                writer.write(wire.header(self.carrier, self.source))
                wire.value_of(await reader.readexactly(8))
        except (TimeoutError, asyncio.IncompleteReadError) as error:
            self.close()
            raise OSError(f"{self.target} does not answer: {error}") from None
        except (OSError, wire.WireError):
            self.close()
            raise
        self._free.set()
        self._tasks = [asyncio.ensure_future(self._guard(part)) for part in (self._send(writer), self._read(reader))]

    def push(self, data: bytes) -> None:
        """Queue a message."""
        is_full = False
        while self._queue and (len(self._queue) >= _MOST or self._size > _MOST_BYTES):
            self._size -= len(self._queue.popleft())
            is_full = True
        self._queue.append(data)
        self._size += len(data)
        self._has_data.set()
        if is_full:
            self._slow(self)

    @property
    def is_idle(self) -> bool:
        """Whether all messages were sent and acknowledged."""
        return not self._queue and self._free.is_set()

    def close(self) -> None:
        """End the connection."""
        for task in self._tasks:
            task.cancel()
        if self._writer is not None:
            self._writer.close()

    async def _guard(self, part: object) -> None:
        with contextlib.suppress(OSError, asyncio.IncompleteReadError, wire.WireError):
            await part  # type: ignore[misc]
        self.close()
        self._on_loss(self)

    async def _send(self, writer: asyncio.StreamWriter) -> None:
        while True:
            await self._has_data.wait()
            await self._free.wait()
            data = self._queue.popleft()
            self._size -= len(data)
            if not self._queue:
                self._has_data.clear()
            if self.carrier == wire.TCP:
                self._free.clear()
            writer.writelines(wire.message("D", data))
            await writer.drain()

    async def _read(self, reader: asyncio.StreamReader) -> None:
        while True:
            # ends with the connection
            await wire.read_acknowledgement(reader)
            self._free.set()
