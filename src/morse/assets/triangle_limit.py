"""The largest numbers of triangles and of parts in a model file."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

#: collision shapes, rays and images take about 1 kB for each
MOST_TRIANGLES = 5_000_000
#: corners of a polygon
MOST_CORNERS = 10_000
#: nodes, and meshes with one material; each takes about 0.7 ms
MOST_PARTS = 5_000
#: materials; each takes about 1.3 ms
MOST_MATERIALS = 2_000
#: bytes of a binary STL file: before its triangles, and of each of them
_STL_HEADER, _STL_TRIANGLE = 84, 50


def check_triangles(path: str | Path, counts: Iterable[int]) -> None:
    """Refuse a file with too many triangles.

    Args:
        counts: numbers of triangles of its meshes.

    Raises:
        AssetError: they exceed `MOST_TRIANGLES`.
    """
    count = sum(counts)
    if count > MOST_TRIANGLES:
        raise AssetError(
            path,
            f"it has {count:,} triangles, and the limit of a file is {MOST_TRIANGLES:,}; reduce its triangles, for "
            "example with the modifier 'Decimate' of Blender, or divide the model into several files",
        )


def check_parts(path: str | Path, count: int, what: str, most: int = MOST_PARTS) -> None:
    """Refuse a file with too many parts.

    Raises:
        AssetError: they exceed the limit.
    """
    if count > most:
        number = str(count) if count < 1000 * most else "millions of"
        raise AssetError(path, f"it has {number} {what}, at most {most} can be read: join some of them")


def check_corners(path: Path, corners: int) -> None:
    """Refuse a file with a polygon of too many corners.

    Raises:
        AssetError: they exceed `MOST_CORNERS`.
    """
    if corners > MOST_CORNERS:
        raise AssetError(
            path, f"it has a polygon of {corners:,} corners, at most {MOST_CORNERS:,} can be read: divide it into "
            "triangles",
        )  # fmt: skip


def check_stl(path: Path) -> None:
    """Refuse an STL file with too many solids or triangles, or a binary one of another length, before it is read.

    Raises:
        AssetError: a number is too large, or that in the header of a binary file does not match its size.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        header = file.read(_STL_HEADER)
    if _is_text(header):
        check_parts(path, path.read_bytes().lower().count(b"endsolid"), "solids")
    if len(header) < _STL_HEADER:
        if not _is_text(header):
            raise AssetError(path, f"it is cut off: a binary STL file has at least {_STL_HEADER} bytes, it has {size}")
        return
    (count,) = struct.unpack("<I", header[-4:])
    if size == _STL_HEADER + _STL_TRIANGLE * count:
        check_triangles(path, [count])
    elif not _is_text(header):
        room = (size - _STL_HEADER) // _STL_TRIANGLE
        raise AssetError(
            path, f"its header states {count:,} triangles, its {size:,} bytes have room for {room:,}: export it again"
        )


def _is_text(header: bytes) -> bool:
    return header.lstrip().lower().startswith(b"solid") and b"\0" not in header
