"""Lets a client pace the simulation: each tick waits for its bytes."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

from morse.wire.lines import LineClient
from morse.wire.server import LineServer

if TYPE_CHECKING:
    import socket

    from morse.core.context import Context
    from morse.wire.connection import Connection

logger = logging.getLogger(__name__)

#: interval in which the waiting simulation thread checks whether the simulation is to end, s
_SLICE = 0.02
#: wall-clock time in which a client has to send its first bytes; later it no longer holds up the simulation, s
_PATIENCE = 30.0


class TimeSync:
    """A port for clients that pace the simulation.

    While at least one client is connected, a tick begins only after bytes have arrived since the
    beginning of the last tick; their number does not matter. Services are answered in the meantime.
    A client that sends nothing within 30 s does not hold up the simulation until it sends something.
    """

    def __init__(self, context: Context, listener: socket.socket) -> None:
        self._context = context
        self._is_open = False
        self._server = LineServer("time sync", listener, lambda server: _SyncClient(server, self))

    async def start(self) -> None:
        """Start accepting clients."""
        await self._server.start(self._context.network)

    async def close(self) -> None:
        """Stop pacing the simulation."""
        await self._server.close()

    def arrived(self) -> None:
        """Bytes have arrived; runs in the network loop."""
        self._context.network.when_read(self.release)

    def release(self) -> None:
        """Allow one tick, or note that no client paces the simulation any more; runs in the network loop."""
        self._is_open = True
        self._context.wake()

    def _is_paced(self) -> bool:
        clients = list(self._server.clients)
        if any(client.is_proven for client in clients):
            return True
        now = time.monotonic()
        for client in clients:
            if now - client.heard < _PATIENCE:
                return True
            text = f"time sync: {client.peer} sends nothing, so it no longer holds up the simulation"
            self._server.complaints.warn("silent", text)
        return False

    def wait(self) -> None:
        """Wait until the next tick is allowed; runs in the simulation thread."""
        while self._is_paced() and not self._is_open and not self._context.stopping():
            self._context.services.process()
            self._context.wait(_SLICE)
        self._is_open = False


class _SyncClient(LineClient):
    def __init__(self, server: LineServer, sync: TimeSync) -> None:
        super().__init__(server)
        self._sync = sync

    def connection_made(self, transport: Connection, peer: str) -> None:
        super().connection_made(transport, peer)
        self.server.complaints.log(logging.INFO, "begin", f"the client {self.peer} paces the simulation")

    def data_received(self, data: bytes) -> None:
        if self.is_welcome(data):
            self.is_proven = True
            self._sync.arrived()

    def connection_lost(self, error: OSError | None) -> None:
        super().connection_lost(error)
        self.server.complaints.log(logging.INFO, "end", f"the client {self.peer} no longer paces the simulation")
        self._sync.release()
