"""Collision shapes in the rigid frame of a node."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


class ShapeKind(StrEnum):
    """The shapes that the physics supports."""

    BOX = "box"
    SPHERE = "sphere"
    CYLINDER = "cylinder"
    CAPSULE = "capsule"
    ELLIPSOID = "ellipsoid"
    CONVEX = "convex"
    HEIGHT_FIELD = "height field"


@dataclass(eq=False, slots=True, weakref_slot=True)
class CollisionShape:
    """One convex piece of a body, or a height field.

    Attributes:
        size: metres. Box and ellipsoid: three half sizes; sphere: radius; cylinder and capsule:
            radius and half length (of the straight part) along Z; convex: empty; height field: half sizes along X and
            Y, largest height, thickness below height 0.
        position: position of its centre in the frame of the node.
        rotation: row-major 3x3 rotation from the shape to the node.
        vertices: (V, 3) points whose hull is the shape, in the frame of the node (only for convex shapes).
        heights: (R, C) heights of at least 0, m; rows along Y, columns along X (height field only).
    """

    kind: ShapeKind
    size: tuple[float, ...]
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float, float, float, float, float, float] = _IDENTITY
    vertices: NDArray[np.float64] | None = None
    heights: NDArray[np.float64] | None = None
