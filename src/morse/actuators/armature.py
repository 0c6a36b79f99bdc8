"""Moves the joints of an armature."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from morse.actuators.joint_reach import Follower, JointReach, nearer, seen_from, targets_of
from morse.core import status
from morse.core.classes.builder_defaults import BuilderDefaults
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import AbsoluteSpeed, EulerAngles, Point
from morse.core.reports.quoting import nearest, shown
from morse.core.rows.columns import Setpoints
from morse.core.services import async_service, interruptible, service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_kind, add_property, add_state, each
from morse.helpers.inverse_kinematics import LEVER
from morse.mathutils import Euler
from morse.mathutils.rotations import nine, product

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body

_TurnRate = Annotated[float, Range(0.0, 1e4, "rad/s")]


class Armature(JointReach):
    """Moves the revolute and prismatic joints of an armature.

    The joints are the bones of the armature with an unlocked axis (Bone > Inverse Kinematics in Blender) or, for
    prismatic joints, a stretch. ``local_data`` has a field with the setpoint of each joint. The joint moves to it at
    ``RotationSpeed`` or ``LinearSpeed``. Every setpoint is clamped to the limits of its joint.

    Bones with a target follow it as soon as the target is moved, until a joint gets a setpoint. A target is the wanted
    pose of the tip of its bone, with the Y axis along the bone.

    If the joints are dynamic (property ``Dynamic``), motors move them against gravity, contacts and friction. The
    motors control position, velocity or effort (property ``Control``, service ``set_control``): the field of a joint is
    then in rad, rad/s or N·m, or in m, m/s or N for prismatic joints. Services for motions, trajectories and targets
    require position control. Motors of tendons have a field each, with the command that the file defines.
    """

    _name = "Armature Actuator"
    _short_desc = "Moves the joints of an armature, one by one, along a trajectory, or by inverse kinematics"
    _builder = BuilderDefaults()
    _products = (BuilderDefaults("KukaLWR", doc="A KUKA LWR arm with seven revolute joints"),)

    add_kind(
        "joints",
        names=each("joints"),
        position=each("joints", among="position_joints"),
        velocity=each("joints", among="velocity_joints"),
        effort=each("joints", among="effort_joints"),
    )
    add_property(
        "_ik_rotation_speed",
        0.5,
        "IKRotationSpeed",
        "float",
        "Rotation speed of targets",
        unit="rad/s",
        low=0.0,
        high=1e4,
    )
    add_property(
        "_ik_linear_speed", 0.5, "IKLinearSpeed", "float", "Linear speed of targets", unit="m/s", low=0.0, high=1e4
    )

    add_state("_follower", Follower, "Search for the joint values of the targets")
    add_state("_led", list | None, "Setpoints computed from the targets; None while commands set them")
    add_state("_move", tuple | None, "Motion of a target: name, goal, speeds")
    add_state("_target_poses", list, "Poses of the targets at the last action")

    _ik_rotation_speed: float
    _ik_linear_speed: float

    #: weight of an error of one radian of a target, m
    _lever: ClassVar[float] = LEVER

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._targets = targets_of(obj)
        self._follower = Follower()
        self._target_poses = self._poses()
        #: setpoints computed from the targets; None while commands set the setpoints
        self._led: list[float] | None = None
        #: motion of a target: its name, goal position and rotation in the world, speed in m/s and rad/s
        self._move: tuple[str, tuple[float, ...], tuple[float, ...], float, float] | None = None

    def default_action(self) -> None:
        """Move the joints by one tick."""
        if self._tendons:
            self._pull()
        has_arrived = self._move is not None and self._move_target(*self._move)
        if self._targets and not self._controls and self._trajectory is None and self._are_led():
            self._led = self._follower.follow(self.chain, self._seen(), self._values)
            self._move_to(self._led)
            self.local_data.update(zip(self.joints, self._led, strict=True))
        else:
            super().default_action()
        if has_arrived:
            self._move = None
            if self.on_completion is not None:
                self.completed(status.SUCCESS)

    def holds(self) -> bool:
        """Whether all joints have their setpoints, and nothing else moves them."""
        return self._is_free() and not self._tendons and self._wanted() == self._values

    def _is_free(self) -> bool:
        """Whether nothing but setpoints moves the joints."""
        return (
            type(self).default_action is Armature.default_action
            and not self._targets
            and (self._move, self._trajectory, self._awaited) == (None, None, None)
        )

    def setpoints(self) -> Setpoints | None:
        """See `Actuator.setpoints`."""
        motors = self.motors
        if motors is None or not self._is_free():
            return None
        pulled = self._pulled.values()
        return Setpoints(
            (*self.joints, *self._tendons),
            (*self._values, *pulled),
            (*self._bounds(), *self._tendons.values()),
            (*self._steps(), *[math.inf for _ in pulled]),
            (*motors.channels(self.joints), *[motor.actuator for motor in motors.file_motors]),
        )

    def went_on(self, values: Sequence[float]) -> None:
        """See `Actuator.went_on`."""
        joints = len(self.joints)
        self._values, self._pulled = list(values[:joints]), dict(zip(self._tendons, values[joints:], strict=True))

    def _stop(self) -> None:
        self._move = None
        super()._stop()

    def _take_over(self, names: list[str]) -> None:
        if self._move is not None:
            self.interrupt()
        super()._take_over(names)
        self._led, self._target_poses = None, self._poses()

    # -- targets ---------------------------------------------------------------------------

    @service(changes=False)
    def list_IK_targets(self) -> list[str]:  # noqa: N802 (its name in MORSE 1.4)
        """Return the names of the targets that ``create_ik_targets`` in the scene script has created."""
        return list(self._targets)

    @service
    def place_IK_target(  # noqa: N802 (its name in MORSE 1.4)
        self, name: str, translation: Point, euler: EulerAngles | None = None, relative: bool = True
    ) -> None:
        """Set the pose of a target immediately; the bone follows.

        Args:
            name: name of the target.
            translation: x, y, z in the axes of the world, m.
            euler: rotation in the axes of the world, rad; None to keep that of the target.
            relative: whether the pose is relative to the present pose of the target; otherwise to the origin of the
                world.
        """
        goal = self._goal(name, translation, euler, relative)
        if self._trajectory is not None or self._move is not None:
            self.interrupt()
        self._targets[name].set_pose(*goal)

    @interruptible
    @async_service
    def move_IK_target(  # noqa: N802 (its name in MORSE 1.4)
        self,
        name: str,
        translation: Point,
        euler: EulerAngles | None = None,
        relative: bool = True,
        linear_speed: AbsoluteSpeed | None = None,
        radial_speed: _TurnRate | None = None,
    ) -> None:
        """Move a target at limited speed; the bone follows. The service ends when the target has arrived.

        Args:
            name: name of the target.
            translation: x, y, z in the axes of the world, m.
            euler: rotation in the axes of the world, rad; None to keep that of the target.
            relative: whether the pose is relative to the present pose of the target; otherwise to the origin of the
                world.
            linear_speed: m/s; None for IKLinearSpeed.
            radial_speed: rad/s; None for IKRotationSpeed.
        """
        position, rotation = self._goal(name, translation, euler, relative)
        self._stop()
        linear = self._ik_linear_speed if linear_speed is None else linear_speed
        radial = self._ik_rotation_speed if radial_speed is None else radial_speed
        self._move = (name, position, rotation, float(linear), float(radial))

    def _goal(
        self, name: str, translation: list[float], euler: list[float] | None, relative: bool
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the goal pose in the world for the arguments of a service."""
        self._demand_positions()
        target = self._targets.get(name)
        if target is None:
            hint = nearest(name, self._targets) or ": create them in the scene script with create_ik_targets(['bone'])"
            raise MorseRPCInvokationError(f"{self.name()}: there is no target {shown(name)}{hint}")
        position, rotation = target.world_pose()
        turn = None if euler is None else nine(list(Euler(euler).to_matrix()))
        x, y, z = (float(value) for value in translation)
        if not relative:
            return (x, y, z), tuple(rotation) if turn is None else turn
        place = (position[0] + x, position[1] + y, position[2] + z)
        return place, tuple(rotation) if turn is None else product(turn, tuple(rotation))

    def _move_target(
        self, name: str, position: tuple[float, ...], rotation: tuple[float, ...], linear: float, radial: float
    ) -> bool:
        """Move a target towards its goal by one tick; return True if it has arrived."""
        target = self._targets[name]
        pose, is_there = nearer(
            target.world_pose(), (position, rotation), linear / self.frequency, radial / self.frequency
        )
        target.set_pose(*pose)
        return is_there

    def _poses(self) -> list[Any]:
        """Return the present poses of the targets in the frame of the armature."""
        return [target.local_pose() for target in self._targets.values()]

    def _seen(self) -> list[Any]:
        return seen_from(self.chain, self._targets.values(), self._lever)

    def _are_led(self) -> bool:
        """Whether the bones follow their targets: a target was moved, and no joint received a setpoint since then."""
        poses = self._poses()
        if poses != self._target_poses:
            self._target_poses = poses
            self._led = [float(self.local_data[name]) for name in self.joints]
        elif self._led is not None and any(
            self.local_data[name] != value for name, value in zip(self.joints, self._led, strict=True)
        ):
            self._led = None
        return self._led is not None
