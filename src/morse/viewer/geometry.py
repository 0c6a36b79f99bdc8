"""Meshes in the format of graphics cards."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene import Mesh


@dataclass(frozen=True, slots=True)
class PackedMesh:
    """An indexed mesh as bytes, little-endian.

    Attributes:
        data: positions (V, 3) float32, normals (V, 3) float32, texture coordinates (V, 2) float32 if present,
            indices (I,) uint32.
        vertices: V.
        indices: I.
        textured: whether it has texture coordinates.
        groups: (first index, number of indices, material slot), in the order of the indices.
    """

    data: bytes
    vertices: int
    indices: int
    textured: bool
    groups: tuple[tuple[int, int, int], ...]


def pack_mesh(mesh: Mesh) -> PackedMesh:
    """Merge corners with equal position, normal and texture coordinates, and sort triangles by material."""
    order = np.argsort(mesh.material_index, kind="stable")
    triangles = mesh.triangles[order]
    corners = mesh.vertices[triangles].astype(np.float32)
    normals = _face_normals(corners) if mesh.normals is None else mesh.normals[order].astype(np.float32)
    parts = [corners.reshape(-1, 3), normals.reshape(-1, 3)]
    if mesh.uvs is not None:
        parts.append(mesh.uvs[order].astype(np.float32).reshape(-1, 2))
    rows = np.nan_to_num(np.concatenate(parts, axis=1)) + np.float32(0.0)  # the sum converts -0 to 0
    first, indices = _distinct(rows)
    rows = rows[first]
    columns = [rows[:, :3], rows[:, 3:6]] + ([rows[:, 6:8]] if mesh.uvs is not None else [])
    data = b"".join(np.ascontiguousarray(column, dtype="<f4").tobytes() for column in columns)
    return PackedMesh(
        data=data + indices.astype("<u4").tobytes(),
        vertices=len(rows),
        indices=len(indices),
        textured=mesh.uvs is not None,
        groups=_groups(mesh.material_index[order]),
    )


def _face_normals(corners: NDArray[np.float32]) -> NDArray[np.float32]:
    """(T, 3, 3) flat normals: equal for all corners of a triangle; +Z for triangles without area."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    flat = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), np.array([0.0, 0.0, 1.0]))
    return np.repeat(flat[:, None, :], 3, axis=1).astype(np.float32)


def _distinct(rows: NDArray[np.float32]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The first index of each distinct row, and for every row the index of its distinct row."""
    words = np.ascontiguousarray(rows).view(np.uint32).astype(np.uint64)
    factors = np.random.default_rng(1).integers(1, 2**63, size=words.shape[1], dtype=np.uint64) | np.uint64(1)
    hashes = words * factors
    hashes ^= hashes >> np.uint64(29)
    # sorting one number per row is an order of magnitude faster than sorting rows
    _, first, inverse = np.unique(hashes.sum(axis=1, dtype=np.uint64), return_index=True, return_inverse=True)
    if not np.array_equal(rows[first][inverse], rows):
        _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first, inverse.reshape(-1)


def _groups(slots: NDArray[np.int32]) -> tuple[tuple[int, int, int], ...]:
    if len(slots) == 0:
        return ()
    starts = np.flatnonzero(np.diff(slots, prepend=slots[0] - 1))
    ends = np.append(starts[1:], len(slots))
    return tuple((int(a) * 3, int(b - a) * 3, int(slots[a])) for a, b in zip(starts, ends, strict=True))
