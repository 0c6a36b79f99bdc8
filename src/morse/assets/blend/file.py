"""A ``.blend`` file as records with access to fields and pointers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend.blocks import Block, read_blocks, read_header
from morse.assets.blend.dna import Catalogue, Struct
from morse.assets.blend.errors import Damage, Excess
from morse.assets.blend.record import Record

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

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
