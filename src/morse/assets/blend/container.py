"""Reads the uncompressed bytes of a ``.blend`` file: size limits and decompression."""

from __future__ import annotations

import io
import stat
import zlib
from typing import TYPE_CHECKING

import zstandard

from morse.assets.blend.errors import Damage
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from pathlib import Path

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
