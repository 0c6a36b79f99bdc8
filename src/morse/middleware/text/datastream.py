"""Writes data streams to text files."""

from __future__ import annotations

import logging
import os
from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.classes.classpath import load_class
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.guard import Failure
from morse.core.mapping import maps
from morse.core.streams.kind_stream import KindStream
from morse.core.validation.names import file_name
from morse.middleware.text import STREAM_OPTIONS
from morse.system.free_names import free_path
from morse.system.regular_files import expanded
from morse.wire.encoding import written

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.kinds import Message
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.scene import StreamDeclaration


logger = logging.getLogger(__name__)


class TextFile:
    """A text file; on a full disk, the file ends, but not the simulation.

    Args:
        path: absolute path; an existing file is overwritten.
        owner: name of the component.
        note: keeps that the file ends, in words: what, the consequence and the reason.

    Raises:
        MorseMiddlewareError: it cannot be written.
    """

    def __init__(self, path: Path, owner: str, note: Callable[[str, str, str], object]) -> None:
        self.path, self.owner, self._note = path, owner, note
        self._is_new = True
        try:
            self._file = path.open("w", encoding="utf-8", errors="backslashreplace", newline="\n")
        except OSError as error:
            raise MorseMiddlewareError(
                f"the file {path} cannot be written: {error.strerror}; set another one: file='...'"
            ) from None
        self._is_over = False

    def begin(self, header: str) -> None:
        """Write the header, unless another component of the same name has begun the file."""
        if self._is_new:
            self.write(header)
        self._is_new = False

    def write(self, text: str) -> None:
        """Write a text; an error is logged, and ends the file."""
        if not self._is_over:
            try:
                self._file.write(text)
            except OSError as error:
                self._end(error)

    def flush(self) -> None:
        """Flush the file."""
        if not self._is_over:
            try:
                self._file.flush()
            except OSError as error:
                self._end(error)

    def _end(self, error: OSError) -> None:
        self._is_over = True
        reason = f"nothing more is written to {self.path}: {error.strerror}"
        logger.error("%s: %s", self.owner, reason)
        self._note(f"the file of {self.owner}", "ends", reason)

    def close(self) -> None:
        """Write the remaining data."""
        self.flush()
        try:
            self._file.close()
        except OSError as error:
            if not self._is_over:
                self._end(error)


class TextStream(KindStream):
    """Writes one component into a file.

    Attributes:
        file: set before `initialize`.
        index: number of written measurements.
    """

    options = STREAM_OPTIONS
    file: TextFile

    def initialize(self) -> None:
        """Write the header of the file."""
        super().initialize()
        self.index = 0
        self.file.begin(self.header())

    @abstractmethod
    def header(self) -> str:
        """The header of the file; may be empty."""

    @abstractmethod
    def encode_data(self) -> str:
        """A measurement, with a final line end."""


class Publisher(TextStream):
    """A line with the pose of the robot and the time, and below it a line for each data field."""

    def header(self) -> str:
        """Names of robot and sensor."""
        robot = self.component_instance.robot_parent
        return f"ROBOT {robot.name() if robot is not None else ''} || SENSOR {self.component_name}\n"

    def encode_data(self) -> str:
        """Position in m, angles in rad, simulated time in s."""
        pose = (self.component_instance.robot_parent or self.component_instance).position_3d
        place = " ".join(f"{number:.6f}" for number in (pose.x, pose.y, pose.z))
        angles = " ".join(f"{number:.6f}" for number in (pose.yaw, pose.pitch, pose.roll))
        lines = [
            f"==> Data at X,Y,Z: [{place}] yaw,pitch,roll: [{angles}] | index {self.index} | time {self._time():.2f}",
            *(f"\t{name} = {written(value)}" for name, value in self.data.items()),
        ]
        return "\n".join(lines) + "\n"

    def _time(self) -> float:
        time: object = self.data.get("timestamp")
        return float(time) if isinstance(time, (int, float)) else self.component_instance.clock.time


