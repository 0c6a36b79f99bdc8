"""One message of a topic in the forms that clients ask for: JSON, PNG and CBOR (RFC 8949); each is made once for all.

Arrays of numbers are typed arrays in CBOR (RFC 8746): the compression ``cbor`` of rosbridge.
"""

from __future__ import annotations

import base64
import binascii
import io
import math
import struct
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from PIL import Image

from morse.core.reports.quoting import nearest, short, shown
from morse.core.streams.extent import listed
from morse.rosmsgs import cdr
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, SINGLE, fields_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.values import RosMessage
    from morse.middleware.web.topics import WebTopic
    from morse.rosmsgs.definitions import MessageField


#: fields of ROS 1 that clients may still send
_OF_ROS_1 = {"std_msgs/msg/Header": ("seq",), "builtin_interfaces/msg/Time": ("secs", "nsecs")}
_BYTES = ("uint8", "int8")
_encoder = msgspec.json.Encoder()


def encode_json(type_name: str, message: RosMessage) -> bytes:
    """Encode a message with all its fields as JSON; missing fields have their defaults.

    Raises:
        ValueError, TypeError: a value does not fit its field.
    """
    return _encoder.encode(_plain(type_name, message))


def decode_json(type_name: str, data: bytes) -> RosMessage:
    """Decode a message from untrusted JSON; sequences of numbers become numpy arrays.

    Raises:
        ValueError: it is not a message of that type; the text names the field.
    """
    try:
        value = msgspec.json.decode(data)
    except (msgspec.DecodeError, RecursionError) as error:
        raise ValueError(f"not JSON ({error})") from None
    return _message(type_name, value, "")


# -- writing -----------------------------------------------------------------------------------


def _plain(type_name: str, message: Mapping[str, object]) -> RosMessage:
    writers = _writers(type_name)
    if not writers.keys() >= message.keys():
        raise ValueError(f"{type_name} has no field {sorted(message.keys() - writers.keys())}")
    return {name: write(message.get(name)) for name, write in writers.items()}


@cache
def _writers(type_name: str) -> dict[str, Callable[[object], object]]:
    return {field.name: _writer(field) for field in fields_of(type_name)}


def _writer(field: MessageField) -> Callable[[Any], object]:
    if field.size != SINGLE:
        return _bytes_writer(field) if field.type == "uint8" else _list_writer(field)
    if field.type == "string":
        return lambda value: "" if value is None else str(value)
    if field.type not in PRIMITIVES:
        return lambda value: _plain(field.type, value or {})
    kind: Callable[[Any], Any] = bool if field.type == "bool" else float if "float" in field.type else int
    return lambda value: kind(field.default if value is None else value)


def _bytes_writer(field: MessageField) -> Callable[[object], str]:
    def write(value: Any) -> str:
        if value is None:
            value = bytes(field.size)
        is_bytes = isinstance(value, (bytes, bytearray, memoryview))
        return base64.b64encode(value if is_bytes else np.asarray(value, dtype=np.uint8).tobytes()).decode("ascii")

    return write


def _list_writer(field: MessageField) -> Callable[[object], list[object]]:
    single = _writer(field._replace(size=SINGLE))

    def write(value: Any) -> list[Any]:
        if value is None:
            return [single(None)] * field.size
        items = listed(value) if hasattr(value, "tolist") else list(value)
        if field.size not in (SEQUENCE, len(items)):
            raise ValueError(f"field '{field.name}' has {field.size} items, not {len(items)}")
        return items if field.type in PRIMITIVES else [single(item) for item in items]

    return write


# -- reading -----------------------------------------------------------------------------------


def _message(type_name: str, value: object, where: str) -> RosMessage:
    if not isinstance(value, dict):
        raise ValueError(f"{where or 'the message'} is {shown(value)}, expected an object of {type_name}")
    readers = _readers(type_name)
    for name in value:
        if name not in readers and name not in _OF_ROS_1.get(type_name, ()):
            raise ValueError(f"{type_name} has no field {short(name)}{nearest(name, readers)}")
    return {name: read(value.get(name), f"{where}.{name}" if where else name) for name, read in readers.items()}


