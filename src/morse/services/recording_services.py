"""Services that record the run; part of the pseudo component ``simulation``."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseError, MorseRPCInvokationError
from morse.core.services import service
from morse.core.validation.names import check_stored_name

if TYPE_CHECKING:
    from morse.recording.recorder import Recorder

LEAST = 256 << 20
"""Free bytes on the disk below which clients may not create files."""


def file_of(name: str) -> Path:
    """The path of a file in the folder in which the simulation was started.

    Raises:
        MorseRPCInvokationError: the folder was deleted.
    """
    try:
        return Path(name).absolute()
    except OSError:  # the system does not know the path of the folder any more
        raise MorseRPCInvokationError(
            f"the folder in which the simulation was started was deleted, so that there is no place for {name}"
        ) from None


def check_room(path: Path) -> None:
    """Check that a client may create a file.

    Raises:
        MorseRPCInvokationError: the disk is almost full.
    """
    try:
        free = shutil.disk_usage(os.path.dirname(path)).free
    except OSError:
        return  # the file cannot be created either, which is reported then
    if free < LEAST:
        raise MorseRPCInvokationError(
            f"{path.name} is not written: only {free >> 20} MB are free on the disk, expected at least {LEAST >> 20} MB"
        )


_SUFFIX = ".mcap"
_MOST_NAMES = 100


class Recordable(Protocol):
    """The part of a simulation that the services need."""

    def record(self, path: Path) -> Recorder:
        """Record the run in a file."""


class RecordingServices(AbstractObject):
    """Starts and stops one recording, in the folder in which the simulation was started."""

    def __init__(self, simulation: Recordable) -> None:
        super().__init__()
        self._simulation = simulation
        self._recorder: Recorder | None = None
        #: the last number of each name
        self._numbers: dict[Path, int] = {}

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @property
    def path(self) -> str | None:
        """The path of the recording that `stop_recording` ends; None if there is no recording."""
        return self._recorder.path if self._recorder is not None and self._recorder.running else None

    @service(changes=False)
    def start_recording(self, name: str = "recording") -> str:
        """Record sensors, frames, log and inputs from now on.

        Args:
            name: name of the file without ``.mcap``: letters, digits, ``_``, ``-`` and dots. If the file exists, a
                number is added to the name, because recordings never overwrite files.

        Returns:
            The path of the file.
        """
        check_stored_name(name, "recording")
        if self._recorder is not None and self._recorder.running:
            raise MorseRPCInvokationError(f"{self._recorder.path} is already being recorded: call stop_recording first")
        path = self._new_path(name.removesuffix(_SUFFIX))
        check_room(path)
        try:
            self._recorder = self._simulation.record(path)
        except MorseError as error:
            raise MorseRPCInvokationError(str(error)) from None
        return str(path)

    def _new_path(self, stem: str) -> Path:
        first = file_of(stem + _SUFFIX)
        if not first.exists():
            return first
        # the numbers of earlier recordings are not tried again: there may be thousands
        number = self._numbers.get(first, 2)
        while (path := first.with_name(f"{stem}-{number}{_SUFFIX}")).exists():
            number += 1
        if len(self._numbers) >= _MOST_NAMES:
            self._numbers.clear()
        self._numbers[first] = number
        return path

    @service(changes=False)
    def stop_recording(self) -> str:
        """Complete the recording that `start_recording` began, and return the path of its file."""
        recorder, self._recorder = self._recorder, None
        if recorder is None:
            raise MorseRPCInvokationError("nothing is being recorded: call start_recording first")
        try:
            recorder.stop()
        except MorseError as error:
            raise MorseRPCInvokationError(str(error)) from None
        return str(recorder.path)