class CSVPublisher(TextStream):
    """A row for each measurement, with fields separated by semicolons; the first row contains their names."""

    def header(self) -> str:
        """The names of the fields."""
        return ";".join(map(_cell, self.data)) + "\n"

    def encode_data(self) -> str:
        """The values of the fields."""
        return ";".join(_cell(written(value)) for value in self.data.values()) + "\n"


def _cell(text: str) -> str:
    """A text as one cell of a table (RFC 4180)."""
    return '"' + text.replace('"', '""') + '"' if ";" in text or '"' in text else text


class TextDatastreamManager(DatastreamManager):
    """One file for each stream, in the working directory or with the path of the option ``file``.

    In a batch, each row has files of its own, ``robot.pose-row3.txt`` (`Context.file_label`).

    A file is overwritten when a simulation is loaded, and continued when the simulation is reset. A robot that is
    spawned later overwrites no file: a number is added to the name of its file if there is one, because clients name
    robots. Data are flushed at least once per simulated second.
    """

    classpath = "morse.middleware.text_datastream.TextDatastreamManager"
    by_component = True
    manager_options = {}  # noqa: RUF012 - declared by the base

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._files: dict[Path, TextFile] = {}
        self._in_use: dict[Path, str] = {}
        #: files of robots that were spawned, by the paths that existed
        self._instead: dict[Path, Path] = {}
        self._is_running = False
        self._period = max(1, round(context.clock.frequency))

    def make_stream(self, component: Object, declaration: StreamDeclaration) -> TextStream:
        """See `DatastreamManager.make_stream`.

        Raises:
            MorseMiddlewareError: it is not a text stream of a sensor, or its file cannot be opened.
        """
        cls = load_class(declaration.stream)
        if not (isinstance(cls, type) and issubclass(cls, TextStream)):
            raise MorseMiddlewareError(
                f"{declaration.stream} does not write text: it has to be a subclass of "
                "morse.middleware.text_datastream.Publisher or CSVPublisher"
            )
        if declaration.direction == "IN":
            raise MorseMiddlewareError("text files are written, not read: they cannot command a component")
        stream: TextStream = super().make_stream(component, declaration)
        stream.file = self._file(component.name(), stream.kwargs["file"])
        return stream

    def _file(self, name: str, choice: str | None) -> TextFile:
        label = self.context.file_label
        path = expanded(choice).absolute() if choice else Path(f"{file_name(name)}.txt").absolute()
        if label is None:
            return TextFile(Path(os.devnull), name, self._note)
        path = path.with_name(f"{path.stem}{label}{path.suffix}")
        if not choice and self._is_running and path not in self._files:
            if path not in self._instead:
                self._instead[path] = free_path(path)
            path = self._instead[path]
        owner = self._in_use.setdefault(path, name)
        if owner != name or any(stream.file.path == path for stream in self.streams.get(name, ())):
            raise MorseMiddlewareError(f"{path} is the file of another stream of {owner}; set another one: file='...'")
        if path not in self._files or self._files[path].owner != name:
            self._files[path] = TextFile(path, name, self._note)
        return self._files[path]

    def _note(self, part: str, consequence: str, reason: str) -> None:
        self.context.guard.note(Failure("fault", part, consequence, self.context.clock.time, reason))

    def closed(self, stream: TextStream) -> None:
        """Release the file: another component may write it, or a new component of the same name may continue it."""
        self._in_use.pop(stream.file.path, None)
        stream.file.flush()

    @maps("general")
    def general(self, stream: TextStream, message: Message) -> str:
        """All fields, whatever the kind."""
        return stream.encode_data()

    def send(self, stream: TextStream, payload: str) -> None:
        """Write a measurement."""
        stream.file.write(payload)
        stream.index += 1

    def action(self) -> None:
        """The beginning of a tick: from now on, clients spawn robots."""
        self._is_running = True

    def flush(self) -> None:
        """The end of a tick."""
        if self.context.clock.tick % self._period == 0:
            for file in self._files.values():
                file.flush()

    def finalize(self) -> None:
        """Write the remaining data and close the files."""
        super().finalize()
        for file in self._files.values():
            file.close()
        self._files.clear()