@cache
def _readers(type_name: str) -> dict[str, Callable[[object, str], object]]:
    return {field.name: _reader(field) for field in fields_of(type_name)}


def _reader(field: MessageField) -> Callable[[object, str], object]:
    if field.size != SINGLE:
        return _numbers_reader(field) if field.type in PRIMITIVES else _items_reader(field)
    if field.type == "string":
        return _string
    if field.type not in PRIMITIVES:
        return lambda value, where: _message(field.type, {} if value is None else value, where)
    return _number_reader(field)


def _string(value: object, where: str) -> str:
    if value is None:
        return ""
    if not isinstance(value, str):
        raise ValueError(f"{where} is {shown(value)}, expected a string")
    return value


def _number_reader(field: MessageField) -> Callable[[object, str], object]:
    # every integer that a float can represent; infinity is written as null
    low, high = -(1 << 1023), 1 << 1023
    if field.type == "bool":
        words = "true or false"
    elif "float" in field.type:
        words = "a number"
    else:
        words = f"an integer ({field.type})"
        low, high = int(np.iinfo(field.type).min), int(np.iinfo(field.type).max)

    def read(value: Any, where: str) -> Any:
        if value is None:
            return field.default if field.type != "bool" else False
        is_number = isinstance(value, (int, float)) if "float" in field.type else isinstance(value, int)
        if not is_number or isinstance(value, bool) != (field.type == "bool") or not low <= value <= high:
            raise ValueError(f"{where} is {shown(value)}, expected {words}")
        return float(value) if "float" in field.type else value

    return read


def _numbers_reader(field: MessageField) -> Callable[[object, str], object]:
    single = _number_reader(field)
    dtype = np.dtype("?" if field.type == "bool" else field.type)

    def read(value: object, where: str) -> object:
        if value is None:
            return np.zeros(field.size, dtype)
        if isinstance(value, str) and field.type in _BYTES:
            try:
                array = np.frombuffer(base64.b64decode(value, validate=True), dtype)
            except (binascii.Error, ValueError):
                raise ValueError(f"{where} is {shown(value)}, expected base64") from None
        elif isinstance(value, list):
            empty = math.nan if "float" in field.type else None
            items = [empty if item is None else single(item, where) for item in value]
            if None in items:
                raise ValueError(f"{where} has null, expected numbers ({field.type})")
            array = np.array(items, dtype)
        else:
            raise ValueError(f"{where} is {shown(value)}, expected a list of numbers")
        if field.size not in (SEQUENCE, len(array)):
            raise ValueError(f"{where} has {len(array)} items, expected {field.size}")
        return array

    return read


def _items_reader(field: MessageField) -> Callable[[object, str], object]:
    single = _reader(field._replace(size=SINGLE))

    def read(value: object, where: str) -> list[object]:
        if value is None:
            return [single(None, where) for _ in range(field.size)]
        if not isinstance(value, list) or field.size not in (SEQUENCE, len(value)):
            raise ValueError(f"{where} is {shown(value)}, expected a list")
        return [single(item, where) for item in value]

    return read


#: major types; simple values and numbers of 64 bits
_POSITIVE, _NEGATIVE, _OCTETS, _TEXT, _LIST, _MAP, _TAG = range(7)
_FALSE, _TRUE, _NULL, _DOUBLE = b"\xf4", b"\xf5", b"\xf6", b"\xfb"
#: tags of little-endian arrays; bytes of rosbridge have none
_TAGS = {"u2": 69, "u4": 70, "u8": 71, "i1": 72, "i2": 77, "i4": 78, "i8": 79, "f4": 85, "f8": 86}


def encode_cbor(value: object) -> bytes:
    """Encode numbers, texts, bytes, arrays (N,) of numpy, lists and dictionaries with names as keys.

    Raises:
        TypeError: a value is none of these.
        OverflowError: an integer needs more than 64 bits.
    """
    parts: list[bytes] = []
    _write(value, parts.append)
    return b"".join(parts)


def _head(major: int, number: int) -> bytes:
    if number < 24:
        return bytes((major << 5 | number,))
    size = next((size for size in (1, 2, 4, 8) if number < 1 << 8 * size), 16)
    return bytes((major << 5 | 23 + size.bit_length(),)) + number.to_bytes(min(size, 8), "big")


