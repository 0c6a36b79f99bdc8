"""The file header and the table of blocks."""

from __future__ import annotations

import re
import struct
from typing import NamedTuple

from morse.assets.blend.errors import Damage

#: maximum number of blocks; a file of 1 GiB with blocks of the usual size has a tenth of it
_MAX_BLOCKS = 4_000_000


class Header(NamedTuple):
    """The content of the file header.

    Attributes:
        size: bytes of the file header.
        pointer_size: 4 or 8.
        endian: ``<`` or ``>``.
        version: 279 for Blender 2.79, 402 for 4.2.
        large: blocks have 64-bit sizes (since 5.0).
    """

    size: int
    pointer_size: int
    endian: str
    version: int
    large: bool


class Block(NamedTuple):
    """A block of the file.

    Attributes:
        code: ``OB``, ``ME``, ... of a datablock; ``DATA`` for a block that belongs to a datablock.
        address: value of the pointers in the file that refer to this block.
        struct: index of the struct that the block contains.
        number: number of structs.
        offset: offset of its content in the file, bytes.
        size: bytes.
        owner: index of the datablock to which the block belongs (its own index for a datablock).
    """

    code: str
    address: int
    struct: int
    number: int
    offset: int
    size: int
    owner: int


def read_header(data: bytes) -> Header:
    """The header of a file.

    Raises:
        Damage: the data are not the header of a ``.blend`` file.
    """
    if data[:7] != b"BLENDER":
        raise Damage("this is not a .blend file: it does not begin with 'BLENDER'")
    small = re.match(rb"BLENDER([_-])([vV])(\d{3})", data[:12])
    if small:
        return Header(12, 8 if small[1] == b"-" else 4, "<" if small[2] == b"v" else ">", int(small[3]), False)
    large = re.match(rb"BLENDER(\d\d)-(\d\d)([vV])(\d{4})", data[:17])
    if not large:
        raise Damage("its header is damaged")
    if large[2] != b"01" or int(large[1]) != 17:
        raise Damage(f"it has the file format {int(large[2])}, which is newer than this reader (1)")
    return Header(17, 8, "<" if large[3] == b"v" else ">", int(large[4]), True)


def read_blocks(data: bytes, header: Header) -> tuple[list[Block], Block]:
    """Return all blocks except the description of the structs, and that description.

    Raises:
        Damage: the table exceeds the file, or the description is missing.
    """
    if header.large:
        head = struct.Struct(header.endian + "4siQqq")
    else:
        head = struct.Struct(header.endian + ("4siQii" if header.pointer_size == 8 else "4siIii"))
    blocks: list[Block] = []
    names: dict[bytes, str] = {}
    description: Block | None = None
    position, owner, end = header.size, -1, len(data)
    while True:
        if position + head.size > end:
            # an ENDB block of old files may be shorter than other headers
            if data[position : position + 4] == b"ENDB":
                break
            raise Damage("the file is cut off: the block that marks its end is missing")
        code, *numbers = head.unpack_from(data, position)
        if code == b"ENDB":
            break
        if header.large:
            index, address, size, count = numbers
        else:
            size, address, index, count = numbers
        position += head.size
        if size < 0 or count < 0 or size > end - position:
            raise Damage("the file is cut off or damaged: a block reaches beyond its end")
        name = names.get(code) or names.setdefault(code, code.rstrip(b"\0").decode("latin-1"))
        if name != "DATA":
            owner = len(blocks)
        block = Block(name, address, index, count, position, size, owner)
        if name == "DNA1":
            description = block
        else:
            blocks.append(block)
            if len(blocks) > _MAX_BLOCKS:
                raise Damage(f"it has more than {_MAX_BLOCKS} blocks")
        position += size
    if description is None:
        raise Damage("the description of its structs is missing")
    return blocks, description
