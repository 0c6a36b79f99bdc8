"""The parts into which a mesh is decomposed."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from morse.mathutils import portable
from morse.mathutils.portable import matmul
from morse.scene.body import CollisionShape, ShapeKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

PrimitiveKind: TypeAlias = Literal["box", "sphere", "cylinder", "capsule", "cone"]

CONE_SIDES = 24  # the physics has no cones: a cone becomes a pyramid with this number of sides


@dataclass(eq=False, slots=True)
class Primitive:
    """A simple solid in the frame of the mesh.

    Attributes:
        size: metres. Box: three half sizes; sphere: radius; cylinder and cone: radius and half height; capsule: radius
            and half length of its straight part. Cylinder, cone (tip up) and capsule are along Z.
        position: (3,) position of its centre.
        rotation: (3, 3) rotation from the frame of the solid to that of the mesh.
    """

    kind: PrimitiveKind
    size: tuple[float, ...]
    position: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    rotation: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))

    def to_shape(self) -> CollisionShape:
        """Return the shape for the physics."""
        if self.kind == "cone":
            return ConvexPart(self._cone_points()).to_shape()
        x, y, z = self.position.tolist()
        a, b, c, d, e, f, g, h, i = self.rotation.ravel().tolist()
        return CollisionShape(ShapeKind(self.kind), self.size, (x, y, z), (a, b, c, d, e, f, g, h, i))

    def _cone_points(self) -> NDArray[np.float64]:
        radius, half = self.size
        turn = np.arange(CONE_SIDES) * (2.0 * math.pi / CONE_SIDES)
        base = np.column_stack([radius * portable.cos(turn), radius * portable.sin(turn), np.full(CONE_SIDES, -half)])
        return np.asarray(matmul(np.vstack([base, [0.0, 0.0, half]]), self.rotation.T) + self.position)


@dataclass(eq=False, slots=True)
class ConvexPart:
    """The convex hull of points.

    Attributes:
        points: (P, 3) metres, in the frame of the mesh; not all in one plane.
    """

    points: NDArray[np.float64]

    def to_shape(self) -> CollisionShape:
        """Return the shape for the physics."""
        return CollisionShape(ShapeKind.CONVEX, (), vertices=self.points)


Part: TypeAlias = Primitive | ConvexPart
