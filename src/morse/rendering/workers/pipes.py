"""Messages through pipes, each after its length."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import IO

_LENGTH = struct.Struct("<Q")
#: bytes of the largest message; a length beyond it is no length, but something else that was written into the pipe
_MOST = 1 << 32


def send(pipe: IO[bytes], message: bytes) -> None:
    """Write a message.

    Raises:
        BrokenPipeError: nobody reads.
    """
    for part in (_LENGTH.pack(len(message)), message):
        rest = memoryview(part)
        while rest:
            rest = rest[pipe.write(rest) :]
    pipe.flush()


def receive(pipe: IO[bytes]) -> bytearray:
    """Read a message.

    Raises:
        EOFError: the other end is closed, or writes something else.
    """
    (length,) = _LENGTH.unpack(_read(pipe, _LENGTH.size))
    if length > _MOST:
        raise EOFError(f"a message of {length} bytes is announced")
    return _read(pipe, length)


def _read(pipe: IO[bytes], length: int) -> bytearray:
    message = bytearray(length)
    rest = memoryview(message)
    while rest:
        count = pipe.readinto(rest)  # type: ignore[attr-defined] # a file of bytes
        if not count:
            raise EOFError
        rest = rest[count:]
    return message
