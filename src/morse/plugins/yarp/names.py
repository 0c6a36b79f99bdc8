"""The name server of YARP, which knows the address of each port; it may be temporarily unavailable.

Source: www.yarp.it, "The YARP name server": requests and answers are lines of text.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
from typing import NamedTuple

#: wall-clock seconds for an answer
_TIMEOUT = 5.0
#: wall-clock seconds for a connection to another port
_PROBE = 1.0
#: maximum size of an answer, bytes
_LONGEST = 1 << 16
_REGISTRATION = re.compile(r"registration name (\S+) ip (\S+) port (\d{1,5}) type (\S+)")
_LARGEST_PORT = (1 << 16) - 1


class Address(NamedTuple):
    """Where a port listens.

    Attributes:
        host: name or address of a machine.
        port: number of its TCP port.
    """

    host: str
    port: int


async def is_alive(address: Address) -> bool:
    """Whether anything listens at an address."""
    try:
        async with asyncio.timeout(_PROBE):
            _, writer = await asyncio.open_connection(*address)
    except (OSError, TimeoutError, ValueError):  # ValueError: no name of a machine
        return False
    writer.close()
    return True


class NameServer:
    """Asks a name server; all methods are coroutines of the network loop.

    Args:
        host: name or address of its machine.
        port: number of its TCP port.
    """

    def __init__(self, host: str, port: int) -> None:
        self.address = Address(host, port)
        # yarpserver lets one connection wait; the system would try a refused one again only after a second
        self._turn = asyncio.Lock()

    async def register(self, name: str, address: Address) -> Address | None:
        """Enter the address of a port; returns the address that the server has entered."""
        return await self._address(f"register {name} tcp {address.host} {address.port}", name)

    async def query(self, name: str) -> Address | None:
        """The address of a port; None if it is not registered."""
        return await self._address(f"query {name}", name)

    async def unregister(self, name: str) -> None:
        """Remove a port."""
        await self._ask(f"unregister {name}")

    async def _address(self, request: str, name: str) -> Address | None:
        match = _REGISTRATION.search(await self._ask(request))
        if match is None or match[1] != name or not 0 < int(match[3]) <= _LARGEST_PORT:
            return None
        return Address(match[2], int(match[3]))

    async def _ask(self, request: str) -> str:
        """The answer to a request.

        Raises:
            OSError: the server cannot be reached, or does not answer in time.
        """
        try:
            async with self._turn, asyncio.timeout(_TIMEOUT):
                reader, writer = await asyncio.open_connection(*self.address, limit=_LONGEST)
                try:
                    writer.write(f"NAME_SERVER {request}\n".encode())
                    answer = b""
                    while line := await reader.readline():
                        answer += line
                        if line.startswith(b"***"):
                            break
                        if len(answer) > _LONGEST:
                            raise ValueError(f"more than {_LONGEST} bytes")
                    return answer.decode("utf-8", "replace")
                finally:
                    writer.close()
                    with contextlib.suppress(OSError):
                        await writer.wait_closed()
        except (TimeoutError, ValueError, asyncio.IncompleteReadError) as error:
            raise OSError(f"it does not answer: {error}") from None
