"""Texture coordinates of simple solids, on which files show pictures."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene import Mesh


def with_texture_coordinates(
    mesh: Mesh, repeat: tuple[float, float] = (1.0, 1.0), scale: Sequence[float] | None = None
) -> Mesh:
    """A mesh whose triangles show the picture as seen along the axis that is closest to their normal.

    The picture fills the bounding box of the mesh on each side.

    Args:
        repeat: how often the picture is repeated, horizontally and vertically.
        scale: with the scale (3,) of the node, the picture is repeated that often in each metre instead.
    """
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    side = np.abs(normals).argmax(axis=1)
    low = mesh.vertices.min(axis=0)
    size = np.maximum(mesh.vertices.max(axis=0) - low, 1e-9)
    shares = (corners - low) / size
    axes = np.array([[1, 2], [0, 2], [0, 1]])[side]
    uvs = np.take_along_axis(shares, axes[:, None, :].repeat(3, axis=1), axis=2)
    # seen from outside, the picture is not mirrored
    sign = np.take_along_axis(normals, side[:, None], axis=1)[:, 0] * np.array([1.0, -1.0, 1.0])[side]
    uvs[..., 0] = np.where(sign[:, None] < 0.0, 1.0 - uvs[..., 0], uvs[..., 0])
    uvs *= repeat
    if scale is not None:
        uvs *= (size * np.abs(scale))[axes][:, None, :]
    return replace(mesh, uvs=uvs.astype(np.float32))
