"""Writes a recording to the disk in its own thread."""

from __future__ import annotations

import errno
import threading
import time
from typing import TYPE_CHECKING, Any, Protocol

from morse.recording.mcap.writer import McapWriter, chunk_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from io import FileIO

    from morse.recording.mcap.writer import Messages


#: wall-clock seconds between two chunks: limits the loss if the process is killed, with a margin for the writing itself
_INTERVAL = 0.5
#: approximate size of a chunk, bytes
CHUNK = 4 << 20
#: maximum number of bytes that wait for the disk; then the simulation waits
_MOST_WAITING = 64 << 20


class Source(Protocol):
    """What a simulation has kept."""

    #: number of the last complete tick
    complete: int

    def take(self, until: int | None) -> list[Messages]:
        """Take what was kept up to a tick, or everything; called in the thread of the disk."""


class Disk:
    """Writes messages in order, at least twice per second.

    No data are lost while the disk is slow: the caller waits. After an error of the disk, for example if it is full,
    all later data are dropped, and `error` contains the reason.

    Args:
        file: opened for writing without a buffer; closed at the end.

    Attributes:
        error: the error of the operating system, or None.
        waits: number of times that a writer had to wait.
        until: log time of the last message in the file, ns; None before the first one.
    """

    def __init__(self, file: FileIO) -> None:
        self._file = file
        self.error: OSError | None = None
        self.waits = 0
        self.until: int | None = None
        self._source: Source | None = None
        self._writer = McapWriter(file)
        # each operation on a list is atomic: other threads append, and only the thread of the disk removes
        self._operations: list[Callable[[McapWriter], object]] = []
        #: ends of chunks: number of a tick, None for everything; number of bytes that were kept until then
        self._ends: list[tuple[int | None, int]] = []
        self._bytes_in = self._bytes_out = 0  # bytes; only the thread writes the last one
        self._last_write = time.monotonic()
        self._wake, self._room = threading.Event(), threading.Event()
        self._ending = False
        self._thread = threading.Thread(target=self._run, name="morse-recording", daemon=True)

    def begin(self, source: Source) -> None:
        """Begin to write what a source has kept."""
        self._source = source
        self._thread.start()

    def other(self, write: Callable[[McapWriter], object]) -> None:
        """Queue another operation, before all messages that are not written yet."""
        self._operations.append(write)

    def pass_on(self, size: int, tick: int | None) -> None:
        """End a chunk, and wait if too many bytes are kept.

        Args:
            size: approximate number of bytes that were kept since the last call.
            tick: number of the last tick of the chunk; None for everything, which is then waited for.
        """
        self._bytes_in += size
        self._ends.append((tick, self._bytes_in))
        self._wake.set()
        most = _MOST_WAITING if tick is not None else -1
        if self._bytes_in - self._bytes_out > most or (tick is None and self._ends):
            self.waits += tick is not None
            while (
                self._ends if tick is None else self._bytes_in - self._bytes_out > most // 2
            ) and self._thread.is_alive():
                self._room.wait(_INTERVAL)
                self._room.clear()

    def close(self) -> None:
        """Write the remaining data and the index; wait until that is done."""
        self._ending = True
        self._wake.set()
        if self._thread.ident is None:  # the recording could not begin
            self._file.close()
        else:
            self._thread.join()

    # -- the thread --------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            due = time.monotonic() + _INTERVAL
            while not self._ending:
                self._wake.wait(max(due - time.monotonic(), 0.0))
                self._wake.clear()
                self._pass()
                # all that was kept before a chunk is written with it
                due = max(due, self._last_write + _INTERVAL)
                if time.monotonic() >= due:
                    due = time.monotonic() + _INTERVAL
                    self._write(self._source.complete if self._source else 0)
            self._pass()
            self._write(None)
            self._attempt(self._writer.finish)
        finally:
            self._file.close()
            self._ends.clear()
            self._room.set()

    def _pass(self) -> None:
        """Write the chunks that have ended."""
        while self._ends:
            tick, size = self._ends[0]
            self._write(tick)
            self._bytes_out = size
            del self._ends[0]
            self._room.set()

    def _write(self, until: int | None) -> None:
        while self._operations:
            self._attempt(lambda: self._operations[0](self._writer))
            del self._operations[0]
        self._attempt(lambda: self._chunk(until))

    def _chunk(self, until: int | None) -> None:
        assert self._source is not None
        messages: list[Any] = self._source.take(until)
        while self._operations:  # the channels of these messages
            self._operations.pop(0)(self._writer)
        self._last_write = time.monotonic()
        if messages:
            chunk, index = chunk_of(messages)
            self._writer.encoded(chunk.data, index)
            self.until = index.end

    def _attempt(self, write: Callable[[], object]) -> None:
        if self.error is not None:
            return
        try:
            write()
        except OSError as error:
            self.error = error
            self._end_well()
        except Exception as error:  # an internal error: the recording ends with this error
            self.error = OSError(errno.EIO, f"a message cannot be encoded ({type(error).__name__}: {error})")
            self._end_well()

    def _end_well(self) -> None:
        """Try to write the index: it may still fit."""
        try:
            self._writer.finish()
        except OSError:
            return
