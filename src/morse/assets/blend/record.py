"""Structs in a file, with access to fields and pointers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend.errors import Damage

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.assets.blend.blocks import Block
    from morse.assets.blend.dna import Field, Struct
    from morse.assets.blend.file import BlendFile

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
