"""The description of structs that every ``.blend`` file carries: names, types and offsets of all fields."""

from __future__ import annotations

import re
import struct
from math import prod
from typing import NamedTuple

import numpy as np

from morse.assets.blend.errors import Damage

#: numpy names of the plain types
PLAIN = {
    "char": "i1", "uchar": "u1", "int8_t": "i1", "uint8_t": "u1", "bool": "u1",
    "short": "i2", "ushort": "u2", "int16_t": "i2", "uint16_t": "u2",
    "int": "i4", "long": "i4", "ulong": "u4", "int32_t": "i4", "uint32_t": "u4",
    "float": "f4", "double": "f8", "int64_t": "i8", "uint64_t": "u8",
}  # fmt: skip
_CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d", "i8": "q", "u8": "Q"}
_DIMENSION = re.compile(r"\[(\d{1,9})\]")
_IDENTIFIER = re.compile(r"\w+")
_MAX_ITEMS = 1 << 20


class Field(NamedTuple):
    """A member of a struct.

    Attributes:
        offset: bytes from the start of the struct.
        type: name of its type; for a pointer, the name of the type it points to.
        is_pointer: whether the field contains an address (or several).
        items: 1 for a scalar.
        size: bytes.
        codec: unpacks plain numbers and addresses; None for embedded structs.
        numpy: type of one item, or empty for embedded structs.
    """

    offset: int
    type: str
    is_pointer: bool
    items: int
    size: int
    codec: struct.Struct | None
    numpy: str


class Struct(NamedTuple):
    """A struct: its name, its size in bytes and its fields by name."""

    name: str
    size: int
    fields: dict[str, Field]


class Catalogue:
    """All structs of a file; the layout of a struct is computed on demand."""

    def __init__(self, data: bytes, endian: str, pointer_size: int) -> None:
        self._endian = endian
        self._pointer_size = pointer_size
        self._layouts: dict[int, Struct] = {}
        try:
            self._parse(data)
        except (struct.error, ValueError, IndexError) as error:
            raise Damage("the description of its structs is damaged") from error

    def _parse(self, data: bytes) -> None:
        position = self._tag(data, 4, b"NAME") if data[:4] == b"SDNA" else -1
        if position < 0:
            raise ValueError
        self._names, position = self._strings(data, position)
        self._types, position = self._strings(data, self._tag(data, position, b"TYPE"))
        position = self._tag(data, position, b"TLEN")
        self._sizes = struct.unpack_from(f"{self._endian}{len(self._types)}H", data, position)
        position = self._tag(data, position + 2 * len(self._types), b"STRC")
        count = self._integer(data, position)
        shorts = np.frombuffer(data, f"{self._endian}u2", (len(data) - position - 4) // 2, position + 4).tolist()
        self._structs: list[tuple[int, list[int]]] = []
        at = 0
        for _ in range(count):
            members = shorts[at + 1] * 2
            self._structs.append((shorts[at], shorts[at + 2 : at + 2 + members]))
            at += 2 + members
        self._index = {self._types[kind]: number for number, (kind, _) in enumerate(self._structs)}

    def _integer(self, data: bytes, position: int) -> int:
        value: int = struct.unpack_from(f"{self._endian}i", data, position)[0]
        if not 0 <= value <= len(data):
            raise ValueError
        return value

    @staticmethod
    def _tag(data: bytes, position: int, tag: bytes) -> int:
        position = (position + 3) & ~3
        if data[position : position + 4] != tag:
            raise ValueError
        return position + 4

    def _strings(self, data: bytes, position: int) -> tuple[list[str], int]:
        count = self._integer(data, position)
        position += 4
        # latin-1: one character per byte
        texts = data[position:].decode("latin-1").split("\0", count)
        if len(texts) <= count:
            raise ValueError
        rest = texts.pop()
        return texts, len(data) - len(rest)

    def index(self, name: str) -> int | None:
        """Return the index of a struct, or None if the file does not describe a struct of that name."""
        return self._index.get(name)

    def name(self, index: int) -> str:
        """The name of a struct by its number; empty if there is none."""
        return self._types[self._structs[index][0]] if 0 <= index < len(self._structs) else ""

    def struct(self, index: int) -> Struct:
        """The layout of a struct.

        Raises:
            Damage: there is no struct of that index, or its fields exceed its size.
        """
        layout = self._layouts.get(index)
        return layout if layout is not None else self._lay_out(index)

    def _lay_out(self, index: int) -> Struct:
        if not 0 <= index < len(self._structs):
            raise Damage(f"a block holds structs of the unknown type {index}")
        kind, members = self._structs[index]
        name, size = self._types[kind], self._sizes[kind]
        fields: dict[str, Field] = {}
        offset = 0
        try:
            for number in range(0, len(members) - 1, 2):
                text = self._names[members[number + 1]]
                match = _IDENTIFIER.search(text)
                field = self._field(offset, members[number], text)
                offset += field.size
                fields.setdefault(match[0] if match else text, field)
        except IndexError as error:
            raise Damage(f"the description of the struct {name} is damaged") from error
        if offset > size or size == 0:
            raise Damage(f"the description of the struct {name} is damaged: its fields do not fit into it")
        layout = self._layouts[index] = Struct(name, size, fields)
        return layout

    def _field(self, offset: int, kind: int, text: str) -> Field:
        type_name = self._types[kind]
        count = prod(int(dimension) for dimension in _DIMENSION.findall(text))
        if count > _MAX_ITEMS:
            raise Damage(f"the field {text} is too large")
        numpy = f"u{self._pointer_size}" if text[:1] in "*(" else PLAIN.get(type_name, "")
        if not numpy:
            return Field(offset, type_name, False, count, self._sizes[kind] * count, None, "")
        codec = struct.Struct(f"{self._endian}{count}{_CODES[numpy]}")
        return Field(offset, type_name, text[:1] in "*(", count, codec.size, codec, self._endian + numpy)
