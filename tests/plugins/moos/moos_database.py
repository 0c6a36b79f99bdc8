"""A MOOS database in Python, by the protocol of the C++ one; for tests.

A client sends 32 bytes with the name of the protocol and a packet with its name, and is welcomed. Then it sends
packets, and each is answered by one: with the values of the variables it has registered. All numbers are little-endian.
"""

from __future__ import annotations

import socket
import struct
import threading
from typing import NamedTuple

PROTOCOL = b"ELKS CAN'T DANCE 2/8/10".ljust(32, b"\0")
NOTIFY, REGISTER, UNREGISTER, NULL, WELCOME = b"NRU.W"


class Note(NamedTuple):
    kind: int
    form: int
    key: str
    number: float
    text: bytes
    source: str


def _string(data: bytes) -> bytes:
    return struct.pack("<i", len(data)) + data


def packed(notes: list[Note]) -> bytes:
    body = b""
    for number, note in enumerate(notes):
        strings = [note.source.encode(), b"", b"harbour", note.key.encode()]
        inner = struct.pack("<iBB", number, note.kind, note.form) + b"".join(map(_string, strings))
        inner += struct.pack("<3d", 1.0, note.number, 0.0) + _string(note.text)
        body += struct.pack("<i", len(inner) + 4) + inner
    return struct.pack("<iiB", len(body) + 9, len(notes), 0) + body


def unpacked(data: bytes) -> list[Note]:
    (count,) = struct.unpack_from("<i", data, 0)
    at, notes = 5, []
    for _ in range(count):
        size, _, kind, form = struct.unpack_from("<iiBB", data, at)
        place, strings = at + 10, []
        for _ in range(4):
            (length,) = struct.unpack_from("<i", data, place)
            strings.append(data[place + 4 : place + 4 + length].decode())
            place += 4 + length
        _, number, _ = struct.unpack_from("<3d", data, place)
        (length,) = struct.unpack_from("<i", data, place + 24)
        notes.append(Note(kind, form, strings[3], number, data[place + 28 : place + 28 + length], strings[0]))
        at += size
    return notes


class Client(threading.Thread):
    def __init__(self, database: Database, connection: socket.socket) -> None:
        super().__init__(daemon=True)
        self.database, self.connection = database, connection
        self.name_in_community = ""
        self.registered: set[str] = set()
        self.pending: list[Note] = []

    def _read(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            part = self.connection.recv(count - len(data))
            if not part:
                raise OSError("closed")
            data += part
        return data

    def _packet(self) -> list[Note]:
        (size,) = struct.unpack("<i", self._read(4))
        return unpacked(self._read(size - 4))

    def run(self) -> None:
        try:
            assert self._read(32) == PROTOCOL
            (hello,) = self._packet()
            self.name_in_community = hello.text.decode()
            self.connection.sendall(packed([Note(WELCOME, ord("D"), "", 0.0, b"", "MOOSDB")]))
            while True:
                for note in self._packet():
                    self.database.take(self, note)
                with self.database.lock:
                    notes, self.pending = self.pending, []
                self.connection.sendall(
                    self.database.wrong or packed(notes or [Note(NULL, 68, "", 0.0, b"", "MOOSDB")])
                )
        except OSError:
            self.connection.close()


class Database:
    """Listens on a port of the loopback interface that is free at the start."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.values: dict[str, Note] = {}
        self.changed = threading.Condition(self.lock)
        self.clients: list[Client] = []
        #: bytes that are sent instead of each packet
        self.wrong = b""
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = self._server.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self._server.accept()
            except OSError:
                return
            client = Client(self, connection)
            with self.lock:
                self.clients.append(client)
            client.start()

    def take(self, sender: Client, note: Note) -> None:
        with self.lock:
            if note.kind == NOTIFY:
                self.values[note.key] = note
                for client in self.clients:
                    if note.key in client.registered:
                        client.pending.append(note)
                self.changed.notify_all()
            elif note.kind == REGISTER:
                sender.registered.add(note.key)
                if note.key in self.values:
                    sender.pending.append(self.values[note.key])
                self.changed.notify_all()
            elif note.kind == UNREGISTER:
                sender.registered.discard(note.key)

    def publish(self, key: str, value: float | str) -> None:
        text = value.encode() if isinstance(value, str) else b""
        form = ord("S") if isinstance(value, str) else ord("D")
        self.take(self.clients[0], Note(NOTIFY, form, key, 0.0 if text else float(value), text, "test"))

    def close(self) -> None:
        self._server.close()
        for client in self.clients:
            client.connection.close()
