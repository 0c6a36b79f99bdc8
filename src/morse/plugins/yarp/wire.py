"""The connection protocol of YARP, and its name server: headers, indices and messages of the carriers tcp and fast_tcp.

Source: www.yarp.it, "Port and connection protocols".
"""

from __future__ import annotations

import asyncio
import contextlib
import re
import struct
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


#: the carriers that a port speaks
TCP, FAST_TCP, TEXT, TEXT_ACK = "tcp", "fast_tcp", "text", "text_ack"
_CARRIER_BASE, _TCP_CODE, _WANTS_ACK = 7777, 3, 128
_OTHERS = {0: "udp", 1: "mcast", 2: "shmem"}
_INDEX = 10
LONGEST_NAME = 1000
_INT = struct.Struct("<i")


class WireError(ValueError):
    """A peer does not follow the protocol."""


class Arrived(NamedTuple):
    """A message.

    Attributes:
        command: ``d`` or ``D`` for data, with or without a reply, ``a`` for administration; others as in the source.
        data: the bottle.
    """

    command: str
    data: bytes


def number(value: int) -> bytes:
    """The eight bytes of a number."""
    return b"YA" + _INT.pack(value) + b"RP"


def value_of(data: bytes) -> int:
    """The number of eight bytes.

    Raises:
        WireError: they are none.
    """
    if data[:2] != b"YA" or data[6:] != b"RP":
        raise WireError(f"expected a number of YARP, got {data!r}")
    return int(_INT.unpack(data[2:6])[0])


def header(carrier: str, name: str) -> bytes:
    """The begin of a connection: the carrier and the name of the sender."""
    text = name.encode() + b"\0"
    return number(_CARRIER_BASE + _TCP_CODE + (_WANTS_ACK if carrier == TCP else 0)) + _INT.pack(len(text)) + text


def carrier_of(data: bytes) -> str:
    """The carrier of the first eight bytes of a connection.

    Raises:
        WireError: ports of MORSE do not speak it.
    """
    if data in (b"CONNECT ", b"CONNACK "):
        return TEXT if data == b"CONNECT " else TEXT_ACK
    code = value_of(data) - _CARRIER_BASE
    if code == _TCP_CODE | _WANTS_ACK:
        return TCP
    if code == _TCP_CODE:
        return FAST_TCP
    raise WireError(f"the carrier {_OTHERS.get(code & 15, code)} is not supported; tcp, fast_tcp and text are")


async def read_name(reader: asyncio.StreamReader) -> str:
    """The name of the sender of a connection."""
    (size,) = _INT.unpack(await reader.readexactly(4))
    if not 1 <= size <= LONGEST_NAME:
        raise WireError(f"the name of the sender has {size} letters")
    return (await reader.readexactly(size)).rstrip(b"\0").decode("utf-8", "replace")


def message(command: str, data: bytes) -> list[bytes]:
    """A message with its index, as the parts of one write."""
    lead = _INT.pack(0) + b"~" + command.encode() + b"\0\1"
    index = bytes((2, 1)) + b"\xff" * 8 + _INT.pack(len(lead)) + _INT.pack(len(data)) + _INT.pack(0)
    return [number(_INDEX) + index + lead, data]


async def read_message(reader: asyncio.StreamReader, largest: int) -> Arrived:
    """The next message.

    Raises:
        WireError: it does not follow the protocol, or has more bytes than ``largest``.
    """
    if value_of(await reader.readexactly(8)) != _INDEX:
        raise WireError("expected an index of ten bytes")
    counts = await reader.readexactly(_INDEX)
    blocks = counts[0] + counts[1]
    sizes = struct.unpack(f"<{blocks}i", await reader.readexactly(4 * blocks))
    if min(sizes, default=0) < 0 or not 8 <= sum(sizes) <= largest:
        raise WireError(f"a message has {sum(sizes)} bytes, expected 8 to {largest}")
    data = await reader.readexactly(sum(sizes))
    if data[4:5] != b"~":
        raise WireError("a message has no command")
    command, rest = data[5:6].decode("latin-1"), data[8:]
    if command == "\0":
        # the command is a text: "D" or "d", and for data an envelope
        text, _, rest = rest.partition(b"\0")
        command = text.decode("utf-8", "replace")
        if command[:1] in ("d", "D", "a"):
            command = command[0]
    return Arrived(command, rest)


def acknowledgement() -> bytes:
    """What the carrier tcp answers to each message."""
    return number(0)


async def read_acknowledgement(reader: asyncio.StreamReader) -> None:
    """The answer of the carrier tcp to a message."""
    size = value_of(await reader.readexactly(8))
    if not 0 <= size <= LONGEST_NAME:
        raise WireError(f"an acknowledgement has {size} bytes")
    await reader.readexactly(size)
