"""Rigid frames of nodes; scale is part of meshes, never of poses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from morse.mathutils import Matrix, Quaternion, Vector

if TYPE_CHECKING:
    from morse.scene.node import Node


@dataclass(frozen=True, slots=True)
class RigidFrame:
    """The pose of a node without scale.

    ``world_point = position + rotation @ (stretch @ mesh_point)``

    Attributes:
        position: metres, world frame.
        rotation: 3x3 proper rotation, node to world.
        stretch: 3x3 scale and shear (and mirroring) of the vertices of the mesh of the node.
    """

    position: Vector
    rotation: Matrix
    stretch: Matrix

    @property
    def quaternion(self) -> Quaternion:
        """The rotation as w, x, y, z."""
        return self.rotation.to_quaternion()

    @property
    def is_unstretched(self) -> bool:
        """Whether the mesh keeps its size."""
        return all(abs(self.stretch[i][j] - (i == j)) < 1e-9 for i in range(3) for j in range(3))


def rigid_frame(node: Node) -> RigidFrame:
    """The rigid frame of a node, from its world matrix.

    The rotation consists of the orthonormalised columns of the matrix, as in Blender.
    """
    world = node.world_matrix()
    columns = [Vector([world[row][column] for row in range(3)]) for column in range(3)]
    x = _unit(columns[0], Vector((1.0, 0.0, 0.0)))
    y = columns[1] - x * columns[1].dot(x)
    y = _unit(y, Vector((0.0, 1.0, 0.0)) if abs(x[1]) < 0.9 else Vector((0.0, 0.0, 1.0)))
    y = _unit(y - x * y.dot(x), y)
    z = x.cross(y)
    rotation = Matrix(tuple((x[i], y[i], z[i]) for i in range(3)))
    linear = Matrix(tuple(tuple(world[i][j] for j in range(3)) for i in range(3)))
    return RigidFrame(Vector([world[i][3] for i in range(3)]), rotation, rotation.transposed() @ linear)


def _unit(vector: Vector, fallback: Vector) -> Vector:
    length = vector.length
    return vector * (1.0 / length) if length > 1e-12 else fallback
