"""The bytes of a ``.blend`` file: size limits, decompression, and the blocks of which it consists."""

from __future__ import annotations

import io
import re
import stat
import struct
import zlib
from typing import TYPE_CHECKING, NamedTuple

import zstandard

from morse.assets.errors import AssetError
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from pathlib import Path


class BlendError(AssetError):
    """A ``.blend`` file cannot be read at all."""


class Excess(Exception):
    """Reading the file would take longer than for any real scene; it is not read further."""


class Damage(Exception):
    """A part of the file is inconsistent; the caller decides what is left out."""


#: maximum size after decompression, bytes
SIZE_LIMIT = 1 << 30
#: size after decompression below which the compression ratio is not checked, bytes
_HARMLESS = 64 << 20
#: maximum compression ratio (scenes have 2 to 20); files with a higher ratio are decompression bombs
_MAX_RATIO = 50
_CHUNK = 1 << 20
#: bytes of a gzip file that are decompressed at once, and its parts, of which Blender writes one
_PIECE, _MOST_MEMBERS = 1 << 16, 10_000
_ZSTD_WINDOW = 128 << 20

_GZIP = b"\x1f\x8b"
_ZSTD = b"\x28\xb5\x2f\xfd"
_ZSTD_SKIPPABLE = b"\x2a\x4d\x18"


def load(path: Path, limit: int = SIZE_LIMIT) -> bytes:
    """The uncompressed content of a plain, gzip (before 3.0) or zstd (since 3.0) compressed file.

    Raises:
        Damage: it is not a regular file, is too large, or its compression is damaged.
        OSError: it cannot be opened.
    """
    mode = path.stat().st_mode
    # checked before it is opened, because opening a pipe would block
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):
        raise Damage("this is not a regular file")
    if path.stat().st_size > limit:
        raise Damage(f"the file is larger than the limit of {_size(limit)}")
    data = read_regular(path, limit)
    if data[:2] == _GZIP:
        return _gunzip(data, limit)
    if data[:4] == _ZSTD or data[1:4] == _ZSTD_SKIPPABLE:
        return _unzstd(data, limit)
    return data


def _gunzip(data: bytes, limit: int) -> bytes:
    out = io.BytesIO()
    view, place, members = memoryview(data), 0, 0
    while view[place : place + 2] == _GZIP:
        members += 1
        if members > _MOST_MEMBERS:
            raise Damage(f"its gzip compression has more than {_MOST_MEMBERS} parts")
        member = zlib.decompressobj(wbits=31)
        while not member.eof:
            # a decompressor copies what it does not use: of a short piece, not of the file
            given = view[place : place + _PIECE]
            try:
                piece = member.decompress(given, _CHUNK)
            except zlib.error as error:
                raise Damage(f"its gzip compression is broken ({error})") from error
            out.write(piece)
            _check(out.tell(), len(data), limit)
            place += len(given) - len(member.unconsumed_tail) - len(member.unused_data)
            if not piece and not given and not member.eof:
                raise Damage("the file is cut off: its gzip stream has no end")
    return out.getvalue()


def _unzstd(data: bytes, limit: int) -> bytes:
    out = io.BytesIO()
    # Blender writes many frames, and a seek table in a frame that decoders skip
    decoder = zstandard.ZstdDecompressor(max_window_size=_ZSTD_WINDOW)
    try:
        with decoder.stream_reader(io.BytesIO(data), read_across_frames=True) as reader:
            while piece := reader.read(_CHUNK):
                out.write(piece)
                _check(out.tell(), len(data), limit)
    except zstandard.ZstdError as error:
        raise Damage(f"its zstd compression is broken ({error})") from error
    return out.getvalue()


def _check(size: int, packed_size: int, limit: int) -> None:
    if size > limit:
        raise Damage(f"it would grow beyond the limit of {_size(limit)} when decompressed")
    if size > _HARMLESS and size > packed_size * _MAX_RATIO:
        raise Damage(f"its {packed_size} bytes would grow more than {_MAX_RATIO} times when decompressed")


def _size(count: int) -> str:
    return f"{count / (1 << 20):g} MiB"


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
