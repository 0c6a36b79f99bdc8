"""Reads recordings of runs."""

from __future__ import annotations

import base64
import json
from typing import TYPE_CHECKING

from morse.recording.errors import RecordingError
from morse.recording.fields import FIELDS
from morse.recording.inputs import TOPIC as INPUTS
from morse.recording.inputs import LostInput, exact_entry
from morse.recording.mcap.reader import McapFile
from morse.recording.recorder import BEGINNING, END, FORMAT, PRESENT
from morse.version import __version__

if TYPE_CHECKING:
    import os

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
