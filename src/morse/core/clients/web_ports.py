"""Opens web servers on the first port that is free."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from websockets.asyncio.server import serve

from morse.core.clients.web_connection import PacedConnection
from morse.core.clients.web_connections import MOST_WAITING

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable

    from websockets.asyncio.server import Server, ServerConnection

    from morse.core.clients.acceptors.streams import StreamAcceptor
    from morse.core.clients.arrivals import Arrivals


async def serve_on(
    handler: Callable[[ServerConnection], Awaitable[None]],
    host: str,
    ports: Iterable[int],
    arrivals: Arrivals,
    acceptor: StreamAcceptor,
    **options: Any,
) -> tuple[Server, int]:
    """Open a web server; what its clients send is processed within their share of the time.

    Args:
        options: see `websockets.asyncio.server.serve`.

    Returns:
        The server, and its port.

    Raises:
        OSError: no port is free.
    """
    failure = OSError("no port was given")
    for port in ports:
        try:
            server = await serve(
                handler,
                host,
                port,
                create_connection=partial(PacedConnection, arrivals),  # type: ignore[arg-type] # a factory is sufficient
                acceptor=acceptor,
                compression=None,
                max_queue=MOST_WAITING,
                **options,
            )
        except OSError as error:
            failure = error
            continue
        return server, int(next(iter(server.sockets)).getsockname()[1])
    raise failure
