"""The connection protocol of YARP: headers, indices and messages of the carriers tcp and fast_tcp.

Source: www.yarp.it, "Port and connection protocols".
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import asyncio

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
