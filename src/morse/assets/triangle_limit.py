"""The largest number of triangles in a model file."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from morse.assets.errors import AssetError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

#: collision shapes, rays and images take about 1 kB for each
MOST_TRIANGLES = 5_000_000
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


def check_stl(path: Path) -> None:
    """Refuse a binary STL file with too many triangles before it is read; see `check_triangles`."""
    with path.open("rb") as file:
        header = file.read(_STL_HEADER)
    if len(header) < _STL_HEADER:
        return
    (count,) = struct.unpack("<I", header[-4:])
    # other files with this ending are text, and the number means nothing
    if path.stat().st_size == _STL_HEADER + _STL_TRIANGLE * count:
        check_triangles(path, [count])
