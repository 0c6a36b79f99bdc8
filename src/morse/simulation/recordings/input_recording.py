"""Recordings of the inputs of a run, in memory or in a file."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from morse.core.journal import COMMAND, RESTORE, SPAWN, Entry
from morse.core.state import NoReferences, Reader, StateError, Writer
from morse.simulation.states.own_state import InputsState
from morse.simulation.states.state import State
from morse.system.packed_keys import check_keys
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from types import TracebackType

    from morse.core.values import Fields, Value
    from morse.simulation.running import Running

_HEAD = b"MORSE inputs 1\n"
#: maximum size of a file, bytes
_LARGEST = 4 << 30
_encoder = msgspec.msgpack.Encoder()


@dataclass(slots=True)
class InputRecording:
    """All inputs of a simulation; together with the scene they determine the run bit for bit.

    Attributes:
        seed: seed of the random numbers when the recording began.
        start: state when the recording began; None for the beginning of the simulation.
        last: number of the last tick (counted since the last reset).
        entries: the inputs in order.
        waiting: commands for inactive actuators that had not been applied at the end of the recording.
    """

    seed: int = 0
    start: State | None = None
    last: int = 0
    entries: list[Entry] = field(default_factory=list)
    waiting: dict[str, Fields] = field(default_factory=dict)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a file.

        Raises:
            OSError: the file cannot be written.
            ValueError: a robot was spawned by a function of the process, which cannot be written to a file.
        """
        start = None if self.start is None else self.start.to_bytes()
        head = [self.seed, start, self.last, Writer(NoReferences()).value(self.waiting)]
        content = _HEAD + _encoder.encode([head, [_packed(entry) for entry in self.entries]])
        target = Path(path)
        temporary = target.with_name(f".{target.name}.{os.getpid()}")
        try:
            temporary.write_bytes(content)
            temporary.replace(target)
        finally:
            temporary.unlink(missing_ok=True)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> InputRecording:
        """Read a file.

        Raises:
            OSError: the file cannot be read.
            StateError: the file is not a recording, or is damaged.
        """
        file = Path(path)
        if file.stat().st_size > _LARGEST:
            raise StateError(f"{file} is too large for a recording of inputs")
        content = read_regular(file, _LARGEST)
        if not content.startswith(_HEAD):
            raise StateError(f"{file} is not a recording of inputs, or has another version")
        try:
            check_keys(content, len(_HEAD))
            (seed, start, last, waiting), entries = msgspec.msgpack.decode(content[len(_HEAD) :], type=tuple[Any, Any])
            state = None if start is None else State.from_bytes(start)
            unread = Reader(NoReferences()).value(waiting)
            return cls(int(seed), state, int(last), [_unpacked(entry) for entry in entries], dict(unread))
        except (ValueError, TypeError, LookupError, RecursionError, ArithmeticError) as error:
            raise StateError(f"{file} is damaged: {error}") from None


class InputRecorder:
    """Records the inputs of a simulation from now on, until `stop` or the end of a ``with`` block.

    Attributes:
        recording: the inputs so far.
    """

    def __init__(self, simulation: Running) -> None:
        self._simulation = simulation
        start = simulation.save() if simulation.ticks else None
        self.recording = InputRecording(simulation.seed(), start)
        simulation.journal.sinks.append(self._take)

    def _take(self, entry: Entry) -> None:
        self.recording.entries.append(entry)

    def stop(self) -> InputRecording:
        """Stop recording and return the recording."""
        sinks = self._simulation.journal.sinks
        if self._take in sinks:
            sinks.remove(self._take)
            self.recording.last = self._simulation.ticks
            self.recording.waiting = InputsState(self._simulation).get_state()
        return self.recording

    def __enter__(self) -> InputRecording:
        return self.recording

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()


def entry_to_bytes(entry: Entry) -> bytes:
    """One input, for a file.

    Raises:
        ValueError: a robot was spawned by a function of the process, which cannot be written to a file.
    """
    return _encoder.encode(_packed(entry))


def entry_from_bytes(data: bytes) -> Entry:
    """The input in the bytes that `entry_to_bytes` returned.

    Raises:
        StateError: the bytes are damaged.
    """
    try:
        check_keys(data)
        return _unpacked(msgspec.msgpack.decode(data))
    except (ValueError, TypeError, LookupError, RecursionError, ArithmeticError) as error:
        raise StateError(f"an input is damaged: {error}") from None


def waiting_to_bytes(waiting: dict[str, Fields]) -> bytes:
    """Convert the commands that have not been applied yet, for a file."""
    return _encoder.encode(Writer(NoReferences()).value(waiting))


def waiting_from_bytes(data: bytes) -> dict[str, Fields]:
    """The commands in the bytes that `waiting_to_bytes` returned.

    Raises:
        StateError: the bytes are damaged.
    """
    try:
        check_keys(data)
        return dict(Reader(NoReferences()).value(msgspec.msgpack.decode(data)))
    except (ValueError, TypeError, LookupError, RecursionError, ArithmeticError) as error:
        raise StateError(f"the commands at the end are damaged: {error}") from None


def _packed(entry: Entry) -> list[object]:
    content: Value = entry.content
    if entry.kind == RESTORE:
        content = content.to_bytes()
    elif entry.kind == SPAWN and not isinstance(content[0], str):
        entity = content[0]
        function = (
            f"{getattr(entity, '__module__', '')}.{getattr(entity, '__qualname__', type(entity).__name__)}".lstrip(".")
        )
        raise ValueError(f"'{entry.name}' was spawned by the function {function}, which cannot be written to a file")
    ends = [] if entry.until is None else [entry.until]
    return [entry.tick, entry.kind, entry.name, Writer(NoReferences()).value(content), *ends]


def _unpacked(packed: Any) -> Entry:
    tick, kind, name, content, *ends = packed
    if not (isinstance(kind, str) and isinstance(name, str)):
        raise TypeError("an input has a kind and a name")
    value = Reader(NoReferences()).value(content)
    if kind == RESTORE:
        value = State.from_bytes(value)
    if kind == COMMAND and not isinstance(value, dict):
        raise TypeError("a command has fields")
    return Entry(int(tick), kind, name, value, float(ends[0]) if ends else None)
