"""MAVLink FTP: the files of a vehicle, which are photos, for reading only."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.plugins.mavlink.framing import MavlinkMessage
    from morse.plugins.mavlink.vehicle import Vehicle

_HEAD = struct.Struct("<HBBBBBxI")
_PAYLOAD = 251
#: bytes of a file or a list in a packet
_ROOM = _PAYLOAD - _HEAD.size
#: operations
_NONE, _TERMINATE, _RESET, _LIST, _OPEN, _READ, _CRC, _BURST = 0, 1, 2, 3, 4, 5, 14, 15
#: those that write: create, write, remove, make and remove a folder, open for writing, truncate, rename
_WRITING = (6, 7, 8, 9, 10, 11, 12, 13)
_ACK, _NAK = 128, 129
#: errors
_INVALID_SIZE, _INVALID_SESSION, _END_OF_FILE, _UNKNOWN, _PROTECTED, _NOT_FOUND = 3, 4, 6, 7, 9, 10
#: each ground station has one open file, as with PX4, whose session is 0: the clients of MAVSDK use no other one
_SESSION = 0
#: ground stations with an open file, of which the oldest one is closed; packets of a burst in a tick
_MOST_OPEN, _MOST_BURST = 8, 32


class _Request(NamedTuple):
    sender: tuple[int, int]
    component: int
    number: int
    session: int
    operation: int
    size: int
    offset: int
    data: bytes

    @property
    def path(self) -> str:
        return self.data[: self.size].split(b"\0", 1)[0].decode("utf-8", "replace").strip("/")


class Files:
    """Answers FILE_TRANSFER_PROTOCOL.

    Args:
        vehicle: sends the answers.
        contents: bytes by path, without a leading slash.
    """

    def __init__(self, vehicle: Vehicle, contents: Mapping[str, bytes]) -> None:
        self._vehicle, self._contents = vehicle, contents
        self._open: dict[tuple[int, int], bytes] = {}
        self._burst: _Request | None = None

    def take(self, message: MavlinkMessage) -> None:
        """Answer a request."""
        payload = bytes(message.payload)
        number, session, operation, size, *_, offset = _HEAD.unpack_from(payload)
        if operation >= _ACK:
            return
        sender = message.get_srcSystem(), message.get_srcComponent()
        component = message.target_component or 1
        request = _Request(sender, component, number, session, operation, size, offset, payload[_HEAD.size :])
        if size > _ROOM:
            self._refuse(request, _INVALID_SIZE)
        elif operation in (_NONE, _TERMINATE, _RESET):
            self._close(request)
        elif operation == _LIST:
            self._list(request)
        elif operation in (_OPEN, _CRC):
            self._open_file(request)
        elif operation in (_READ, _BURST):
            self._read(request)
        else:
            self._refuse(request, _PROTECTED if operation in _WRITING else _UNKNOWN)

    def tick(self) -> None:
        """Send the packets of the burst that was requested last."""
        request, self._burst = self._burst, None
        if request is None:
            return
        content = self._open.get(request.sender, b"")
        size = min(request.size or _ROOM, _ROOM)
        for count in range(_MOST_BURST):
            offset = request.offset + count * size
            answer = request._replace(number=request.number + count, offset=offset)
            if offset >= len(content):
                self._refuse(answer, _END_OF_FILE)
                return
            self._answer(answer, content[offset : offset + size], is_last=count == _MOST_BURST - 1)

    def _close(self, request: _Request) -> None:
        if request.operation != _NONE:
            self._open.pop(request.sender, None)
        self._answer(request)

    def _list(self, request: _Request) -> None:
        folder = f"{request.path}/" if request.path else ""
        below = [path[len(folder) :] for path in self._contents if path.startswith(folder)]
        if folder and not below:
            self._refuse(request, _NOT_FOUND)
            return
        entries = {
            f"D{name.partition('/')[0]}" if "/" in name else f"F{name}\t{len(self._contents[folder + name])}": None
            for name in below
        }
        page = b""
        for entry in list(entries)[request.offset :]:
            line = entry.encode() + b"\0"
            if len(page) + len(line) > _ROOM:
                break
            page += line
        if page:
            self._answer(request, page)
        else:
            self._refuse(request, _END_OF_FILE)

    def _open_file(self, request: _Request) -> None:
        content = self._contents.get(request.path)
        if content is None:
            self._refuse(request, _NOT_FOUND)
        elif request.operation == _CRC:
            # without the inversions of zlib, as autopilots compute it
            self._answer(request, struct.pack("<I", zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF))
        else:
            self._open.pop(request.sender, None)
            if len(self._open) >= _MOST_OPEN:
                del self._open[next(iter(self._open))]
            self._open[request.sender] = content
            self._answer(request._replace(session=_SESSION), struct.pack("<I", len(content)))

    def _read(self, request: _Request) -> None:
        content = self._open.get(request.sender)
        if content is None or request.session != _SESSION:
            self._refuse(request, _INVALID_SESSION)
        elif request.offset >= len(content):
            self._refuse(request, _END_OF_FILE)
        elif request.operation == _BURST:
            self._burst = request
        else:
            self._answer(request, content[request.offset : request.offset + min(request.size or _ROOM, _ROOM)])

    def _refuse(self, request: _Request, error: int) -> None:
        self._answer(request, bytes((error,)), code=_NAK)

    def _answer(self, request: _Request, data: bytes = b"", *, code: int = _ACK, is_last: bool = False) -> None:
        number = (request.number + 1) & 0xFFFF
        head = _HEAD.pack(number, request.session, code, len(data), request.operation, is_last, request.offset)
        payload = list((head + data).ljust(_PAYLOAD, b"\0"))
        self._vehicle.send_from(request.component, "file_transfer_protocol", 0, *request.sender, payload)