def _write(value: object, put: Callable[[bytes], None]) -> None:
    if isinstance(value, (bool, np.bool_)) or value is None:
        put(_NULL if value is None else _TRUE if value else _FALSE)
    elif isinstance(value, (int, np.integer)):
        number = int(value)
        put(_head(_POSITIVE, number) if number >= 0 else _head(_NEGATIVE, -1 - number))
    elif isinstance(value, (float, np.floating)):
        put(_DOUBLE + struct.pack(">d", value))
    elif isinstance(value, str):
        text = value.encode()
        put(_head(_TEXT, len(text)) + text)
    elif isinstance(value, (bytes, bytearray, memoryview)):
        put(_head(_OCTETS, len(value)) + bytes(value))
    elif isinstance(value, np.ndarray):
        _write_array(value, put)
    elif isinstance(value, (list, tuple)):
        put(_head(_LIST, len(value)))
        for item in value:
            _write(item, put)
    elif isinstance(value, dict):
        _write_map(value, put)
    else:
        raise TypeError(f"CBOR has no {type(value).__name__}")


def _write_map(value: Mapping[str, object], put: Callable[[bytes], None]) -> None:
    put(_head(_MAP, len(value)))
    for name, item in value.items():
        _write(name, put)
        _write(item, put)


def _write_array(array: np.ndarray, put: Callable[[bytes], None]) -> None:
    kind = array.dtype.str[1:]
    if kind not in _TAGS and kind != "u1":
        _write(array.tolist(), put)
        return
    data = np.ascontiguousarray(array, array.dtype.newbyteorder("<")).tobytes()
    if kind in _TAGS:
        put(_head(_TAG, _TAGS[kind]))
    put(_head(_OCTETS, len(data)))
    put(data)


_CHANNELS = 3


def as_png(frame: str) -> str:
    """A message whose characters are the colours of an image.

    Source: pngcompression.py of rosbridge_suite: RGB, about as high as wide; blanks at the end.
    """
    data = frame.encode()
    width = math.isqrt(max(1, math.ceil(len(data) / _CHANNELS)))
    height = math.ceil(len(data) / (width * _CHANNELS))
    image = Image.frombytes("RGB", (width, height), data.ljust(width * height * _CHANNELS))
    file = io.BytesIO()
    image.save(file, "PNG", compress_level=1)  # in the network thread
    return msgspec.json.encode({"op": "png", "data": base64.b64encode(file.getvalue()).decode()}).decode()


_SECOND = 10**9
#: the compressions that clients may ask for; of several subscriptions to a topic, the last of these counts
COMPRESSIONS = ("none", "png", "cbor", "cbor-raw")


class Forms:
    """The operation ``publish`` of a message.

    Args:
        topic: of the message.
        stamp: simulated time, ns.
        data: the message in CDR.
    """

    def __init__(self, topic: WebTopic, stamp: int, data: bytes) -> None:
        self._topic, self._stamp, self._data = topic, stamp, data

    def frame(self, compression: str) -> str | bytes:
        """The message in one of `COMPRESSIONS`."""
        if compression == "png":
            return self._png
        if compression == "cbor":
            return self._cbor
        return self._raw if compression == "cbor-raw" else self._text

    @cached_property
    def _message(self) -> RosMessage:
        return cdr.decode(self._topic.type, self._data)

    @cached_property
    def _text(self) -> str:
        name = msgspec.json.encode(self._topic.topic).decode()
        message = encode_json(self._topic.type, self._message).decode()
        return f'{{"op":"publish","topic":{name},"msg":{message}}}'

    @cached_property
    def _png(self) -> str:
        return as_png(self._text)

    def _packed(self, message: object) -> bytes:
        return encode_cbor({"op": "publish", "topic": self._topic.topic, "msg": message})

    @cached_property
    def _cbor(self) -> bytes:
        return self._packed(self._message)

    @cached_property
    def _raw(self) -> bytes:
        seconds, rest = divmod(self._stamp, _SECOND)
        return self._packed({"secs": seconds, "nsecs": rest, "bytes": self._data})
