"""Panels: boxes that components move, each on its own, as one set."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.solids import cube
from morse.mathutils.portable import matmul
from morse.scene import BodySettings, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.world import Body

    Floats = NDArray[np.float64]

#: m: a person or robot that is that near to a panel is in its way
_NEAR = 0.45
#: angle of a hinged door that is open, rad
_WIDE = math.radians(95.0)


def panel(name: str, size: Sequence[float], color: Sequence[float]) -> Node:
    """Return a box of a size (x, y, z), m, around its origin, which explicit calls move."""
    box = cube()
    half = np.array(size, dtype=np.float64) / 2.0
    red, green, blue = color
    material = Material(f"{name} paint", color=(red, green, blue, 1.0), roughness=0.5)
    corners = (box.vertices * half).astype(np.float32)
    mesh = Mesh(name, corners, box.triangles, box.material_index, materials=(material,))
    node = Node(name, NodeKind.MESH, mesh=mesh, body=BodySettings(type=PhysicsType.KINEMATIC))
    node.shapes = [CollisionShape(ShapeKind.BOX, tuple(half.tolist()))]
    return node


class Panels:
    """The panels of a component, in the frame of its node at the start.

    Args:
        owner: the body of the component.
    """

    def __init__(self, context: Context, owner: Body, nodes: Sequence[Node]) -> None:
        self._context = context
        self._bodies = [context.world.object_of(node) for node in nodes]
        self._rows = context.world.kinematic_bodies(self._bodies)
        position, rotation = owner.world_pose()
        self.origin = np.array(position, dtype=np.float64)
        self.axes = np.reshape(np.array(rotation, dtype=np.float64), (3, 3))
        self._heading = math.atan2(self.axes[1, 0], self.axes[0, 0])

    def place(self, positions: Floats, angles: Floats) -> None:
        """Set the panels.

        Args:
            positions: (N, 3) of their centres in the frame of the component, m.
            angles: (N,) about its Z axis, rad.
        """
        world = self.origin + matmul(positions, self.axes.T)
        half = 0.5 * (angles + self._heading)
        turned = np.array([[math.cos(one), 0.0, 0.0, math.sin(one)] for one in half.tolist()])
        self._rows.place(world, turned)

    def present(self, height: float = 0.0) -> Floats:
        """Return the places (M, 2) of robots and people on a floor, in the frame of the component, m.

        Args:
            height: of the floor above the component, m; who is up to 2 m above it is on it.
        """
        points = []
        for robot in self._context.robots.values():
            data = robot.local_data
            if "present" in data and "positions" in data:
                points += np.asarray(data["positions"])[np.asarray(data["present"], dtype=bool)].tolist()
            elif not isinstance(robot, Facility):
                points.append(list(robot.bge_object.world_pose()[0]))
        own = matmul(np.reshape(np.array(points, dtype=np.float64), (-1, 3)) - self.origin, self.axes)
        return np.asarray(own[(own[:, 2] > height - 0.5) & (own[:, 2] < height + 2.0), :2])


class Facility:
    """What does not count as a robot: it does not open doors."""


def door_places(kind: str, width: float, height: float, openness: float) -> tuple[Floats, Floats]:
    """Return positions (N, 3), m, and angles (N,), rad, of the panels of a hinged, sliding or double door."""
    middle = 0.5 * height
    if kind == "hinged":
        angle = -_WIDE * openness
        # the hinge is at y = -width / 2; the panel extends from it to the left
        x, y = -0.5 * width * math.sin(angle), -0.5 * width + 0.5 * width * math.cos(angle)
        return np.array([[x, y, middle]]), np.array([angle])
    if kind == "sliding":
        return np.array([[0.0, width * openness, middle]]), np.zeros(1)
    apart = 0.25 * width + 0.5 * width * openness
    return np.array([[0.0, -apart, middle], [0.0, apart, middle]]), np.zeros(2)


def lift_places(levels: Sequence[float], cabin: Sequence[float], height: float, openness: float) -> Floats:
    """Return positions (N, 3), m: floor, walls and doors of the cabin, and two doors of each floor.

    Args:
        levels: heights of the floors, m.
        cabin: depth, width and height, m.
        height: of the cabin above the lowest floor, m.
        openness: of the doors of the cabin, and of the floor where it stands.
    """
    depth, width, tall = cabin
    middle, closed = 0.5 * tall, 0.25 * width
    apart = closed + 0.5 * width * openness
    rows = [
        (0.0, 0.0, height - 0.05),
        (-0.5 * depth + 0.025, 0.0, height + middle),
        (0.0, 0.5 * width - 0.025, height + middle),
        (0.0, -0.5 * width + 0.025, height + middle),
        (0.5 * depth - 0.02, -apart, height + middle),
        (0.5 * depth - 0.02, apart, height + middle),
    ]
    for level in levels:
        own = apart if level == height else closed
        rows += [(0.5 * depth + 0.04, -own, level + middle), (0.5 * depth + 0.04, own, level + middle)]
    return np.array(rows)


def is_in_way(points: Floats, low: tuple[float, float], high: tuple[float, float]) -> bool:
    """Whether somebody is in a rectangle, or near it."""
    if not len(points):
        return False
    inside = (points > np.array(low) - _NEAR) & (points < np.array(high) + _NEAR)
    return bool(inside.all(axis=1).any())
