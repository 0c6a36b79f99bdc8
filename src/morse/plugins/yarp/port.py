"""A port: other ports connect to it, and administer its connections."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import re
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from morse.core.clients.acceptors import DESCRIPTORS, AcceptedProtocol, StreamAcceptor
from morse.core.clients.complaints import Complaints
from morse.core.reports.quoting import shown
from morse.plugins.yarp import wire
from morse.plugins.yarp.bottle import BottleError, Vocab, decode, encode, from_text, to_text

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from morse.core.clients.budgets import Arrivals, Sender
    from morse.plugins.yarp.wire import Address, NameServer


#: limits of the messages that wait for a reader: their number, and the bytes of all but the newest
_MOST, _MOST_BYTES = 64, 8 << 20
#: wall-clock seconds for the begin of a connection
_CONNECT_TIMEOUT = 5.0


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
            async with asyncio.timeout(_CONNECT_TIMEOUT):
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


logger = logging.getLogger(__name__)

_T = TypeVar("_T")
_Command = TypeVar("_Command", str, bytes)

#: bytes of the largest bottle and of the largest command that are received: what a bottle contains is decoded value by
#: value, which takes up to 100 times longer than to receive it
_LARGEST, _LARGEST_COMMAND = 1 << 17, 1 << 12
#: processor seconds for the index of a message, or for finding the end of a line
_EACH = 5e-5
#: number of connections to a port, and wall-clock seconds for the begin of one
_MOST_CONNECTIONS, _TIMEOUT = 64, 5.0
_CARRIERS = (wire.TCP, wire.FAST_TCP)
#: a target such as ``/reader``, ``fast_tcp://reader`` or ``tcp:/reader``
_TARGET = re.compile(r"(?:([a-z_0-9]+):/)?(/[^\s:]+)$")
_VERSION = [Vocab("ver"), 1, 2, 3]
_HELP = [
    Vocab("many"),
    "[help]                  # give this help",
    "[ver]                   # report protocol version information",
    "[add] $portname         # add an output connection",
    "[add] $portname $car    # add an output with a given protocol",
    "[del] $portname         # remove an output connection",
    "[list] [in]             # list input connections",
    "[list] [out]            # list output connections",
    "[list] [out] $portname  # give details for output",
]


class _Input(NamedTuple):
    source: str
    carrier: str
    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    sender: Sender


class _Visitor(AcceptedProtocol, asyncio.StreamReaderProtocol):
    """A connection to a port."""


class Port:
    """A port of the simulation; all methods run in the network loop.

    Args:
        name: such as ``/morse/robot/pose/out``.
        names: where the addresses of other ports are asked for.
        take: called with the values of each bottle that arrives, and the number of its bytes; None for a port that only
            sends.
        arrivals: the share of the time for what clients send.

    Attributes:
        outputs: the connections to other ports, by name.
    """

    def __init__(
        self, name: str, names: NameServer, take: Callable[[list[object], int], object] | None, arrivals: Arrivals
    ) -> None:
        self.name, self._names, self._take = name, names, take
        self._arrivals = arrivals
        self.outputs: dict[str, Output] = {}
        self._inputs: set[_Input] = set()
        self._number = 0
        self._complaints = Complaints(logger)
        self._acceptor = StreamAcceptor(f"yarp: {name}", most=_MOST_CONNECTIONS, complaints=self._complaints)

    async def open(self, listener: socket.socket) -> None:
        """Accept connections."""
        self._number = listener.getsockname()[1]
        self._acceptor.serve([listener], lambda: _Visitor(asyncio.StreamReader(limit=_LARGEST), self._serve))

    async def close(self) -> None:
        """End all connections, after the messages that still wait were sent."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(_TIMEOUT / 5):
                while not all(output.is_idle for output in self.outputs.values()):
                    await asyncio.sleep(0.005)
        self._acceptor.close()
        for one in list(self._inputs):
            one.writer.close()
        for output in list(self.outputs.values()):
            output.close()
        self.outputs.clear()

    def send(self, data: bytes) -> None:
        """Send a bottle to all readers."""
        for output in self.outputs.values():
            output.push(data)

    # -- received connections ----------------------------------------------------------------

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        one = None
        try:
            async with asyncio.timeout(_TIMEOUT):
                one = await self._greet(reader, writer)
            writer.transport.get_protocol().place.keeps_place = True  # type: ignore[attr-defined] # a protocol
            self._inputs.add(one)
            await (self._lines(one) if one.carrier in (wire.TEXT, wire.TEXT_ACK) else self._messages(one))
        except (OSError, asyncio.IncompleteReadError, TimeoutError):
            pass  # the other side has gone
        except asyncio.CancelledError:
            pass  # the simulation ends; asyncio of Python 3.11 would print the lines of the code
        except ValueError as error:
            self._complaints.warn("wrong", f"yarp: a connection to {self.name} is closed: {error}")
        finally:
            if one is not None:
                self._inputs.discard(one)
            writer.close()

    async def _greet(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> _Input:
        carrier = wire.carrier_of(await reader.readexactly(8))
        if carrier in (wire.TEXT, wire.TEXT_ACK):
            source = (await reader.readline()).decode("utf-8", "replace").strip()[: wire.LONGEST_NAME]
            if "HTTP/" in source:  # CONNECT is a word of HTTP, too
                raise wire.WireError("the client speaks HTTP")
            writer.write(f"Welcome {source}\r\n".encode())
        else:
            source = await wire.read_name(reader)
            writer.write(wire.number(self._number))
        return _Input(source, carrier, reader, writer, self._arrivals.sender())

    async def _messages(self, one: _Input) -> None:
        while True:
            command, data = await wire.read_message(one.reader, _LARGEST)
            one.sender.spend(_EACH)
            with one.sender.measured():
                if command in ("d", "D"):
                    self._data(one, decode, data)
                words = decode(self._checked(data)) if command == "a" else []
            if command == "a":
                one.writer.write(encode(await self._administer(words)))
            elif command == "d":
                one.writer.write(encode([]))  # who sends "d" waits for a reply
            elif command == "q":
                return
            elif command != "D":
                await self._short(self._checked(command))
            if one.carrier == wire.TCP:
                one.writer.write(wire.acknowledgement())
            await one.writer.drain()
            await one.sender.rest()

    async def _lines(self, one: _Input) -> None:
        while line := (await self._line(one)).strip():
            answer = None
            if line in ("d", "D", "do"):
                text = await self._line(one)
                with one.sender.measured():
                    self._data(one, from_text, text)
            elif line == "a":
                text = await self._line(one, "strict")
                with one.sender.measured():
                    words = from_text(self._checked(text))
                answer = to_text(await self._administer(words))
            elif line == "q":
                one.writer.write(b"Bye bye\r\n")
                return
            else:
                answer = await self._short(self._checked(line))
            if answer is not None:
                one.writer.write(f"{answer}\r\n".encode())
            if one.carrier == wire.TEXT_ACK:
                one.writer.write(b"<ACK>\r\n")
            await one.writer.drain()
            await one.sender.rest()

    @staticmethod
    async def _line(one: _Input, errors: str = "replace") -> str:
        line = await one.reader.readline()
        one.sender.spend(_EACH)
        with one.sender.measured():
            return line.decode("utf-8", errors)

    @staticmethod
    def _checked(command: _Command) -> _Command:
        if len(command) > _LARGEST_COMMAND:
            raise wire.WireError(f"a command has {len(command)} bytes, expected at most {_LARGEST_COMMAND}")
        return command

    def _data(self, one: _Input, read: Callable[[_T], list[object]], data: _T) -> None:
        if self._take is None:
            return
        try:
            self._take(read(data), len(data))  # type: ignore[arg-type] # text or bytes
        except BottleError as error:
            self._complaints.warn("read", f"yarp: a message of {shown(one.source)} to {self.name} is refused: {error}")

    # -- administration ----------------------------------------------------------------------

    async def _short(self, command: str) -> str:
        """A command of one word: ``/reader`` connects, ``!/reader`` disconnects, ``*`` describes the port."""
        if command.startswith(("/", "tcp:", "fast_tcp:")):
            return str((await self._add(command, ""))[1]).strip()
        if command.startswith("!/"):
            return str(self._remove(command[1:])[1]).strip()
        if command == "*":
            ways = [f"There is a connection from {self.name} to {name}" for name in self.outputs]
            ways += [f"There is a connection from {one.source} to {self.name}" for one in self._inputs]
            return "\r\n".join([f"This is {self.name}", *ways])
        return "Port command not understood."

    async def _administer(self, command: list[object]) -> list[Any]:
        words = [str(word) for word in command] + ["", "", ""]
        if words[0] == "ver":
            return _VERSION
        if words[0] == "help":
            return _HELP
        if words[0] == "add":
            return await self._add(words[1], words[2])
        if words[0] == "del":
            return self._remove(words[1])
        if words[0] == "list":
            return self._list(words[1] or "out", words[2])
        if words[:2] == ["prop", "get"]:
            return []
        return [Vocab("fail"), "send [help] for list of valid commands"]

    def _list(self, direction: str, name: str) -> list[object]:
        if direction == "in":
            ways = [(one.source, self.name, one.carrier) for one in self._inputs if one.source.startswith("/")]
        else:
            ways = [(self.name, output.target, output.carrier) for output in self.outputs.values()]
        if not name:
            return [way[0 if direction == "in" else 1] for way in ways]
        for way in ways:
            if name in way[:2]:
                return [[key, value] for key, value in zip(("from", "to", "carrier"), way, strict=True)]
        return []

    async def _add(self, target: str, carrier: str) -> list[object]:
        match = _TARGET.match(target)
        if match is None:
            return [-1, f"Do not know how to connect to {target}\r\n"]
        name, carrier = match[2], carrier or match[1] or wire.TCP
        if carrier not in _CARRIERS:
            return [-1, f"Do not know how to use the carrier {carrier}; {self.name} sends by tcp and fast_tcp\r\n"]
        if len(self.outputs) >= _MOST_CONNECTIONS:
            return [-1, f"{self.name} has {_MOST_CONNECTIONS} connections\r\n"]
        if not DESCRIPTORS.has_room(measure=True):
            return [-1, f"{self.name} has no place for one more connection: too many files are open\r\n"]
        output = Output(self.name, name, carrier, self._lost, self._slow)
        try:
            address = await self._names.query(name)
            if address is None:
                return [-1, f"Do not know how to connect to {name}\r\n"]
            await output.open(address)
        except (OSError, ValueError) as error:
            return [-1, f"Cannot connect to {name}: {error}\r\n"]
        # only the connection to the same port, not those from a port that claims this name
        former = self.outputs.pop(name, None)
        if former is not None:
            former.close()
        self.outputs[name] = output
        logger.info("yarp: %s sends to %s", self.name, name)
        return [0, f"Added connection from {self.name} to {name}\r\n"]

    def _remove(self, name: str) -> list[object]:
        output = self.outputs.pop(name, None)
        for one in [one for one in self._inputs if one.source == name]:
            one.writer.close()
            return [0, f"Removing connection from {name} to {self.name}\r\n"]
        if output is None:
            return [-1, f"Could not find a connection from {self.name} to {name}\r\n"]
        output.close()
        return [0, f"Removing connection from {self.name} to {name}\r\n"]

    def _lost(self, output: Output) -> None:
        if self.outputs.get(output.target) is output:
            del self.outputs[output.target]

    def _slow(self, output: Output) -> None:
        text = f"yarp: {output.target} is too slow for {self.name}: messages are lost"
        self._complaints.warn(f"slow {output.target}", text)
