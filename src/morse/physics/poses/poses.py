"""Poses of nodes as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.mathutils.portable import matmul
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from morse.scene import Node
    from morse.scene.frames import RigidFrame


def as_array(matrix: Iterable[Iterable[float]]) -> NDArray[np.float64]:
    """Convert a matrix to an array (R, C)."""
    return np.array([list(row) for row in matrix], dtype=np.float64)


#: for each node the two frames of the last call, and the result: whenever an object is spawned or deleted, the poses of
#: all other nodes are asked for again
_known: WeakKeyDictionary[Node, tuple[RigidFrame, RigidFrame, NDArray[np.float64], NDArray[np.float64]]] = (
    WeakKeyDictionary()
)


def relative_pose(node: Node, frame: RigidFrame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the position (3,) and rotation (3, 3) of a node in a frame; the arrays are read-only."""
    own = rigid_frame(node)
    entry = _known.get(node)
    if entry is not None and entry[0] is own and entry[1] is frame:
        return entry[2], entry[3]
    inverse = as_array(frame.rotation).T
    position = matmul(inverse, np.array(own.position) - np.array(frame.position))
    rotation = matmul(inverse, as_array(own.rotation))
    position.flags.writeable = rotation.flags.writeable = False
    _known[node] = own, frame, position, rotation
    return position, rotation
