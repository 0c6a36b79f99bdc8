"""Reads the data fields of components in a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.recording.fields import COMPONENT, FIELDS, FIELDS_TYPE
from morse.recording.fields.blocks import ReadBlock
from morse.recording.recording import History
from morse.rosmsgs.cdr import CdrError, decode

if TYPE_CHECKING:
    from morse.recording.fields.blocks import Fields
    from morse.recording.mcap.reader import McapFile
    from morse.recording.mcap.records import Message


class RecordedFields:
    """The data fields of the recorded sensors at any time.

    Args:
        file: a recording.
    """

    def __init__(self, file: McapFile) -> None:
        self._history = History(file)
        self._path = file.path
        self._channels = channels_of_fields(file)
        #: the last block of each component
        self._blocks: dict[str, tuple[Message, ReadBlock]] = {}

    def __contains__(self, name: str) -> bool:
        return name in self._channels

    def last(self, name: str, until: int) -> Fields | None:
        """The fields of a component at its last measurement whose log time is not later than ``until``, ns.

        Returns:
            None before the first measurement, and for a component that was not recorded.

        Raises:
            RecordingError: the file is damaged.
        """
        channel = self._channels.get(name)
        message = None if channel is None else self._history.last(channel, until)
        if message is None:
            return None
        former = self._blocks.get(name)
        if former is None or former[0] is not message:
            former = self._blocks[name] = message, block_of(message, self._path)
        block = former[1]
        count = block.until(until)
        return block.row(count - 1) if count else None


def channels_of_fields(file: McapFile) -> dict[str, int]:
    """The channels of data fields by the names of their components."""
    return {
        channel.metadata.get(COMPONENT, ""): channel.number
        for channel in file.channels.values()
        if channel.topic.startswith(f"{FIELDS}/") and channel.type == FIELDS_TYPE
    }


def block_of(message: Message, path: str) -> ReadBlock:
    """The fields in a message.

    Raises:
        RecordingError: they are damaged.
    """
    try:
        data: Any = decode(FIELDS_TYPE, message.data)["data"]
    except CdrError:
        data = b""
    return ReadBlock(bytes(data), f"{path}: tick {message.sequence}")
