"""A recording without an end, such as that of a process that was killed, as a complete file."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from morse.recording.errors import RecordingError
from morse.recording.mcap.writer import McapWriter

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from morse.recording.mcap.reader import Channel, McapFile


class Rewritten(NamedTuple):
    """A complete file.

    Attributes:
        messages: their number.
        damaged: number of chunks that cannot be read and are left out.
    """

    messages: int
    damaged: int


def rewrite(file: McapFile, path: Path, channels: Collection[Channel]) -> Rewritten:
    """Write a complete file with an index: the intact messages of some channels, all metadata and attachments.

    Args:
        file: a recording.
        path: of a file that does not exist.
        channels: of the recording.

    Raises:
        RecordingError: the file exists, or the recording has other messages than CDR.
        OSError: the file cannot be written; no part of it is left.
    """
    for channel in channels:
        if (channel.encoding, channel.schema_encoding) != ("cdr", "ros2msg"):
            raise RecordingError(
                f"{file.path}: the messages of {channel.topic} are {channel.encoding or 'of no encoding'}, expected "
                "cdr: only files with messages of ROS 2 can be written; choose them by --topics"
            )
    try:
        target = open(path, "xb", buffering=0)  # noqa: SIM115 (closed below)
    except FileExistsError:
        raise RecordingError(f"{path} exists; choose another name by -o") from None
    try:
        with target:
            return _copied(file, McapWriter(target, file.profile), channels)
    except BaseException:
        os.unlink(path)
        raise


def _copied(file: McapFile, writer: McapWriter, channels: Collection[Channel]) -> Rewritten:
    numbers = {
        one.number: writer.channel(one.topic, writer.schema(one.type, one.definition), one.metadata) for one in channels
    }
    messages = damages = 0
    for chunk in file.chunks:
        if not any(map(chunk.may_hold, numbers)):
            continue
        try:
            messages_of_chunk = list(file.messages_of(chunk, numbers.keys()))
        except RecordingError:
            damages += 1
            continue
        writer.chunk([one._replace(channel=numbers[one.channel]) for one in messages_of_chunk])
        messages += len(messages_of_chunk)
    for name in file.attachments:
        attachment = file.attached(name)
        if attachment is not None:
            writer.attachment(name, attachment.media_type, attachment.data, attachment.log_time)
    for name, entries in file.metadata.items():
        writer.metadata(name, entries)
    writer.finish()
    return Rewritten(messages, damages)
