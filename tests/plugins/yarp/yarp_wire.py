"""The other side of the protocol of YARP, written after its documentation, with blocking sockets."""

import socket
import struct

LIMIT = 60.0


class Line:
    """A connection in text mode.

    Args:
        address: of a port.
        begin: ``CONNECT``, or ``CONNACK`` for a connection with acknowledgements.
    """

    def __init__(self, address: tuple[str, int], begin: str = "CONNECT", name: str = "test") -> None:
        self.socket = socket.create_connection(address, timeout=LIMIT)
        self._file = self.socket.makefile("rwb")
        self.say(f"{begin} {name}")
        self.welcome = self.hear()

    def say(self, *lines: str) -> None:
        for line in lines:
            self._file.write(line.encode() + b"\r\n")
        self._file.flush()

    def hear(self) -> str:
        return self._file.readline().decode().strip()

    def close(self) -> None:
        self._file.close()
        self.socket.close()


def exactly(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        part = connection.recv(size - len(data))
        if not part:
            raise EOFError
        data += part
    return data


def number(value: int) -> bytes:
    return b"YA" + struct.pack("<i", value) + b"RP"


class Reader:
    """A port to which other ports connect; it reads bottles of the carriers tcp and fast_tcp."""

    def __init__(self) -> None:
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(LIMIT)
        self.address = self._server.getsockname()
        self.acknowledges = True

    def accept(self) -> tuple[bytes, str]:
        """The first eight bytes of a connection, and the name of its sender."""
        self.connection, _ = self._server.accept()
        self.connection.settimeout(LIMIT)
        begin = exactly(self.connection, 8)
        (size,) = struct.unpack("<i", exactly(self.connection, 4))
        name = exactly(self.connection, size).rstrip(b"\0").decode()
        self.connection.sendall(number(self.address[1]))
        return begin, name

    def read(self) -> bytes:
        """The bottle of the next message."""
        assert exactly(self.connection, 8) == number(10)
        blocks, replies, *rest = exactly(self.connection, 10)
        assert rest == [255] * 8
        sizes = struct.unpack(f"<{blocks + replies}i", exactly(self.connection, 4 * (blocks + replies)))
        data = exactly(self.connection, sum(sizes))
        assert data[4:8] == b"~D\0\1"
        if self.acknowledges:
            self.connection.sendall(number(0))
        return data[8:]

    def close(self) -> None:
        self._server.close()
        if hasattr(self, "connection"):
            self.connection.close()
