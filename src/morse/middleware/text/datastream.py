"""Writes data streams to text files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from morse.core.classes.classpath import load_class
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.guard import Failure
from morse.core.mapping import maps
from morse.core.validation.names import file_name
from morse.middleware.text.file import TextFile
from morse.middleware.text.streams import TextStream
from morse.system.free_names import free_path
from morse.system.shared_folders import expanded

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.kinds import Message
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.scene import StreamDeclaration


class TextDatastreamManager(DatastreamManager):
    """One file for each stream, in the working directory or with the path of the option ``file``.

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
        path = expanded(choice).absolute() if choice else Path(f"{file_name(name)}.txt").absolute()
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
