"""Parses the fields of a record without reading beyond the end of the bytes."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

from morse.recording.errors import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterator


class Fields:
    """The content of one record.

    Args:
        data: the bytes.
        what: name of the record, for error messages.
    """

    def __init__(self, data: bytes | memoryview, what: str) -> None:
        self._data = memoryview(data)
        self._what = what
        self._at = 0

    @property
    def left(self) -> int:
        """The number of unread bytes."""
        return len(self._data) - self._at

    def bytes(self, count: int) -> memoryview:
        """Read bytes.

        Raises:
            RecordingError: fewer bytes are left.
        """
        if count > self.left:
            raise RecordingError(f"{self._what} is damaged: {count} bytes expected, {self.left} left")
        begin, self._at = self._at, self._at + count
        return self._data[begin : self._at]

    def numbers(self, form: str) -> tuple[Any, ...]:
        """Numbers, in a format of `struct`."""
        layout = struct.Struct(form)
        return layout.unpack(self.bytes(layout.size))

    def text(self) -> str:
        """A string."""
        (size,) = self.numbers("<I")
        try:
            return str(self.bytes(size), "utf-8", "surrogateescape")
        except ValueError as error:
            raise RecordingError(f"{self._what} is damaged: {error}") from None

    def table(self) -> dict[str, str]:
        """A map of strings."""
        (size,) = self.numbers("<I")
        inner = Fields(self.bytes(size), self._what)
        entries = {}
        while inner.left:
            key = inner.text()
            entries[key] = inner.text()
        return entries

    def records(self) -> Iterator[tuple[int, memoryview]]:
        """The records in these bytes: opcode and content.

        Raises:
            RecordingError: they are damaged.
        """
        while self.left:
            opcode, size = self.numbers("<BQ")
            if not opcode:
                # many zeros take few bytes in a file, and would be millions of empty records
                raise RecordingError(f"{self._what} is damaged: no record has the opcode 0")
            yield opcode, self.bytes(size)
