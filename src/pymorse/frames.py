"""Binary frames, as specified in ``docs/socket.md``."""

from __future__ import annotations

import functools
import importlib
import json
import math
import struct
import sys
from array import array
from typing import Any, NamedTuple

HEAD = struct.Struct("<2sBBIII")
"""Magic, version, kind, number of the stream, bytes of the text, bytes of numbers and arrays."""
MAGIC, VERSION = b"MF", 1
NOTICE, DATA, LINE = 0, 1, 2
MAX_FRAME = 1 << 30
"""Maximum bytes of a frame; a larger frame ends the connection."""
_ALIGNMENT = 8
#: bytes of a text whose layout is kept
_LONGEST_KEPT = 1 << 14
#: formats of the struct module by type
_FORMATS = {
    "|b1": "?", "|i1": "b", "|u1": "B", "<i2": "h", "<u2": "H", "<i4": "i", "<u4": "I", "<i8": "q", "<u8": "Q",
    "<f4": "f", "<f8": "d",
}  # fmt: skip


class Frame(NamedTuple):
    """A frame.

    Attributes:
        kind: `NOTICE`, `DATA` or `LINE`.
        stream: number of the stream.
        text: bytes of the text.
        size: size of the whole frame, bytes.
    """

    kind: int
    stream: int
    text: int
    size: int


def read_head(data: bytes | bytearray | memoryview, offset: int = 0) -> Frame | None:
    """The head of a frame; None if it has not arrived completely.

    Raises:
        ValueError: the bytes are not a frame, or the frame is too large.
    """
    begin = bytes(data[offset : offset + len(MAGIC)])
    if not MAGIC.startswith(begin):
        raise ValueError(f"expected a frame, which begins with {MAGIC!r}, got {bytes(data[offset : offset + 40])!r}")
    if len(data) - offset < HEAD.size:
        return None
    _, version, kind, stream, text, arrays = HEAD.unpack_from(data, offset)
    if version != VERSION:
        raise ValueError(f"expected a frame of version {VERSION}, got version {version}: is pymorse older than MORSE?")
    if kind > LINE or text % _ALIGNMENT or arrays % _ALIGNMENT or (arrays and kind != DATA):
        raise ValueError(f"expected a frame, got kind {kind} with {text} bytes of text and {arrays} bytes of arrays")
    size = HEAD.size + text + arrays
    if size > MAX_FRAME:
        raise ValueError(f"a frame of {size} bytes is larger than {MAX_FRAME}")
    return Frame(kind, stream, text, size)


def decode(frame: bytes) -> Any:
    """The message in a whole frame.

    Arrays become read-only numpy arrays if numpy is installed, otherwise read-only memoryviews of the same shape.

    Raises:
        ValueError: the contents do not match the format.
    """
    head = read_head(frame)
    if head is None or head.size != len(frame):
        raise ValueError(f"a frame of {0 if head is None else head.size} bytes was expected, {len(frame)} arrived")
    text, offset = frame[HEAD.size : HEAD.size + head.text], HEAD.size + head.text
    if head.kind != DATA:
        return _parse(text)
    # without a limit, the texts of a hostile simulation would stay in memory
    layout = (_layout if len(text) <= _LONGEST_KEPT else _layout.__wrapped__)(text)
    contents = 8 * len(layout.numbers) + layout.size
    if len(frame) - offset != contents:
        raise ValueError(f"{contents} bytes of numbers and arrays were expected, {len(frame) - offset} arrived")
    message = dict(zip(layout.numbers, struct.unpack_from(layout.packed, frame, offset), strict=True))
    if layout.others:
        message |= _parse(text)["fields"]  # a copy, because users may change lists and dictionaries
    offset += 8 * len(layout.numbers)
    for name, kind, shape, size in layout.arrays:
        message[name] = _array(frame, offset, size, kind, shape)
        offset += size + -size % _ALIGNMENT
    return message


class _Layout(NamedTuple):
    numbers: list[str]
    packed: str
    arrays: list[tuple[str, str, list[int], int]]
    size: int
    others: bool


@functools.lru_cache(maxsize=1024)
def _layout(text: bytes) -> _Layout:
    """The layout of a frame, from its text; most messages of a stream have the same text."""
    described = _parse(text)
    try:
        numbers, others = described["numbers"], described["fields"]
        if not isinstance(others, dict) or not all(isinstance(name, str) for name in numbers):
            raise TypeError("fields or numbers")
        arrays = []
        for name, kind, shape in described["arrays"]:
            size = _count(shape) * (1 if kind == "bytes" else struct.calcsize(_FORMATS[kind]))
            arrays.append((str(name), kind, shape, size))
    except (KeyError, TypeError) as error:
        raise ValueError(f"this frame does not describe its fields ({error!r}): {str(described)[:80]}") from None
    padded = sum(size + -size % _ALIGNMENT for *_, size in arrays)
    return _Layout(numbers, f"<{len(numbers)}d", arrays, padded, bool(others))


def _parse(text: bytes) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"the text of this frame is not JSON ({error}): {text[:80]!r}") from None


def _count(shape: list[int]) -> int:
    if not isinstance(shape, list) or len(shape) > 32 or not all(type(n) is int and 0 <= n < 1 << 31 for n in shape):
        raise ValueError(f"{str(shape)[:80]} is not the shape of an array")
    return math.prod(shape)


def _array(frame: bytes, offset: int, size: int, kind: str, shape: list[int]) -> Any:
    content = memoryview(frame)[offset : offset + size]
    if kind == "bytes":
        return bytes(content)
    if (numpy := _numpy()) is not None:
        return numpy.frombuffer(content, kind).reshape(shape)
    form: Any = _FORMATS[kind]
    if sys.byteorder == "big" and struct.calcsize(form) > 1:
        swapped = array(form, content)
        swapped.byteswap()
        content = memoryview(swapped).cast("B").toreadonly()
    if not size:
        return memoryview(b"").cast(form)  # a memoryview cannot have a shape with a 0
    return content.cast(form, shape) if shape else content.cast(form)


@functools.cache
def _numpy() -> Any:
    """The module numpy, or None, because pymorse does not require it."""
    try:
        return importlib.import_module("numpy")
    except ImportError:
        return None
