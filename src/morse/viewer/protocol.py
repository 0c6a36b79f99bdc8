"""The protocol between the simulator and its pages: encoding and decoding of messages.

One WebSocket carries everything that changes. Text frames are JSON objects with a ``type``. Binary frames begin with a
little-endian word with their kind: 1 for poses (`morse.viewer.snapshot`), 2 for a message with a payload: the length of
its JSON (uint32), the JSON padded with blanks to a multiple of four, the payload. Constant data (description of the
scene, geometry, textures) are fetched over HTTP from the same port.
"""

from __future__ import annotations

import functools
import operator
import reprlib
import struct
from enum import IntEnum
from typing import TYPE_CHECKING

import msgspec

from morse.viewer import page_messages, view_messages
from morse.viewer.page_messages import PageMessage
from morse.viewer.view_messages import Payload, ServerMessage

if TYPE_CHECKING:
    from morse.core.values import JsonObject

VERSION = 3
"""Increased whenever a page and a simulator of different versions would misunderstand each other."""

PAYLOAD = 2
"""The first word of a binary frame with a message and a payload."""

MAX_MESSAGE = 256 * 1024
"""Maximum size of a message from a page, bytes; a larger one closes its connection."""


class Close(IntEnum):
    """Reasons for closing a connection, in addition to the codes of RFC 6455."""

    OTHER_VERSION = 4000
    NOT_UNDERSTOOD = 4001
    FULL = 4002


class NotUnderstood(ValueError):
    """A page has sent data that are not a message of the protocol."""


def messages(module: object, base: type[msgspec.Struct]) -> list[type[msgspec.Struct]]:
    """The messages of a module: the subclasses of ``base`` that are not bases themselves."""
    classes = [c for c in vars(module).values() if isinstance(c, type) and issubclass(c, base)]
    return [c for c in classes if not any(other is not c and issubclass(other, c) for other in classes)]


def page_message_types() -> list[type[msgspec.Struct]]:
    """All messages of pages."""
    return messages(page_messages, PageMessage)


def server_message_types() -> list[type[msgspec.Struct]]:
    """All messages of the simulator."""
    return messages(view_messages, ServerMessage)


def _plain(value: object) -> object:
    """Numbers and vectors of other libraries as JSON values; other values as strings."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "__iter__") and hasattr(value, "__len__"):
        return list(value)
    return reprlib.repr(value)


_decoder: msgspec.json.Decoder[PageMessage] = msgspec.json.Decoder(functools.reduce(operator.or_, page_message_types()))
_encoder = msgspec.json.Encoder(enc_hook=_plain)
_head = struct.Struct("<II")
#: maximum depth and number of items of values that are written in place of non-JSON values
_DEEPEST = 12
_MOST_PARTS = 100_000


def decode_page_message(frame: str | bytes) -> PageMessage:
    """Decode a message of a page.

    Raises:
        NotUnderstood: it is not a message, or a part of the message is missing or has the wrong type.
    """
    if isinstance(frame, bytes):
        raise NotUnderstood("binary frames are sent to pages only")
    try:
        return _decoder.decode(frame)
    except (msgspec.MsgspecError, UnicodeError, RecursionError) as error:
        raise NotUnderstood(str(error)) from error


def encode_json(value: msgspec.Struct) -> bytes:
    """JSON of a description or a message.

    Values without a JSON representation are written as strings.
    """
    try:
        return _encoder.encode(value)
    except Exception:  # lone surrogates, keys of other types, cycles, objects that cannot be formatted
        return _encoder.encode(_Writable().struct(value))


class _Writable:
    """Creates copies with a JSON representation."""

    def __init__(self) -> None:
        self._left = _MOST_PARTS

    def struct(self, value: msgspec.Struct) -> JsonObject:
        config = value.__struct_config__
        tag = {} if config.tag is None else {str(config.tag_field): config.tag}
        return tag | {name: self.copy(part) for name, part in msgspec.structs.asdict(value).items()}

    def copy(self, value: object, depth: int = 0) -> object:
        self._left -= 1
        if isinstance(value, str):
            return _text(value)
        if value is None or isinstance(value, (bool, int, float)):
            return value
        if depth == _DEEPEST or self._left < 0:
            return "..."
        try:
            if isinstance(value, msgspec.Struct):
                return self.struct(value)
            if isinstance(value, dict):
                return {
                    _text(key if isinstance(key, str) else reprlib.repr(key)): self.copy(part, depth + 1)
                    for key, part in value.items()
                }
            plain = value if isinstance(value, (list, tuple)) else _plain(value)
            if isinstance(plain, (list, tuple)):
                return [self.copy(part, depth + 1) for part in plain]
            return self.copy(plain, depth + 1)
        except Exception:  # an object of the user
            return f"a {type(value).__name__} that cannot be shown"


def _text(value: str) -> str:
    """The text with lone surrogates written as escapes."""
    return value.encode("utf-8", "backslashreplace").decode()


def encode_server_message(message: ServerMessage) -> str | bytes:
    """The text or binary frame of a message."""
    if not isinstance(message, Payload):
        return encode_json(message).decode()
    text = encode_json(msgspec.structs.replace(message, payload=b""))
    text += b" " * (-len(text) % 4)
    return _head.pack(PAYLOAD, len(text)) + text + message.payload
