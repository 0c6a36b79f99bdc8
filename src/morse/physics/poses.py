"""Poses of nodes as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.scene import Node
    from morse.scene.frames import RigidFrame


def as_array(matrix: Any) -> NDArray[np.float64]:
    """Convert a matrix to an array (R, C)."""
    return np.array([list(row) for row in matrix], dtype=np.float64)


def relative_pose(node: Node, frame: RigidFrame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the position (3,) and rotation (3, 3) of a node in a frame."""
    own = rigid_frame(node)
    turned = as_array(frame.rotation).T
    return turned @ (np.array(own.position) - np.array(frame.position)), turned @ as_array(own.rotation)
