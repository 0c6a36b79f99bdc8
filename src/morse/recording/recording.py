"""Reads recordings of runs."""

from __future__ import annotations

import base64
import bisect
import json
from collections import OrderedDict
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.recording.errors import RecordingError
from morse.recording.fields import FIELDS
from morse.recording.fields.poses import LOOKS, NODES, POSES, TEXT_TYPE
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.inputs import LostInput, exact_entry
from morse.recording.mcap.reader import McapFile
from morse.recording.recorder import BEGINNING, END, FORMAT, PRESENT
from morse.rosmsgs.cdr import CdrError, decode
from morse.version import __version__

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    from morse.recording.mcap.reader import Chunk
    from morse.recording.mcap.records import Message


#: maximum number of digits of seeds, ticks and rates
_LONGEST_NUMBER = 30


class Recording(McapFile):
    """A recording of MORSE: an MCAP file with the data that determine the run.

    Attributes:
        facts: version, seed, script, ...; see ``docs/recording.md``.
        end: the last tick and the hash of the state there; empty if the recording is incomplete.

    Raises:
        OSError: the file cannot be read.
        RecordingError: the file is not a recording of MORSE.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        super().__init__(path)
        if BEGINNING not in self.metadata:
            self.close()
            raise RecordingError(f"{self.path} is an MCAP file, but no recording of a run of MORSE")
        self.facts = self.metadata[BEGINNING]
        self.end = self.metadata.get(END, {})
        #: number of the format
        self.format = self.number(FORMAT) if FORMAT in self.facts else 1
        if self.format > PRESENT:
            self.close()
            raise self.of_another_format()

    def of_another_format(self) -> RecordingError:
        """The error for a recording of another format than the present one."""
        version = self.facts.get("morse", "")[:40] or "unknown"
        return RecordingError(
            f"{self.path} has the format {self.format} of recordings; MORSE {__version__} reads the format {PRESENT}: "
            f"use the version that wrote it, {version}"
        )

    def number(self, name: str) -> int:
        """A fact that is an integer of 0 or more.

        Raises:
            RecordingError: it is not an integer.
        """
        text = self.facts.get(name, "")
        if not text.isdecimal() or len(text) > _LONGEST_NUMBER:
            raise RecordingError(f"{self.path}: the fact '{name}' is {text[:80]!r}, expected a whole number")
        return int(text)

    def texts(self, name: str) -> list[str]:
        """A fact that is a list of strings.

        Raises:
            RecordingError: it is not a list of strings.
        """
        try:
            texts: object = json.loads(self.facts.get(name, "[]"))
        except (ValueError, RecursionError):
            texts = None
        if not isinstance(texts, list) or not all(isinstance(one, str) for one in texts):
            raise RecordingError(f"{self.path}: the fact '{name}' is damaged, expected a list of strings")
        return texts

    def sensors(self) -> list[str] | None:
        """The recorded sensors; None for all.

        Raises:
            RecordingError: the fact is damaged.
        """
        return None if self.facts.get("sensors", "all") == "all" else self.texts("sensors")

    def length(self) -> int:
        """Number of ticks of the whole recording, which resets do not set back.

        Raises:
            RecordingError: the number is damaged.
        """
        text = self.end.get("ticks", "")
        if text.isdecimal() and len(text) <= _LONGEST_NUMBER:
            return int(text)
        count = sum(1 for _ in self.messages(self.topic_numbers("/clock")))
        return count or max(0, self.last_tick() - self.number("tick"))

    def topic_numbers(self, *topics: str) -> set[int]:
        """The channels of some topics."""
        return {channel.number for channel in self.channels.values() if channel.topic in topics}

    def field_channels(self) -> set[int]:
        """The channels of the data fields of components."""
        return {channel.number for channel in self.channels.values() if channel.topic.startswith(f"{FIELDS}/")}

    def inputs(self, *, lenient: bool = False) -> list[bytes | LostInput]:
        """The entries of the journal, as bytes.

        Args:
            lenient: whether entries that could not be written are in the list, as errors.

        Raises:
            RecordingError: an entry is damaged, or could not be written.
        """
        entries: list[bytes | LostInput] = []
        for one in self.messages(self.topic_numbers(INPUTS)):
            try:
                entries.append(exact_entry(one.data))
            except LostInput as error:
                if not lenient:
                    raise
                entries.append(error)
        return entries

    def last_tick(self) -> int:
        """Number of the last tick, counted since the last reset; for an incomplete recording, the last tick in it.

        Raises:
            RecordingError: the number is damaged.
        """
        text = self.end.get("tick")
        if text is not None and text.isdecimal() and len(text) <= _LONGEST_NUMBER:
            return int(text)
        if text is not None:
            raise RecordingError(f"{self.path}: the last tick is {text[:80]!r}, expected a whole number")
        last = self.number("tick")
        for one in self.messages(self.topic_numbers("/clock", INPUTS, "/rosout")):
            last = one.sequence
        return last

    def waiting(self) -> bytes | None:
        """Return the pending commands at the end, as bytes; None if the recording is incomplete.

        Raises:
            RecordingError: they are damaged.
        """
        text = self.end.get("waiting")
        try:
            return None if text is None else base64.b64decode(text, validate=True)
        except ValueError:
            raise RecordingError(f"{self.path}: the commands at the end are damaged") from None


# What a recording says about the world at a moment: poses, appearance, and who was there.

#: maximum length of a name in a message
_LONGEST = 1000
#: size of a pose, bytes
_POSE = 56
#: size of a message before its first pose, and of one without poses, bytes
_HEAD, _EMPTY = 28, 24


class Moment(NamedTuple):
    """The world at the end of a tick.

    Attributes:
        tick: its number, counted since the last reset of the run.
        names: (M) names of the moving nodes.
        poses: (M, 7) x, y, z (m) and quaternion w, x, y, z, in the world.
    """

    tick: int
    names: tuple[str, ...]
    poses: NDArray[np.float64]


class RecordedWorld:
    """The poses and the appearance in a recording.

    Args:
        recording: the recording.

    Attributes:
        history: the messages.
    """

    def __init__(self, recording: Recording) -> None:
        self.history = History(recording)
        self._path = recording.path
        numbers = {channel.topic: channel.number for channel in recording.channels.values()}
        self._poses, self._nodes, self._looks = (numbers.get(topic, -1) for topic in (POSES, NODES, LOOKS))
        self._names = self._texts(self._nodes)
        self._changes = self._texts(self._looks)
        self._name_times = [time for time, _ in self._names]
        self._change_times = [time for time, _ in self._changes]
        for _, names in self._names:
            if not isinstance(names, list) or not all(isinstance(name, str) and len(name) < _LONGEST for name in names):
                raise RecordingError(f"{self._path}: the names of the nodes are damaged")

    @staticmethod
    def is_in(recording: Recording) -> bool:
        """Whether a recording has the poses of the nodes; those of earlier versions have not."""
        return bool(recording.topic_numbers(POSES)) and bool(recording.topic_numbers(NODES))

    def _texts(self, channel: int) -> list[tuple[int, Any]]:
        try:
            return [
                (one.log_time, json.loads(decode(TEXT_TYPE, one.data)["data"]))
                for one in (self.history.every(channel) if channel >= 0 else ())
            ]
        except (CdrError, ValueError, LookupError, TypeError, RecursionError) as error:
            raise RecordingError(f"{self._path}: the description of the nodes is damaged: {error}") from None

    def at(self, time: int) -> Moment | None:
        """The world at a log time, ns; None before the first tick.

        Raises:
            RecordingError: the file is damaged.
        """
        message = self.history.last(self._poses, time)
        if message is None:
            return None
        # names are written before the poses of the same tick
        index = bisect.bisect_right(self._name_times, message.log_time) - 1
        names = self._names[index][1] if index >= 0 else []
        count = len(names)
        numbers = np.frombuffer(message.data, dtype=np.uint8)
        # with a fixed frame, all messages of as many poses have one length
        if len(numbers) != (_HEAD + _POSE * count if count else _EMPTY):
            raise self._damaged(message.sequence)
        poses = numbers[_HEAD:].view("<f8").reshape(count, 7) if count else np.empty((0, 7))
        if not np.isfinite(poses).all():
            raise self._damaged(message.sequence)
        return Moment(message.sequence, tuple(names), poses[:, [0, 1, 2, 6, 3, 4, 5]])

    def _damaged(self, tick: int) -> RecordingError:
        return RecordingError(f"{self._path}: the poses of tick {tick} are damaged")

    def looks(self, begin: int, end: int) -> list[Any]:
        """The changes of appearance with begin < log time <= end, ns, in order."""
        first, last = (bisect.bisect_right(self._change_times, time) for time in (begin, end))
        return [change for _, changes in self._changes[first:last] if isinstance(changes, list) for change in changes]


# The messages of a recording by channel and time, read on demand.

#: number of chunks that are kept in memory
_MOST_KEPT = 6


class _Series(NamedTuple):
    times: list[int]
    messages: list[Message]


class History:
    """Finds messages; the latest chunks are kept in memory.

    Args:
        file: an MCAP file.
    """

    def __init__(self, file: McapFile) -> None:
        self._file = file
        self._cache: OrderedDict[int, dict[int, _Series]] = OrderedDict()
        self._starts = [chunk.start for chunk in file.chunks]

    def _series(self, chunk: Chunk) -> dict[int, _Series]:
        present = self._cache.get(chunk.offset)
        if present is None:
            present = {}
            for one in self._file.messages_of(chunk):
                series = present.setdefault(one.channel, _Series([], []))
                series.times.append(one.log_time)
                series.messages.append(one)
            self._cache[chunk.offset] = present
            if len(self._cache) > _MOST_KEPT:
                self._cache.popitem(last=False)
        self._cache.move_to_end(chunk.offset)
        return present

    def last(self, channel: int, until: int) -> Message | None:
        """The last message of a channel whose log time is not later than ``until``, ns; None if there is none.

        Raises:
            RecordingError: a chunk is damaged.
        """
        # log time never decreases
        for chunk in reversed(self._file.chunks[: bisect.bisect_right(self._starts, until)]):
            if not chunk.may_hold(channel):
                continue
            series = self._series(chunk).get(channel)
            index = 0 if series is None else bisect.bisect_right(series.times, until)
            if series is not None and index:
                return series.messages[index - 1]
        return None

    def every(self, channel: int) -> list[Message]:
        """All messages of a channel.

        Raises:
            RecordingError: a chunk is damaged.
        """
        return list(self._file.messages((channel,)))
