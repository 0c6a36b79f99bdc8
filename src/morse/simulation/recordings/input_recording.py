"""Recordings of the inputs of a run, in memory or in a file."""

from __future__ import annotations

from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from morse.core import status
from morse.core.journal import CALL, CANCEL, COMMAND, CONTROLS, OUTCOME, REBIRTHS, RESET, RESTORE, SERVICE, SPAWN, Entry
from morse.core.reports.quoting import short
from morse.core.state import NoReferences, Reader, StateError, Writer
from morse.simulation.states.saving import InputsState
from morse.simulation.states.state import State
from morse.system.packed_keys import check_keys
from morse.system.regular_files import read_regular
from morse.system.whole_files import write_whole

if TYPE_CHECKING:
    import os
    from collections.abc import Callable
    from types import TracebackType

    from morse.core.values import Fields, Value
    from morse.simulation.simulation import Simulation

#: of the present version, and of earlier ones
_HEAD, _HEADS = b"MORSE inputs 2\n", (b"MORSE inputs 1\n", b"MORSE inputs 2\n")
#: maximum size of a file, bytes
_LARGEST = 4 << 30
_encoder = msgspec.msgpack.Encoder()


class Outcome(NamedTuple):
    """The outcome of an input, see `morse.core.journal`."""

    entry: Entry
    status: str
    result: Value


class ReplayError(StateError):
    """An input that does not fit the run.

    Attributes:
        entry: the input, or its outcome.
        how: what does not fit.
    """

    def __init__(self, entry: Entry, how: str) -> None:
        super().__init__(f"the recording does not fit the run: {shown_entry(entry)}: {how}")
        self.entry, self.how = entry, how


@dataclass(slots=True)
class InputRecording:
    """All inputs of a simulation; together with the scene they determine the run bit for bit.

    Attributes:
        seed: seed of the random numbers when the recording began.
        start: state when the recording began; None for the beginning of the simulation.
        last: number of the last tick (counted since the last reset).
        entries: the inputs in order.
        waiting: commands for inactive actuators that had not been applied at the end of the recording.
        life: number of restarts before the beginning; see `morse.core.journal.Entry`.
    """

    seed: int = 0
    start: State | None = None
    last: int = 0
    entries: list[Entry] = field(default_factory=list)
    waiting: dict[str, Fields] = field(default_factory=dict)
    life: int = 0

    def refused(self) -> set[int]:
        """The numbers of the inputs that were refused."""
        return {e.content[0] for e in self.entries if e.kind == OUTCOME and e.content[1] == status.FAILED}

    def in_sequence(self) -> tuple[list[Entry], dict[int, Outcome]]:
        """The inputs in order, and the outcomes by the numbers of the inputs.

        Recordings of earlier versions have neither numbers nor outcomes, and repeat what a restart has caused.

        Raises:
            ReplayError: the entries are not in order.
        """
        if any(entry.order < 0 for entry in self.entries):
            return _numbered([entry for entry in self.entries if entry.kind != OUTCOME], self.life), {}
        inputs = [entry for entry in self.entries if entry.kind != OUTCOME]
        before: Entry | None = None
        for entry in inputs:
            if before is not None and (entry.order <= before.order or _moment(entry) < _moment(before)):
                raise ReplayError(entry, f"it comes after {shown_entry(before)}")
            before = entry
        if before is not None and inputs[0].life < self.life:
            raise ReplayError(inputs[0], "the recording begins later")
        if before is not None and before.kind not in REBIRTHS and before.tick > self.last:
            raise ReplayError(before, f"the recording ends at tick {self.last}")
        outcomes: dict[int, Outcome] = {}
        for entry in self.entries:
            if entry.kind == OUTCOME:
                order, state, result = entry.content
                if order in outcomes:
                    raise ReplayError(entry, f"the input {order} has two outcomes")
                outcomes[order] = Outcome(entry, state, result)
        return inputs, outcomes

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a file.

        Raises:
            OSError: the file cannot be written.
            ValueError: a robot was spawned by a function of the process, which cannot be written to a file.
        """
        start = None if self.start is None else self.start.to_bytes()
        head = [self.seed, start, self.last, Writer(NoReferences()).value(self.waiting), self.life]
        content = _HEAD + _encoder.encode([head, [_packed(entry) for entry in self.entries]])
        write_whole(path, content)

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
        if not content.startswith(_HEADS):
            raise StateError(f"{file} is not a recording of inputs, or has another version")
        try:
            check_keys(content, len(_HEAD))
            (seed, start, last, waiting, *more), entries = msgspec.msgpack.decode(
                content[len(_HEAD) :], type=tuple[Any, Any]
            )
            state = None if start is None else State.from_bytes(start)
            unread = Reader(NoReferences()).value(waiting)
            life = int(more[0]) if more else 0
            return cls(int(seed), state, int(last), [_unpacked(entry) for entry in entries], dict(unread), life)
        except (ValueError, TypeError, LookupError, RecursionError, ArithmeticError) as error:
            raise StateError(f"{file} is damaged: {error}") from None


class InputRecorder:
    """Records the inputs of a simulation from now on, until `stop` or the end of a ``with`` block.

    Attributes:
        recording: the inputs so far.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        start = None if simulation.is_new else simulation.save()
        self.recording = InputRecording(simulation.seed(), start, life=simulation.journal.life)
        simulation.journal.sinks.append(self._take)

    def _take(self, entry: Entry) -> None:
        self.recording.entries.append(kept(entry))

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


