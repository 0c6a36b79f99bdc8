"""Writes a recording to the disk in its own thread."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING

from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter

if TYPE_CHECKING:
    from collections.abc import Callable
    from io import FileIO

    _Item = Message | Callable[[McapWriter], object]

#: wall-clock seconds between two chunks: limits the loss if the process is killed, with a margin for the writing itself
_INTERVAL = 0.5
#: approximate size of a chunk, bytes
_CHUNK = 4 << 20
#: maximum number of bytes that wait for the disk; then the simulation waits
_MOST_WAITING = 64 << 20
#: approximate overhead of a message, bytes
_OVERHEAD = 64


class Disk:
    """Writes messages in order, at least twice per second.

    No data are lost while the disk is slow: the caller waits. After an error of the disk, for example if it is full,
    all later data are dropped, and `error` contains the reason.

    Args:
        file: opened for writing without a buffer; closed at the end.

    Attributes:
        error: the error of the operating system, or None.
        waits: number of times that a writer had to wait.

    Raises:
        OSError: the file cannot be written.
    """

    def __init__(self, file: FileIO) -> None:
        self._file = file
        self.error: OSError | None = None
        self.waits = 0
        self._writer = McapWriter(file)
        self._items: deque[_Item] = deque()
        self._given = self._taken = 0  # bytes; each is written by one thread only
        self._wake, self._room = threading.Event(), threading.Event()
        self._ending = False
        self._thread = threading.Thread(target=self._run, name="morse-recording", daemon=True)
        self._thread.start()

    def message(self, one: Message) -> None:
        """Queue a message."""
        self._items.append(one)
        self._given += len(one.data) + _OVERHEAD
        if self._given - self._taken > _CHUNK:
            self._wake.set()
            if self._given - self._taken > _MOST_WAITING:
                self._wait()

    def other(self, write: Callable[[McapWriter], object]) -> None:
        """Queue another operation, after all previous messages."""
        self._items.append(write)

    def _wait(self) -> None:
        self.waits += 1
        while self._given - self._taken > _MOST_WAITING // 2 and self._thread.is_alive():
            self._room.wait(_INTERVAL)
            self._room.clear()

    def close(self) -> None:
        """Write the remaining data and the index; wait until that is done."""
        self._ending = True
        self._wake.set()
        self._thread.join()

    # -- the thread --------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            while not self._ending:
                self._wake.wait(_INTERVAL)
                self._wake.clear()
                self._drain()
            self._drain()
            self._attempt(self._writer.finish)
        finally:
            self._file.close()

    def _drain(self) -> None:
        """Write all queued messages, chunk by chunk."""
        messages: list[Message] = []
        size = 0
        while self._items:
            item = self._items.popleft()
            if isinstance(item, Message):
                messages.append(item)
                size += len(item.data) + _OVERHEAD
            if size >= _CHUNK or not isinstance(item, Message):
                self._chunk(messages, size)
                messages, size = [], 0
            if not isinstance(item, Message):
                self._attempt(lambda write=item: write(self._writer))  # type: ignore[misc]
        self._chunk(messages, size)

    def _chunk(self, messages: list[Message], size: int) -> None:
        self._attempt(lambda: self._writer.chunk(messages))
        self._taken += size
        self._room.set()

    def _attempt(self, write: Callable[[], object]) -> None:
        if self.error is not None:
            return
        try:
            write()
        except OSError as error:
            self.error = error
            self._end_well()

    def _end_well(self) -> None:
        """Try to write the index: it may still fit."""
        try:
            self._writer.finish()
        except OSError:
            return
