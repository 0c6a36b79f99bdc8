"""Height fields of an MJCF file: how much memory they ask for, and their meshes."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.nearby_files import FileRefusedError
from morse.scene import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: points of the height fields of a file, which become two triangles each, and of one whose heights are not in a file
MOST_POINTS, _MOST_IMPLIED = 2_500_000, 1 << 19
_PNG = b"\x89PNG\r\n\x1a\n"


def check_points(rows: float, columns: float) -> float:
    """Return the number of points of a height field; raise FileRefusedError if there are too many."""
    if not rows * columns <= MOST_POINTS:
        raise FileRefusedError(f"it has {rows:.6g} x {columns:.6g} points, more than {MOST_POINTS}")
    return rows * columns


def check_implied(rows: float, columns: float) -> None:
    """Raise FileRefusedError if a height field without a file has too many points."""
    if not rows * columns <= _MOST_IMPLIED:
        raise FileRefusedError(f"it has {rows:.6g} x {columns:.6g} points without a file, more than {_MOST_IMPLIED}")


def suffix_of(content: bytes) -> str:
    """Return the suffix of a file of heights, a PNG or the binary format of MuJoCo, after a check of its size.

    Raises:
        FileRefusedError: it is neither, or asks for more memory than it should.
    """
    if content[:8] == _PNG and len(content) > 24:
        columns, rows = struct.unpack(">II", content[16:24])
        check_points(rows, columns)
        return ".png"
    if len(content) >= 8:
        rows, columns = struct.unpack("<ii", content[:8])
        if rows > 0 and columns > 0 and len(content) == 8 + 4 * rows * columns:
            check_points(rows, columns)
            return ".hf"
    raise FileRefusedError("it is neither a PNG image nor a binary file of heights (rows, columns, 32-bit numbers)")


def height_mesh(name: str, size: tuple[float, ...], heights: NDArray[np.float64]) -> Mesh:
    """Return the surface as a mesh, with the triangles with which the engine collides.

    Args:
        size: half sizes along X and Y, m.
        heights: (R, C) m; rows along Y, columns along X.
    """
    rows, columns = heights.shape
    vertices = np.empty((rows, columns, 3), dtype=np.float32)
    vertices[..., 0] = np.linspace(-size[0], size[0], columns)
    vertices[..., 1] = np.linspace(-size[1], size[1], rows)[:, None]
    vertices[..., 2] = heights
    corner = (np.arange(rows - 1, dtype=np.int32)[:, None] * columns + np.arange(columns - 1, dtype=np.int32)).ravel()
    triangles = np.empty((2, len(corner), 3), dtype=np.int32)
    for half, offsets in zip(triangles, ((0, 1, columns + 1), (0, columns + 1, columns)), strict=True):
        for place, offset in enumerate(offsets):
            np.add(corner, np.int32(offset), out=half[:, place])
    faces = triangles.reshape(-1, 3)
    return Mesh(name, vertices.reshape(-1, 3), faces, np.zeros(len(faces), dtype=np.int32))
