"""Pages that receive all data of the live view: ``read_pages ADDRESS``, with their number in lines of the input.

They send the same messages as an idle page in a browser, at the same rate: see ``viewer/src/connection/worker.ts``.
"""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING

import msgspec
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from morse.viewer.page_messages import Alive, Hello, Taken, Watch
from morse.viewer.protocol import VERSION
from morse.viewer.snapshot import holds_poses

if TYPE_CHECKING:
    from morse.viewer.page_messages import PageMessage

_ENCODER = msgspec.json.Encoder()
_ALIVE_EVERY = 0.15  # s
_TAKEN_EVERY = 4


async def _page(address: str, opened: asyncio.Event) -> None:
    try:
        async with connect(address, max_size=None, compression=None) as connection:
            await _say(connection, Hello(VERSION))
            await connection.recv()
            await _say(connection, Watch())
            opened.set()
            await asyncio.gather(_take(connection), _live(connection))
    except ConnectionClosed:
        return


async def _say(connection: ClientConnection, message: PageMessage) -> None:
    await connection.send(_ENCODER.encode(message).decode())


async def _take(connection: ClientConnection) -> None:
    count = 0
    async for frame in connection:
        if holds_poses(frame):
            count += 1
            if count % _TAKEN_EVERY == 0:
                await _say(connection, Taken(count))


async def _live(connection: ClientConnection) -> None:
    while True:
        await _say(connection, Alive())
        await asyncio.sleep(_ALIVE_EVERY)


async def main() -> None:
    """Keep the number of pages of the last line, and confirm it, until the input ends."""
    address = sys.argv[1].replace("http://", "ws://").rstrip("/") + "/ws"
    pages: list[asyncio.Task[None]] = []
    while line := await asyncio.to_thread(sys.stdin.readline):
        while len(pages) > int(line):
            pages[-1].cancel()
            await asyncio.wait([pages.pop()])
        while len(pages) < int(line):
            opened = asyncio.Event()
            pages.append(asyncio.create_task(_page(address, opened)))
            await opened.wait()
        print("connected", flush=True)


if __name__ == "__main__":
    asyncio.run(main())