def kept(entry: Entry) -> Entry:
    """An entry that may be kept: a service may change its arguments."""
    if entry.kind in (SERVICE, CALL):
        with suppress(Exception):
            return entry._replace(content=deepcopy(entry.content))
    return entry


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
    value = Writer(NoReferences()).value(content)
    return [entry.tick, entry.kind, entry.name, value, entry.until, entry.life, entry.order]


def _unpacked(packed: Any) -> Entry:
    tick, kind, name, content, *more = packed
    if not (isinstance(kind, str) and isinstance(name, str)):
        raise TypeError("an input has a kind and a name")
    value = Reader(NoReferences()).value(content)
    if kind == RESTORE:
        value = State.from_bytes(value)
    if kind in _FORMS and not _FORMS[kind](value):
        raise TypeError(f"the content of '{kind}' is {short(value)}")
    # earlier versions wrote the end of a command, if it had one
    until, life, order = more if len(more) == 3 else (*(more or [None]), 0, -1)
    return Entry(int(tick), kind, name, value, None if until is None else float(until), int(life), int(order))


def _is(*kinds: type | tuple[type, ...]) -> Callable[[object], bool]:
    """Whether a value is a sequence of items of some classes."""
    return lambda value: (
        isinstance(value, (list, tuple)) and len(value) == len(kinds) and all(map(isinstance, value, kinds))
    )


_SEQUENCE, _NUMBER = (list, tuple), (int, float)
_is_service = _is(str, _SEQUENCE)
_is_cancelled = _is(str, int)
#: the content of each kind
_FORMS: dict[str, Callable[[Any], bool]] = {
    COMMAND: lambda value: isinstance(value, dict),
    SERVICE: _is_service,
    CALL: _is_service,
    CANCEL: lambda value: isinstance(value, str) or _is_cancelled(value),
    CONTROLS: _is(_SEQUENCE, _SEQUENCE, (str, type(None))),
    RESET: lambda value: value is None or type(value) is int,
    SPAWN: _is(str, _SEQUENCE, _SEQUENCE),
    OUTCOME: lambda value: _is(int, str, object)(value) and value[1] in status.ALL,
}


def _moment(entry: Entry) -> tuple[int, int]:
    return entry.life, entry.tick


def shown_entry(entry: Entry) -> str:
    """An entry in a message."""
    number = f"input {entry.order}" if entry.order >= 0 else "the input"
    is_call = entry.kind in (SERVICE, CALL, CANCEL) and isinstance(entry.content, (tuple, list))
    what = f"{entry.content[0]} of {entry.name}" if is_call else entry.name
    after = f" after {entry.life} restarts or restored states" if entry.life else ""
    return f"{number} ({short(f'{entry.kind} {what}'.strip())}, tick {entry.tick}{after})"


def _numbered(entries: list[Entry], life: int) -> list[Entry]:
    """The entries of an earlier version, with places in time, and without the cancellations that a restart caused."""
    numbered: list[Entry] = []
    rebirth: Entry | None = None
    for entry in entries:
        if rebirth is not None and entry.kind == CANCEL and entry.tick == rebirth.tick:
            continue
        rebirth = entry if entry.kind in REBIRTHS else None
        numbered.append(entry._replace(life=life, order=len(numbered)))
        life += rebirth is not None
    return numbered
