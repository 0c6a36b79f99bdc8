"""The protocol between the simulator and its pages: how messages are written and read.

One WebSocket carries everything that changes. Text frames are JSON objects with a ``type``; binary frames begin with a
little-endian word that says what they are: 1 for poses (`morse.viewer.snapshot`), 2 for a message with a payload:
the length of its JSON (uint32), the JSON padded with blanks to a multiple of four, the payload.
What does not change (description of the scene, geometry, textures) comes over HTTP from the same port.
"""

from __future__ import annotations

import functools
import operator
import struct
from enum import IntEnum
from typing import Any

import msgspec

from morse.viewer import page_messages, view_messages
from morse.viewer.page_messages import PageMessage
from morse.viewer.view_messages import Payload, ServerMessage

VERSION = 1
"""Raised whenever a page and a simulator of different age would misunderstand each other."""

PAYLOAD = 2
"""The first word of a binary frame that holds a message with a payload."""

MAX_MESSAGE = 256 * 1024
"""Bytes; a longer message from a page closes its connection."""


class Close(IntEnum):
    """Why the simulator closes a connection, besides the codes of RFC 6455."""

    OTHER_VERSION = 4000
    NOT_UNDERSTOOD = 4001


class NotUnderstood(ValueError):
    """A page sent what is no message of the protocol."""


def messages(module: object, base: type[msgspec.Struct]) -> list[type[msgspec.Struct]]:
    """The messages that a module defines: the subclasses of ``base`` that are not bases themselves."""
    classes = [c for c in vars(module).values() if isinstance(c, type) and issubclass(c, base)]
    return [c for c in classes if not any(other is not c and issubclass(other, c) for other in classes)]


def page_message_types() -> list[type[msgspec.Struct]]:
    """Every message a page can send."""
    return messages(page_messages, PageMessage)


def server_message_types() -> list[type[msgspec.Struct]]:
    """Every message the simulator can send."""
    return messages(view_messages, ServerMessage)


def _plain(value: Any) -> Any:
    """Numbers and vectors of other libraries as JSON has them; anything else as its text."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "__iter__"):
        return list(value)
    return str(value)


_decoder: msgspec.json.Decoder[PageMessage] = msgspec.json.Decoder(functools.reduce(operator.or_, page_message_types()))
_encoder = msgspec.json.Encoder(enc_hook=_plain)
_head = struct.Struct("<II")


def decode_page_message(frame: str | bytes) -> PageMessage:
    """Read what a page sent.

    Raises:
        NotUnderstood: if it is no message, or one with parts that are missing or of a wrong kind.
    """
    if isinstance(frame, bytes):
        raise NotUnderstood("binary frames are sent to pages only")
    try:
        return _decoder.decode(frame)
    except (msgspec.MsgspecError, UnicodeError, RecursionError) as error:
        raise NotUnderstood(str(error)) from error


def encode_json(value: msgspec.Struct) -> bytes:
    """JSON of a description."""
    return _encoder.encode(value)


def encode_server_message(message: ServerMessage) -> str | bytes:
    """The text or binary frame of a message."""
    if not isinstance(message, Payload):
        return _encoder.encode(message).decode()
    text = _encoder.encode(msgspec.structs.replace(message, payload=b""))
    text += b" " * (-len(text) % 4)
    return _head.pack(PAYLOAD, len(text)) + text + message.payload
