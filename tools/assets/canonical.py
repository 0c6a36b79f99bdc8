"""Make .blend files reproducible: the same model gives identical bytes on every run.

Blender stores memory addresses, which differ between runs. This module replaces the address of each block of a file by
the index of the block, and pointers accordingly. Pointers to data outside the file, which Blender ignores, become null.
Other random content is reset, too: the seed of a colour that is used only in sculpt mode, and the memory after the end
of a text or an image. The format is described in Blender's ``doc/blender_file_format``: blocks, and a catalogue of all
structs (SDNA).
"""

from __future__ import annotations

import re
import struct
from typing import NamedTuple

import numpy as np

HEADER, BLOCK = 12, struct.Struct("<4siQii")
SPACING = 64
TEXT = 0  # the type of custom properties with text
RAW = 0  # the struct number of blocks without a struct: numbers, text, or arrays of pointers


class Block(NamedTuple):
    """Offsets of the header and content of a block; size of the content, old address, struct index."""

    head: int
    start: int
    size: int
    address: int
    struct: int


def canonical(content: bytes) -> bytes:
    """An uncompressed file of Blender 3.x on a little-endian 64-bit machine, with stable addresses."""
    if not content.startswith(b"BLENDER-v3"):
        raise ValueError("not an uncompressed .blend file of Blender 3.x")
    result = bytearray(content)
    blocks, catalogue = _blocks(content)
    structs = Structs(content[catalogue.start : catalogue.start + catalogue.size])
    numbers: dict[int, int] = {}
    for block in blocks:
        numbers.setdefault(block.address, SPACING * (len(numbers) + 1))
    _settle_chances(result, blocks, structs)
    for block in blocks:
        struct.pack_into("<Q", result, block.head + 8, numbers[block.address])
        words = np.frombuffer(result, np.uint64, block.size // 8, block.start)
        if block.struct == RAW:
            known = [k for k in np.flatnonzero(words) if int(words[k]) in numbers]
            for k in known:
                words[k] = numbers[int(words[k])]
            continue
        for k in structs.pointers(block.struct, block.size):
            words[k] = numbers.get(int(words[k]), 0)
        if structs.name(block.struct) == "ScrEdge":  # Blender sorts the two ends of a screen's edge by address
            ends = structs.offset("ScrEdge", "v1") // 8
            words[ends : ends + 2].sort()
    struct.pack_into("<Q", result, catalogue.head + 8, SPACING)
    return bytes(result)


def _settle_chances(content: bytearray, blocks: list[Block], structs: Structs) -> None:
    at = {block.address: block for block in blocks}
    for block in blocks:
        name = structs.name(block.struct)
        if name == "Mesh":
            struct.pack_into("<i", content, block.start + structs.offset("Mesh", "face_sets_color_seed"), 0)
        elif name == "PackedFile":
            _clear_after(content, at, block, structs.offset(name, "data"), structs.offset(name, "size"))
        elif name == "IDProperty" and content[block.start + structs.offset(name, "type")] == TEXT:
            _clear_after(content, at, block, structs.offset(name, "data"), structs.offset(name, "len"))


def _clear_after(content: bytearray, at: dict[int, Block], owner: Block, pointer: int, length: int) -> None:
    """Clear the unused part of a block, whose address and length are stored in its owner."""
    (address,) = struct.unpack_from("<Q", content, owner.start + pointer)
    (used,) = struct.unpack_from("<i", content, owner.start + length)
    block = at[address]
    content[block.start + used : block.start + block.size] = bytes(max(block.size - used, 0))


def _blocks(content: bytes) -> tuple[list[Block], Block]:
    """All blocks except the catalogue of structs, and the catalogue."""
    blocks, catalogue, place = [], None, HEADER
    while place < len(content):
        code, size, address, number, _ = BLOCK.unpack_from(content, place)
        block = Block(place, place + BLOCK.size, size, address, number)
        if code == b"ENDB":
            break
        if code == b"DNA1":
            catalogue = block
        else:
            blocks.append(block)
        place = block.start + size
    if catalogue is None:
        raise ValueError("the file has no catalogue of structs")
    return blocks, catalogue


class Structs:
    """The layout of structs, from the catalogue of a file."""

    def __init__(self, catalogue: bytes) -> None:
        self._data, self._place = catalogue, 4
        names = self._texts(b"NAME")
        types = self._texts(b"TYPE")
        self._tag(b"TLEN")
        self._sizes = self._shorts(len(types))
        self._tag(b"STRC")
        structs = []
        for _ in range(self._long()):
            kind, count = self._shorts(2)
            fields = self._shorts(2 * count)
            structs.append((kind, [(fields[2 * k], names[fields[2 * k + 1]]) for k in range(count)]))
        self._structs, self._types = structs, types
        self._number = {kind: number for number, (kind, _) in enumerate(structs)}
        self._known: dict[int, list[int]] = {}

    def name(self, number: int) -> str:
        return self._types[self._structs[number][0]]

    def offset(self, struct_name: str, field: str) -> int:
        """Offset of a field in a struct, bytes."""
        place = 0
        for kind, name in self._structs[self._number[self._types.index(struct_name)]][1]:
            if name.lstrip("*").split("[")[0] == field:
                return place
            place += self._extent(kind, name)
        raise ValueError(f"the struct {struct_name} has no field {field}")

    def _extent(self, kind: int, name: str) -> int:
        return _count(name) * (8 if name.startswith(("*", "(")) else self._sizes[kind])

    def pointers(self, number: int, size: int) -> list[int]:
        """Indices of the 8-byte words that are pointers, in a block of these structs."""
        length = self._sizes[self._structs[number][0]]
        offsets = self._offsets(number)
        return [(start + offset) // 8 for start in range(0, size - length + 1, length) for offset in offsets]

    def _offsets(self, number: int) -> list[int]:
        if number not in self._known:
            found, place = [], 0
            for kind, name in self._structs[number][1]:
                if name.startswith(("*", "(")):
                    found += [place + 8 * k for k in range(_count(name))]
                elif kind in self._number:
                    inner = self._offsets(self._number[kind])
                    found += [place + self._sizes[kind] * k + offset for k in range(_count(name)) for offset in inner]
                place += self._extent(kind, name)
            self._known[number] = found
        return self._known[number]

    def _tag(self, tag: bytes) -> None:
        self._place = -(-self._place // 4) * 4
        if self._data[self._place : self._place + 4] != tag:
            raise ValueError(f"the catalogue of structs lacks its {tag.decode()} part")
        self._place += 4

    def _long(self) -> int:
        self._place += 4
        return int(struct.unpack_from("<i", self._data, self._place - 4)[0])

    def _shorts(self, count: int) -> tuple[int, ...]:
        self._place += 2 * count
        return struct.unpack_from(f"<{count}H", self._data, self._place - 2 * count)

    def _texts(self, tag: bytes) -> list[str]:
        self._tag(tag)
        texts = []
        for _ in range(self._long()):
            end = self._data.index(b"\0", self._place)
            texts.append(self._data[self._place : end].decode("ascii"))
            self._place = end + 1
        return texts


def _count(name: str) -> int:
    """Number of values of a field like ``mat[4][4]``."""
    return int(np.prod([int(n) for n in re.findall(r"\[(\d+)\]", name)], initial=1))
