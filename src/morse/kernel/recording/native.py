"""Records of many ticks, by C functions."""

from __future__ import annotations

from ctypes import c_int64
from typing import TYPE_CHECKING

from morse.kernel.recording.batch import Batch, Room
from morse.kernel.recording.functions import functions

if TYPE_CHECKING:
    import ctypes


class NativeRecords:
    """Writes records into a chunk. A thread has its own."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._run = library.morse_record_batch
        self._run.restype = c_int64
        self._functions = functions()
        self._room = Room()

    @property
    def measures_poses(self) -> bool:
        """Whether the functions of Python for angles are available."""
        return self._functions is not None

    def batch(self) -> Batch:
        """Return a batch without steps."""
        return Batch(self._run, self._functions, self._room)
