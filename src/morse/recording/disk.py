"""Writes a recording to the disk in its own thread."""

from __future__ import annotations

import errno
import threading
import time
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from morse.kernel.recording import records
from morse.recording.captures import Moments
from morse.recording.gathering import VALUES, Gathered, Memory
from morse.recording.mcap.records import Message
from morse.recording.mcap.writer import McapWriter

if TYPE_CHECKING:
    from collections.abc import Callable
    from io import FileIO


#: wall-clock seconds between two chunks: limits the loss if the process is killed, with a margin for the writing itself
_INTERVAL = 0.5
#: approximate size of a chunk, bytes
CHUNK = 16 << 20
#: above this rate, bytes per wall-clock second, less time is spent on compression: the simulation runs as fast as
#: possible, and waits if the recording cannot keep up
_QUICK = 4e6
#: maximum number of bytes that wait for the disk; then the simulation waits
_MOST_WAITING = 64 << 20
#: approximate overhead of a message, bytes
_OVERHEAD = 100


class _Passed(NamedTuple):
    """The end of a chunk.

    Attributes:
        given: number of bytes that were queued until then.
    """

    given: int


_Item: TypeAlias = "Message | Moments | _Passed | Callable[[McapWriter], object]"
#: takes the place of the number of a tick
_OTHER = -1
_NOTHING = (None,) * (VALUES - 2)


class Disk:
    """Writes messages in order, at least twice per second.

    No data are lost while the disk is slow: the caller waits. After an error of the disk, for example if it is full,
    all later data are dropped, and `error` contains the reason.

    Args:
        file: opened for writing without a buffer; closed at the end.

    Attributes:
        error: the error of the operating system, or None.
        waits: number of times that a writer had to wait.
        queue: ticks, which are encoded later, and other things in the order of the simulation: a flat list with
            `VALUES` values of each, which have to be appended by one operation. The caller has to call `pass_on`.
    """

    def __init__(self, file: FileIO) -> None:
        self._file = file
        self.error: OSError | None = None
        self.waits = 0
        self._writer = McapWriter(file)
        # each operation on a list is atomic: other threads append, and only the thread of the disk removes
        self.queue: list[Any] = []
        self._held = self._given = self._taken = 0  # bytes; only the thread writes the last one
        self._native = records()
        self._moments: Moments | None = None
        self._gathered = self._new()
        self._memory = Memory()
        self._written = time.monotonic()
        self._wake, self._room = threading.Event(), threading.Event()
        self._ending = False
        self._thread = threading.Thread(target=self._run, name="morse-recording", daemon=True)
        self._thread.start()

    def message(self, one: Message) -> None:
        """Queue a message."""
        self._put(one)
        self._held += _OVERHEAD + len(one.data)
        if self._held > CHUNK:
            self.pass_on(self._held)
            self._held = 0

    def other(self, write: Callable[[McapWriter], object]) -> None:
        """Queue another operation, after all previous messages."""
        self._put(write)

    def begin(self, moments: Moments) -> None:
        """Set the times of the following ticks."""
        self._put(moments)

    def _put(self, item: _Item) -> None:
        self.queue += (_OTHER, item, *_NOTHING)

    def pass_on(self, size: int) -> None:
        """End a chunk, and wait if too many bytes are queued.

        Args:
            size: approximate memory of the data that were queued since the last call, bytes.
        """
        self._given += size
        self._put(_Passed(self._given))
        self._wake.set()
        if self._given - self._taken > _MOST_WAITING:
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
            due = time.monotonic() + _INTERVAL
            while not self._ending:
                self._wake.wait(max(due - time.monotonic(), 0.0))
                self._wake.clear()
                self._drain()
                # all that was queued before a chunk is written with it
                due = max(due, self._written + _INTERVAL)
                if time.monotonic() >= due:
                    due = time.monotonic() + _INTERVAL
                    self._write()
            self._drain()
            self._write()
            self._attempt(self._writer.finish)
        finally:
            self._file.close()

    def _drain(self) -> None:
        """Take all that is queued, and write the chunks that have ended."""
        queue = self.queue
        while some := queue[:]:
            del queue[: len(some)]
            numbers = some[::VALUES]
            begin = 0
            for _ in range(numbers.count(_OTHER)):
                place = numbers.index(_OTHER, begin)
                self._gathered.ticks += some[VALUES * begin : VALUES * place]
                self._take(some[VALUES * place + 1])
                begin = place + 1
            self._gathered.ticks += some[VALUES * begin :] if begin else some

    def _take(self, item: _Item) -> None:
        if type(item) is Message:
            gathered = self._gathered
            gathered.messages.append((len(gathered.ticks) // VALUES, item))
        else:
            self._write()
            if type(item) is Moments:
                self._moments = item
                self._gathered = self._new()
            elif isinstance(item, _Passed):
                self._taken = item.given
                self._room.set()
            else:
                self._attempt(lambda: item(self._writer))  # type: ignore[operator]

    def _new(self) -> Gathered:
        return Gathered(self._moments, self._native)

    def _write(self) -> None:
        """Write the messages that were taken."""
        gathered, self._gathered = self._gathered, self._new()
        if gathered:
            self._attempt(lambda: self._chunk(gathered))

    def _chunk(self, gathered: Gathered) -> None:
        now = time.monotonic()
        elapsed, self._written = now - self._written, now

        def is_quick(size: int) -> bool:
            return size > _QUICK * elapsed

        encoded = gathered.encoded(self._memory, is_quick)
        plain, index = encoded.plain, encoded.positions
        if encoded.packed is None:
            self._writer.encoded(plain.data, index, quickly=is_quick(len(plain)))
        else:
            self._writer.packed(encoded.packed.data, encoded.size, len(plain), index)

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
