"""Writes a recording to the disk in its own thread."""

from __future__ import annotations

import errno
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any

from morse.recording.gathering import Gathered, Memory
from morse.recording.mcap.writer import McapWriter

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from io import FileIO

    import numpy as np
    from numpy.typing import NDArray

    from morse.recording.captures import Capture, Layout, Moments
    from morse.recording.mcap.records import Message

    _Item = Gathered | Callable[[McapWriter], object]

#: wall-clock seconds between two chunks: limits the loss if the process is killed, with a margin for the writing itself
_INTERVAL = 0.5
#: approximate size of a chunk, bytes
_CHUNK = 4 << 20
#: above this rate, bytes per wall-clock second, less time is spent on compression: the simulation runs as fast as
#: possible, and waits if the recording cannot keep up
_QUICK = 4e6
#: maximum number of bytes that wait for the disk; then the simulation waits
_MOST_WAITING = 64 << 20
#: maximum number of ticks of a chunk
_MOST_TICKS = 2048


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
        self._given = self._taken = 0  # bytes; only the thread writes the second
        #: locked while messages are collected, and while their chunk is closed
        self._lock = threading.Lock()
        self._gathered = Gathered()
        self._memory = Memory()
        self._written = time.monotonic()
        self._wake, self._room = threading.Event(), threading.Event()
        self._ending = False
        self._thread = threading.Thread(target=self._run, name="morse-recording", daemon=True)
        self._thread.start()

    def message(self, one: Message) -> None:
        """Queue a message."""
        with self._lock:
            gathered = self._gathered
            gathered.message(one)
        if gathered.held > _CHUNK:
            self._pass_on()

    def keep(
        self,
        layout: Layout,
        tick: int,
        moments: Moments,
        positions: NDArray[np.float64],
        rotations: NDArray[np.float64],
        scans: Sequence[tuple[Capture, Any]] | None,
    ) -> None:
        """Queue the messages of a tick, which are encoded later.

        Args:
            layout: the records of the tick.
            tick: its number.
            moments: computes its time.
            positions, rotations: (K, 3) m and (K, 9) of the rigid groups of the layout; arrays that never change.
            scans: captures, and their data, which never change.
        """
        with self._lock:
            gathered = self._gathered
            if gathered.window is not layout.window or gathered.moments is not moments:
                if gathered.ticks:
                    gathered = self._begin_chunk()
                gathered.window, gathered.moments = layout.window, moments
            gathered.ticks.append((tick, layout))
            gathered.positions.append(positions)
            gathered.rotations.append(rotations)
            if scans is not None:
                for capture, distances in scans:
                    gathered.scans.setdefault(capture, []).append(distances)
            held = gathered.held = gathered.held + layout.held
        if held > _CHUNK or len(gathered.ticks) >= _MOST_TICKS:
            self._pass_on()

    def other(self, write: Callable[[McapWriter], object]) -> None:
        """Queue another operation, after all previous messages."""
        self._close_chunk()
        self._items.append(write)

    def _pass_on(self) -> None:
        """Close the chunk, and wait if too many bytes are queued."""
        self._close_chunk()
        self._wake.set()
        if self._given - self._taken > _MOST_WAITING:
            self.waits += 1
            while self._given - self._taken > _MOST_WAITING // 2 and self._thread.is_alive():
                self._room.wait(_INTERVAL)
                self._room.clear()

    def _close_chunk(self) -> None:
        """Append the collected messages to the items, and start a new chunk."""
        with self._lock:
            if self._gathered:
                self._begin_chunk()

    def _begin_chunk(self) -> Gathered:
        """The same; the caller holds the lock."""
        self._given += self._gathered.held
        self._items.append(self._gathered)
        self._gathered = Gathered()
        return self._gathered

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
                if time.monotonic() >= due:
                    due = time.monotonic() + _INTERVAL
                    self._close_chunk()
                self._drain()
            self._close_chunk()
            self._drain()
            self._attempt(self._writer.finish)
        finally:
            self._file.close()

    def _drain(self) -> None:
        """Write all queued chunks and operations."""
        while self._items:
            item = self._items.popleft()
            if isinstance(item, Gathered):
                self._attempt(lambda item=item: self._chunk(item))  # type: ignore[misc]
                self._taken += item.held
                self._room.set()
            else:
                self._attempt(lambda item=item: item(self._writer))  # type: ignore[misc]

    def _chunk(self, gathered: Gathered) -> None:
        plain, index = gathered.encoded(self._memory)
        now = time.monotonic()
        rate, self._written = len(plain) / max(now - self._written, 1e-6), now
        self._writer.encoded(plain.data, index, quickly=rate > _QUICK)

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
