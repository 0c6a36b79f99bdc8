"""Frames of the moving parts of a robot: wheels, heads, links of arms."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.core.robot_parts import FIXED
from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotations import turn
from morse.rosmsgs.names import relative_name
from morse.rosmsgs.parts import between, pose_of, product

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.core.robot_parts import MovingPart
    from morse.core.sensor import Sensor
    from morse.core.world import Body
    from morse.rosmsgs.names import Names

#: m and rad
_SAME = 1e-9


class Joint(NamedTuple):
    """A joint of a robot.

    Attributes:
        owner: the robot or the component that has the joint.
        name: its name in ``sensor_msgs/JointState`` and in the description of the robot.
        part: the part that it moves.
        frame: frame of the part.
        parent: parent frame of the joint.
        against: the object of the parent frame.
        shift: (3,) m, origin of the parent frame in the frame of that object.
    """

    owner: Object
    name: str
    part: MovingPart
    frame: str
    parent: str
    against: Body
    shift: Sequence[float] = (0.0, 0.0, 0.0)

    @property
    def is_fixed(self) -> bool:
        """Whether the part does not move."""
        return self.part.type == FIXED

    def place(self) -> Transformation3d:
        """The present pose of the frame of the part in the world."""
        return placed(self.part.object, self.part.offset)

    def pose(self) -> Transformation3d:
        """The present pose of the frame of the part in the parent frame."""
        return placed(self.against, self.shift).transformation3d_with(self.place())

    def is_between_bodies(self) -> bool:
        """Whether both frames are those of bodies of the engine, without any offset."""
        objects = self.part.object, self.against
        return not any((*self.part.offset, *self.shift)) and not any(one.mounting.is_apart for one in objects)

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


class MovingFrame(NamedTuple):
    """A frame that moves.

    Attributes:
        parent, child: names of frames.
        object: the object of the frame.
        against: the object of the parent frame; None for an initial pose.
        start: the initial pose, or None.
    """

    parent: str
    child: str
    object: Body
    against: Body | None
    start: Transformation3d | None

    def pose(self) -> Transformation3d:
        """The present pose in the parent frame."""
        present = Transformation3d(self.object)
        return (self.start or Transformation3d(self.against)).transformation3d_with(present)


def placed(obj: Body, offset: Sequence[float]) -> Transformation3d:
    """The pose of an object in the world, with its origin moved by an offset (3,) in its axes."""
    pose = Transformation3d(obj)
    if any(offset):
        position, rotation = pose.get_pose()
        origin = [p + q for p, q in zip(position, turn(rotation, offset), strict=True)]
        pose.set_pose(origin, rotation)
    return pose


def joints_of(robot: Robot, names: Names) -> list[Joint]:
    """All joints of a robot and its components; joints of two components with the same name contain the component."""
    components = [one for one in robot.context.components.values() if one.robot_parent is robot]
    owners = [(owner, list(owner.moving_parts())) for owner in (robot, *components)]
    names_of_joints = [part.joint for _, parts in owners for part in parts]
    base = names.base(robot)
    frames = {names.own(one) for one in components} | {names.odom(robot), base}
    #: object of a part to its frame, and the offset of the frame
    above: dict[int, tuple[str, Body, Sequence[float]]] = {}
    joints: list[Joint] = []
    for owner, parts in owners:
        for part in parts:
            parent, against, shift = above.get(id(part.parent), (base, robot.bge_object, _NOTHING))
            if names.link(robot, part.frame) == base and _is_body(part, robot):
                # the first link of a file is often called base_link, too
                above[id(part.object)] = (base, robot.bge_object, _NOTHING)
                continue
            frame = names.link(robot, part.frame) if part.frame else names.part(owner, part.joint)
            if part.frame and frame in frames:
                frame = names.part(owner, part.frame)
            frames.add(frame)
            above[id(part.object)] = (frame, part.object, part.offset)
            name = _name(owner, part.joint, single=names_of_joints.count(part.joint) == 1)
            joints.append(Joint(owner, name, part, frame, parent, against, shift))
    return joints


_NOTHING = (0.0, 0.0, 0.0)


def _is_body(part: MovingPart, robot: Object) -> bool:
    """Whether a part is the body of the robot itself, with the same frame."""
    if part.type != FIXED or part.parent is not None:
        return False
    pose = between(robot.bge_object, part.object)
    return max(abs(value) for value in (pose.x, pose.y, pose.z, pose.yaw, pose.pitch, pose.roll)) < _SAME


def _name(owner: Object, joint: str, *, single: bool) -> str:
    return joint if single or owner.robot_parent is None else f"{relative_name(owner)}/{joint}".replace(".", "/")


def name_of(joints: list[Joint], sensor: Sensor, joint: str) -> str:
    """The name of the joint that a sensor measures: of several joints of that name, the one that carries the sensor."""
    alike = [one for one in joints if one.part.joint == joint]
    over = [one for one in alike if sensor.name().startswith(f"{one.owner.name()}.")]
    return (over or alike)[-1].name if len(alike) > 1 and over else joint


def poses_of(joints: list[Joint]) -> Iterator[tuple[str, str, Transformation3d]]:
    """Parent, frame and pose of parts."""
    for joint in joints:
        yield joint.parent, joint.frame, joint.pose()
