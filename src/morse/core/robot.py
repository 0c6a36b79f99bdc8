"""The base class of robots."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from morse.core.declarations import add_data, add_property, add_state
from morse.core.object import Object
from morse.core.robot_parts import link_parts
from morse.core.services import service
from morse.core.streams.extent import check_fields
from morse.helpers.chain import Chain
from morse.helpers.transformation import FollowingPose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot_parts import MovingPart
    from morse.core.world import Body


class Robot(Object):
    """A body that carries components and that actuators move.

    Attributes:
        position_3d: its present pose in the world.
        move_status: state of the motion of the robot: ``Stop``, ``Transit``, ``Arrived``.
    """

    add_data("move_status", "Stop", "string", "State of the motion of the robot")
    add_property("_no_gravity", False, "NoGravity", "bool", "The robot does not fall: an aircraft or a submarine")
    add_property("_is_ground_robot", False, "GroundRobot", "bool", "The robot stays on the ground: gravity moves it")

    add_state("time_shift", float, "Time of the robot, relative to that of the simulation", unit="s")
    add_state("is_dynamic", bool, "Whether the physics moves the robot")

    _no_gravity: bool
    _is_ground_robot: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.time_shift = 0.0
        self.position_3d = FollowingPose(obj)
        self.position_3d.follow(obj)
        self._no_gravity = bool(self._no_gravity)
        self._is_ground_robot = bool(self._is_ground_robot)
        self.is_dynamic = bool(obj.is_dynamic)
        if self._no_gravity:
            obj.disable_gravity()

    def moving_parts(self) -> list[MovingPart]:
        """The links of its armatures that no component moves."""
        parts = []
        components = self.context.components
        for part in (self.bge_object, *self.bge_object.childrenRecursive):
            joints = part.joints() if part.node.bones and part.name not in components else None
            if joints is not None:
                chain = Chain(part.node.bones)
                values = partial(joints.positions, chain.names)
                parts += link_parts(part, chain, values, components)
        return parts

    @property
    def move_status(self) -> str:
        """The state of the motion of the robot: ``Stop``, ``Transit`` or ``Arrived``."""
        return str(self.local_data["move_status"])

    @move_status.setter
    def move_status(self, value: str) -> None:
        self.local_data["move_status"] = value

    @property
    def is_idle(self) -> bool:
        """Whether a tick would only update the pose, which follows the body anyway."""
        cls, own = type(self), vars(self)
        return (
            cls.action is Robot.action
            and cls.default_action is Object.default_action
            and cls.update_pose is Object.update_pose
            and not own.keys() & {"action", "default_action", "update_pose"}
        )

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        super().set_property(name, value)
        for component in self.context.components.values():
            if component.robot_parent is self and component._in_rows is not None:
                component._in_rows.is_changed = True  # its speed may depend on the property

    def gettime(self) -> float:
        """Simulated time on the clock of this robot, s."""
        return self.clock.time + self.time_shift

    def action(self) -> None:
        """Perform one tick."""
        if self._active:
            self.position_3d.update(self.bge_object)
            self.default_action()
            if self._is_checked:
                check_fields(self)

    def apply_speed(self, kind: str, linear_speed: Sequence[float], angular_speed: Sequence[float]) -> None:
        """Drive the body during this tick.

        Args:
            kind: ``Position`` moves the body without momentum; ``Velocity`` sets its velocity. In both cases the body
                pushes movable obstacles and is stopped by fixed ones.
            linear_speed: m/s along the axes of the robot.
            angular_speed: rad/s about the axes of the robot.

        A ground robot keeps its vertical speed, roll rate and pitch rate, because these are determined by gravity and
        ground contact.
        """
        self.bge_object.drive(linear_speed, angular_speed, position=kind == "Position", ground=self._is_ground_robot)

    def force_pose(self, position: Sequence[float] | None, orientation: Sequence[Sequence[float]] | None) -> None:
        """Place the robot at a pose, at rest.

        Args:
            position: metres in the world, or None to keep it.
            orientation: 3x3 rotation in the world, or None to keep it.
        """
        if position is not None:
            self.bge_object.worldPosition = position
        if orientation is not None:
            self.bge_object.worldOrientation = orientation
        self.bge_object.halt()


def drives_body(robot: Robot) -> bool:
    """Whether a robot uses `Robot.apply_speed` without override, so that its body moves as commanded."""
    return type(robot).apply_speed is Robot.apply_speed and "apply_speed" not in vars(robot)
