"""Several pages that take in all that the live view sends: ``read_pages PAGES ADDRESS``."""

from __future__ import annotations

import asyncio
import sys

import msgspec
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from morse.viewer.page_messages import Alive, Hello, Taken
from morse.viewer.protocol import VERSION

_ENCODER = msgspec.json.Encoder()


async def _page(address: str, opened: asyncio.Barrier) -> None:
    try:
        async with connect(address, max_size=None, compression=None) as connection:
            await connection.send(_ENCODER.encode(Hello(VERSION)).decode())
            await connection.recv()
            await opened.wait()
            await asyncio.gather(_take(connection), _live(connection))
    except ConnectionClosed:
        return


async def _take(connection: ClientConnection) -> None:
    count = 0
    async for frame in connection:
        if isinstance(frame, bytes):
            count += 1
            await connection.send(_ENCODER.encode(Taken(count)).decode())


async def _live(connection: ClientConnection) -> None:
    while True:
        await connection.send(_ENCODER.encode(Alive()).decode())
        await asyncio.sleep(0.3)


async def main() -> None:
    """Take in what comes until the simulation has ended."""
    pages, page = int(sys.argv[1]), sys.argv[2]
    address = page.replace("http://", "ws://").rstrip("/") + "/ws"
    opened = asyncio.Barrier(pages + 1)
    connections = asyncio.gather(*(_page(address, opened) for _ in range(pages)))
    await opened.wait()
    print("connected", flush=True)
    await connections


if __name__ == "__main__":
    asyncio.run(main())
