"""Panels: boxes that components move, each on its own, as one set."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from morse.assets.solids import cube
from morse.mathutils.portable import matmul
from morse.mathutils.rotations import quaternion_from_rotation
from morse.scene import BodySettings, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.core.context import Context
    from morse.core.interfaces import Carrier
    from morse.core.world import Body

    Floats = NDArray[np.float64]

#: m: a person, or the middle of a robot, that is that near to a panel is in its way; so is a mesh of a robot
_NEAR, _BESIDE = 0.45, 0.05
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

    def __init__(self, context: Context, owner: Body) -> None:
        self._context = context
        nodes = [node for node in owner.node.children if node.body.type is PhysicsType.KINEMATIC]
        self._bodies = [context.world.object_of(node) for node in nodes]
        self._rows = context.world.kinematic_bodies(self._bodies)
        position, rotation = owner.world_pose()
        self.origin = np.array(position, dtype=np.float64)
        self.axes = np.reshape(np.array(rotation, dtype=np.float64), (3, 3))
        self._turn = quaternion_from_rotation(tuple(rotation))  # type: ignore[arg-type]
        #: corners (8, 3) of boxes around robots, in their frames
        self._boxes: WeakKeyDictionary[Carrier, Floats] = WeakKeyDictionary()

    def place(self, positions: Floats, angles: Floats) -> None:
        """Set the panels.

        Args:
            positions: (N, 3) of their centres in the frame of the component, m.
            angles: (N,) about its Z axis, rad.
        """
        world = self.origin + matmul(positions, self.axes.T)
        w, x, y, z = self._turn
        turned = [(math.cos(half), math.sin(half)) for half in (0.5 * angles).tolist()]
        self._rows.place(
            world, np.array([(w * c - z * s, x * c + y * s, y * c - x * s, w * s + z * c) for c, s in turned])
        )

    def present(self, height: float = 0.0) -> Floats:
        """Return the places (M, 2) of robots and people on a floor, in the frame of the component, m.

        Args:
            height: of the floor above the component, m; who is up to 2 m above it is on it.
        """
        points = [np.zeros((0, 3))]
        for robot in self._context.robots.values():
            if isinstance(robot, Facility):
                continue
            people = _people(robot)
            points.append(np.reshape(robot.bge_object.world_pose()[0], (1, 3)) if people is None else people)
        own = matmul(np.concatenate(points) - self.origin, self.axes)
        return np.asarray(own[(own[:, 2] > height - 0.5) & (own[:, 2] < height + 2.0), :2])

    def is_in_way(self, people: Floats, low: Sequence[float], high: Sequence[float]) -> bool:
        """Whether somebody is in a box, or near it.

        Args:
            people: see `present`.
            low, high: (3,) corners of the box in the frame of the component, m.
        """
        if ((people > np.array(low[:2]) - _NEAR) & (people < np.array(high[:2]) + _NEAR)).all(axis=1).any():
            return True
        robots = [robot for robot in self._context.robots.values() if not isinstance(robot, Facility)]
        return any(_people(robot) is None and self._is_robot_in(robot, low, high) for robot in robots)

    def _is_robot_in(self, robot: Carrier, low: Sequence[float], high: Sequence[float]) -> bool:
        """Whether the box around a robot meets another one: no axis of their faces separates them, seen from above."""
        if robot not in self._boxes:
            node = robot.bge_object.node
            corners = extent(node.walk(), node)
            own = np.zeros((0, 3)) if corners is None else np.array([*product(*zip(*corners, strict=True))])
            self._boxes[robot] = own
        if not len(self._boxes[robot]):
            return False
        position, rotation = robot.bge_object.world_pose()
        turn = matmul(self.axes.T, np.reshape(rotation, (3, 3)))
        corners = matmul(self._boxes[robot], turn.T) + matmul(np.array(position) - self.origin, self.axes)
        lower, upper = np.array(low) - _BESIDE, np.array(high) + _BESIDE
        if corners[:, 2].max() < lower[2] or corners[:, 2].min() > upper[2]:
            return False
        box = np.array([*product((lower[0], upper[0]), (lower[1], upper[1]))])
        normals = np.concatenate([np.eye(2), np.stack([-turn[1], turn[0]], axis=1)])
        a, b = matmul(corners[:, :2], normals.T), matmul(box, normals.T)
        return bool(((a.max(axis=0) >= b.min(axis=0)) & (a.min(axis=0) <= b.max(axis=0))).all())


class Facility:
    """What does not count as a robot: it does not open doors."""


def _people(robot: Carrier) -> Floats | None:
    """Return the places (N, 3) of the people of a crowd, m; None for what is no crowd."""
    data = robot.local_data
    if "present" not in data or "positions" not in data:
        return None
    positions: Floats = np.reshape(np.asarray(data["positions"], dtype=np.float64), (-1, 3))
    return np.asarray(positions[np.asarray(data["present"], dtype=bool)])


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
