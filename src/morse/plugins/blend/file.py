"""The structures of a ``.blend`` file, found by the description of all structures (DNA) that it contains."""

from __future__ import annotations

import math
import re
import struct
from math import prod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.blend.container import Block, Damage, Excess, read_blocks, read_header

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from morse.plugins.blend.container import Block

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


#: maximum length in bytes of a string that a pointer refers to
_MAX_TEXT = 1 << 20


class Record:
    """A struct in the file.

    Numbers that are not finite are replaced by the default, because a simulation cannot use them.
    """

    __slots__ = ("block", "file", "offset", "struct")

    def __init__(self, file: BlendFile, struct: Struct, offset: int, block: Block) -> None:
        self.file = file
        self.struct = struct
        self.offset = offset
        self.block = block

    def has(self, name: str) -> bool:
        """Whether this version of the struct has the field."""
        return name in self.struct.fields

    def either(self, *names: str) -> str:
        """The first of these names that this version of the struct has, or else the last."""
        return next((name for name in names if name in self.struct.fields), names[-1])

    def _field(self, name: str) -> Field:
        field = self.struct.fields.get(name)
        if field is None:
            raise Damage(f"the struct {self.struct.name} has no field {name}")
        return field

    def _values(self, name: str) -> tuple[float, ...]:
        field = self._field(name)
        if field.codec is None:
            raise Damage(f"the field {name} of {self.struct.name} does not contain numbers")
        return field.codec.unpack_from(self.file.data, self.offset + field.offset)

    def integer(self, name: str, default: int | None = None) -> int:
        """An integer or an address; the default if the field does not exist."""
        if default is not None and name not in self.struct.fields:
            return default
        return _whole(self._values(name)[0])

    def real(self, name: str, default: float = 0.0) -> float:
        """A number; the default if the field does not exist."""
        return self.reals(name, (default,))[0]

    def reals(self, name: str, default: Sequence[float]) -> tuple[float, ...]:
        """Return as many numbers as the default has; the default if the field does not exist or is not finite."""
        if name not in self.struct.fields:
            return tuple(default)
        values = self._values(name)[: len(default)]
        if len(values) < len(default) or not all(map(_usable, values)):
            return tuple(default)
        return tuple(float(value) for value in values)

    def array(self, name: str) -> tuple[int, ...]:
        """The integers or addresses of a field; empty if it does not exist."""
        return tuple(map(_whole, self._values(name))) if name in self.struct.fields else ()

    def at(self, address: int, struct: str) -> Record | None:
        """The struct at an address."""
        block, index = self.file.block(address, self.block.owner), self.file.dna.index(struct)
        return None if block is None or index is None else self.file.record(block, index)

    def raw(self, name: str) -> bytes:
        """The bytes of a field."""
        field = self._field(name)
        start = self.offset + field.offset
        return self.file.data[start : start + field.size]

    def text(self, name: str, default: str = "") -> str:
        """Return the text up to the first NUL; the bytes after it are undefined."""
        if name not in self.struct.fields:
            return default
        return self.raw(name).split(b"\0", 1)[0].decode("utf-8", "replace")

    def part(self, name: str) -> Record:
        """An embedded struct."""
        field = self._field(name)
        index = self.file.dna.index(field.type)
        if field.is_pointer or index is None:
            raise Damage(f"the field {name} of {self.struct.name} is not a struct")
        layout = self.file.dna.struct(index)
        if layout.size > field.size:
            raise Damage(f"the field {name} of {self.struct.name} is too small")
        return Record(self.file, layout, self.offset + field.offset, self.block)

    def target(self, name: str) -> Block | None:
        """Return the block to which a pointer refers."""
        return self.file.block(self.integer(name, 0), self.block.owner)

    def follow(self, name: str, struct: str | None = None) -> Record | None:
        """Return the struct to which a pointer refers, or None.

        Args:
            name: name of the field.
            struct: the struct type of the data; by default, the type that the block names.
        """
        block = self.target(name)
        return None if block is None else self.file.record(block, self.file.dna.index(struct) if struct else None)

    def content(self, name: str, limit: int) -> bytes:
        """Return up to `limit` bytes of the block to which a pointer refers; empty if there is no block."""
        block = self.target(name)
        if block is None:
            return b""
        size = min(block.size, max(limit, 0))
        self.file.spend(1 + size // 64)
        return self.file.data[block.offset : block.offset + size]

    def string(self, name: str) -> str:
        """Return the text to which a pointer refers, up to the first NUL; empty if there is none."""
        if not self.has(name):
            return ""
        return self.content(name, _MAX_TEXT).split(b"\0", 1)[0].decode("utf-8", "replace")

    def addresses(self, name: str, count: int) -> list[int]:
        """Return up to `count` addresses of the array to which a pointer refers."""
        block = self.target(name)
        if block is None:
            return []
        size = self.file.pointer_size
        count = min(max(count, 0), block.size // size)
        self.file.spend(count)
        addresses: list[int] = np.frombuffer(self.file.data, f"{self.file.endian}u{size}", count, block.offset).tolist()
        return addresses

    def items(self, name: str, struct: str, count: int) -> Iterator[Record]:
        """Iterate over up to `count` structs of the array to which a pointer refers."""
        block, index = self.target(name), self.file.dna.index(struct)
        if block is None or index is None:
            return
        size = self.file.dna.struct(index).size
        for item in range(min(max(count, 0), block.size // size)):
            self.file.spend()
            yield self.file.record(block, index, item)

    def chain(self, name: str, struct: str) -> Iterator[Record]:
        """The structs of a linked list, each once."""
        index = self.file.dna.index(struct)
        if index is None or name not in self.struct.fields:
            return
        holder, field = self.part(name), "first"
        addresses: set[int] = set()
        while (block := holder.target(field)) is not None:
            if block.offset in addresses:
                self.file.warn(f"a list of {struct} in the file is circular; the file may be damaged")
                return
            addresses.add(block.offset)
            self.file.spend()
            holder, field = self.file.record(block, index), "next"
            yield holder


def _whole(value: float) -> int:
    return int(value) if math.isfinite(value) else 0


def _usable(value: float) -> bool:
    return -1e9 < value < 1e9


def datablock_name(record: Record) -> str:
    """Return the name of a datablock, without the two letters of its kind."""
    return record.part("id").text("name")[2:]


#: maximum number of list steps in one file; protects against files that would take excessive time and memory
_MAX_STEPS = 3_000_000
#: maximum number of warnings
_MAX_WARNINGS = 50


class BlendFile:
    """The blocks of a file, by address.

    Attributes:
        version: 279 for Blender 2.79, 402 for 4.2.
        blocks: all of them, in the order of the file.
    """

    def __init__(self, data: bytes) -> None:
        header = read_header(data)
        self.data = data
        self.version = header.version
        self.endian = header.endian
        self.pointer_size = header.pointer_size
        self._warnings: dict[str, None] = {}
        self.blocks, description = read_blocks(data, header)
        end = description.offset + description.size
        self.dna = Catalogue(data[description.offset : end], header.endian, header.pointer_size)
        # since 5.0 an address is valid only within the datablock that contains the pointer
        self._data = {(b.owner, b.address): b for b in self.blocks if b.code == "DATA"}
        self._ids = {b.address: b for b in self.blocks if len(b.code) == 2}
        self._by_address = {b.address: b for b in self.blocks} if header.version < 500 else {}
        self._steps = 0

    def warn(self, message: str) -> None:
        """Add a warning about something that could not be read; the same text is added only once."""
        self._warnings[message] = None

    @property
    def warnings(self) -> list[str]:
        """The warnings about what could not be read, one sentence each."""
        warnings = list(self._warnings)[:_MAX_WARNINGS]
        more = len(self._warnings) - len(warnings)
        return [*warnings, f"{more} more warnings of this kind"] if more else warnings

    def datablocks(self, code: str, struct: str) -> Iterator[Record]:
        """The datablocks of a kind, e.g. ``OB``, ``Object``, in the order of the file."""
        index = self.dna.index(struct)
        if index is not None:
            for block in self.blocks:
                if block.code == code:
                    yield self.record(block, index)

    def block(self, address: int, owner: int) -> Block | None:
        """Return the block to which a pointer of a datablock refers."""
        if not address:
            return None
        return self._data.get((owner, address)) or self._ids.get(address) or self._by_address.get(address)

    def record(self, block: Block, index: int | None = None, item: int = 0) -> Record:
        """Return one of the structs of a block, read as the struct type of the block or as the given type.

        Raises:
            Damage: the block is too small.
        """
        layout = self.dna.struct(block.struct if index is None else index)
        if (item + 1) * layout.size > block.size:
            raise Damage(f"a block with the struct {layout.name} is too small")
        return Record(self, layout, block.offset + item * layout.size, block)

    def column(self, block: Block, struct: Struct, name: str, count: int) -> NDArray[np.generic]:
        """One field of the first `count` structs in a block, as a (count, ...) array.

        Raises:
            Damage: the block has fewer structs, or the struct has no such numeric field.
        """
        field = struct.fields.get(name)
        if field is None or not field.numpy or count * struct.size > block.size:
            raise Damage(f"an array of {struct.name} is shorter than its declared length, or has no {name}")
        kind = np.dtype(
            {
                "names": ["value"],
                "formats": [(field.numpy, (field.items,)) if field.items > 1 else field.numpy],
                "offsets": [field.offset],
                "itemsize": struct.size,
            }
        )
        return np.frombuffer(self.data, kind, count, block.offset)["value"]

    def spend(self, steps: int = 1) -> None:
        """Count list steps, or work of similar cost; many pointers may refer to the same array.

        Raises:
            Excess: the limit is exceeded.
        """
        self._steps += steps
        if self._steps > _MAX_STEPS:
            raise Excess("its lists are longer than those of any real scene")
