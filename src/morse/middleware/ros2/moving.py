"""Frames of the moving parts of a robot: wheels, heads, links of arms."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.middleware.ros2.names import relative_name
from morse.middleware.ros2.poses import between, pose_of, product

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.moving_parts import MovingPart
    from morse.helpers.transformation import Transformation3d
    from morse.middleware.ros2.names import Names


class Joint(NamedTuple):
    """A joint of a robot.

    Attributes:
        owner: the robot or the component that has the joint.
        name: its name in ``sensor_msgs/JointState`` and in the description of the robot.
        part: the part that it moves.
        frame: frame of the part.
        parent: parent frame of the joint.
        against: the object of the parent frame.
    """

    owner: Any
    name: str
    part: MovingPart
    frame: str
    parent: str
    against: Any

    def pose(self) -> Transformation3d:
        """The present pose of the part in the parent frame."""
        return between(self.against, self.part.object)

    def origin(self) -> Transformation3d:
        """The pose of the part at joint position 0."""
        x, y, z = self.part.axis
        position = self.part.position()
        if self.part.type == "prismatic":
            back = pose_of((-position * x, -position * y, -position * z), (1.0, 0.0, 0.0, 0.0))
        else:
            s = math.sin(-position / 2.0)
            back = pose_of((0.0, 0.0, 0.0), (math.cos(position / 2.0), s * x, s * y, s * z))
        return product(self.pose(), back)


def joints_of(robot: Any, names: Names) -> list[Joint]:
    """All joints of a robot and its components; joints of two components with the same name contain the component."""
    carried = [one for one in robot.context.components.values() if one.robot_parent is robot]
    owners = [(owner, list(owner.moving_parts())) for owner in (robot, *carried)]
    known = [part.joint for _, parts in owners for part in parts]
    found: list[Joint] = []
    for owner, parts in owners:
        for part in parts:
            above = next((joint for joint in found if joint.part.object is part.parent), None)
            found.append(
                Joint(
                    owner,
                    _name(owner, part.joint, single=known.count(part.joint) == 1),
                    part,
                    names.part(owner, part.joint),
                    names.base(robot) if above is None else above.frame,
                    robot.bge_object if above is None else above.part.object,
                )
            )
    return found


def _name(owner: Any, joint: str, *, single: bool) -> str:
    return joint if single or owner.robot_parent is None else f"{relative_name(owner)}/{joint}".replace(".", "/")


def name_of(joints: list[Joint], sensor: Any, joint: str) -> str:
    """The name of the joint that a sensor measures: of several joints of that name, the one that carries the sensor."""
    alike = [one for one in joints if one.part.joint == joint]
    over = [one for one in alike if sensor.name().startswith(f"{one.owner.name()}.")]
    return (over or alike)[-1].name if len(alike) > 1 and over else joint


def poses_of(joints: list[Joint]) -> Iterator[tuple[str, str, Transformation3d]]:
    """Parent, frame and pose of all moving parts."""
    for joint in joints:
        yield joint.parent, joint.frame, joint.pose()
