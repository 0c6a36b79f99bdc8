"""The motors of joints of a robot, for actuators that turn some of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING, Self

from morse.core.reports.quoting import nearest
from morse.scene import Control
from morse.scene.joint_wheels import (
    JointWheel,
    dragging_links,
    driven_wheels,
    joint_wheels,
    mass_and_centre,
    rolling_wheels,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.core.limits import Limits
    from morse.core.world import Body, Joints
    from morse.scene import Node


#: unit and range of the properties of drives that are lengths of wheels, or between wheels
WHEEL_LENGTH: Limits = {"unit": "m", "low": 0.0, "high": 100.0}


def joint_names(text: str) -> tuple[str, ...]:
    """The names in a property: ``front_left, rear_left``."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


class JointMotors:
    """Motors of joints of a robot, all in one control mode, or in their own ones.

    Args:
        robot: the body of the robot.
        names: of joints of one armature.
        control: what the motors control; None to keep that.

    Raises:
        ValueError: the robot has no such joint, or none that the physics moves.
    """

    def __init__(self, robot: Body, names: Sequence[str], control: Control | None) -> None:
        self.names = tuple(names)
        armatures = [robot, *robot.childrenRecursive]
        bones = [bone.name for body in armatures for bone in body.node.bones]
        for name in self.names:
            if name not in bones:
                raise ValueError(f"the robot has no joint '{name}'{nearest(name, bones)}")
        holder = next(body for body in armatures if any(bone.name == self.names[0] for bone in body.node.bones))
        joints = holder.joints()
        if joints is None:
            raise ValueError(f"the joint '{self.names[0]}' has no motor: its armature is not dynamic")
        self._joints: Joints = joints
        for name in self.names if control is not None else ():
            joints.set_control(name, control, 0.0)

    @classmethod
    def of_wheels(cls, robot: Body, names: Sequence[str], wheels: Sequence[JointWheel]) -> Self:
        """The motors of driven wheels; other wheels on the ground roll freely.

        Args:
            wheels: all joints of the robot that turn.
        """
        if rolling := rolling_wheels(wheels, names):
            cls(robot, rolling, Control.EFFORT)
        return cls(robot, names, Control.VELOCITY)

    def tell(self, values: Sequence[float]) -> None:
        """Set the commands, rad, m, rad/s or m/s."""
        self._joints.tell(self.names, values)

    def positions(self) -> list[float]:
        """The measured positions, rad or m."""
        return self._joints.positions(self.names)


#: cosine of the largest angle between the axle of a wheel and the Y axis of a robot that drives along X
_LATERAL = 0.5
#: steps of the search for the speed of wheels that slide sideways, to a billionth
_HALVINGS = 30
#: friction of wheels, below which they are said to slip
_SLIPPERY = 0.3
#: acceleration with which a start is hardly noticed, m/s^2
_BRISK = 2.0
#: speed that any robot is expected to reach, m/s
_USUAL = 0.3


@dataclass(frozen=True, slots=True)
class DifferentialDrive:
    """Wheels on both sides of a robot.

    Attributes:
        joints: their names.
        sides: -1 on the left, 1 on the right.
        signs: -1 for joints that turn backwards if the robot drives forward.
        radii: m; 0 for wheels without shapes.
        separation: distance between the wheels on the left and those on the right that counts in turns, m.
        hindrances: what in the file keeps the robot from the speeds that are commanded, a text each.
    """

    joints: tuple[str, ...]
    sides: tuple[float, ...]
    signs: tuple[float, ...]
    radii: tuple[float, ...]
    separation: float
    hindrances: tuple[str, ...]


def differential_drive(robot: Body, left: Sequence[str], right: Sequence[str]) -> DifferentialDrive | None:
    """The drive of a robot with joints as wheels; None if it has no wheels.

    Args:
        left, right: names of joints; empty to search for wheels.

    Raises:
        ValueError: the robot has no such joint, or only the joints of one side are named.
    """
    wheels = joint_wheels(robot.node)
    if not left and not right:
        pairs = driven_wheels(wheels)
        return _drive(robot.node, *pairs, wheels) if all(pairs) else None
    if not left or not right:
        raise ValueError(f"only wheels on one side are named, left={', '.join(left)!r}, right={', '.join(right)!r}")
    by_name = {wheel.joint: wheel for wheel in wheels}
    for name in (*left, *right):
        if name not in by_name:
            raise ValueError(f"there is no joint '{name}' that turns{nearest(name, by_name)}; {joint_list(robot)}")
    return _drive(robot.node, [by_name[name] for name in left], [by_name[name] for name in right], wheels)


def joint_list(robot: Body) -> str:
    """The joints of a robot that turn, for messages."""
    wheels = joint_wheels(robot.node)
    remarks = {True: "", False: " (no wheel: it has limits, or swivels)"}
    names = ", ".join(f"{one.joint}{remarks[one.is_driven]}" for one in wheels)
    return f"its joints that turn: {names[:600]}" if names else "it has no joints that turn"


def _drive(
    robot: Node, left: list[JointWheel], right: list[JointWheel], others: Sequence[JointWheel]
) -> DifferentialDrive:
    wheels = [*left, *right]
    separation = fmean(one.y for one in left) - fmean(one.y for one in right)
    mass, centre = mass_and_centre(robot)
    # the names of files of older versions of Gazebo are exchanged
    is_lateral = all(abs(one.along) > _LATERAL for one in wheels)
    side = 1.0 if separation < 0.0 and is_lateral else -1.0
    return DifferentialDrive(
        tuple(one.joint for one in wheels),
        (side,) * len(left) + (-side,) * len(right),
        tuple(-1.0 if is_lateral and one.along < 0.0 else 1.0 for one in wheels),
        tuple(one.radius for one in wheels),
        2.0 * _lever(wheels, abs(separation) / 2.0, centre),
        (*_hindrances(wheels), *_slow_starts(wheels, mass), *_brakes(robot, wheels, others)),
    )


def _hindrances(wheels: Sequence[JointWheel]) -> Iterator[str]:
    """What in the file keeps a robot from the speeds that are commanded, a text each."""
    slippery = [one for one in wheels if one.friction is not None and one.friction < _SLIPPERY]
    if slippery:
        least = min(one.friction or 0.0 for one in slippery)
        yield (
            f"the friction of {least:g} of its wheels in the file lets them slip: it speeds up and brakes by at most "
            f"{least * 9.81:.2g} m/s^2, less if it stands on casters as well"
        )
    for one in wheels:
        motor = one.dynamics
        if motor is None or not one.radius:
            continue
        rate = _USUAL / one.radius
        taken = motor.friction + motor.damping * rate
        if taken > motor.effort:
            yield (
                f"damping and friction of the joint '{one.joint}' take {taken:.3g} N m at {_USUAL:g} m/s, more than "
                f"the {motor.effort:g} N m of its motor"
            )
            break
        if motor.speed < rate:
            yield (
                f"the joint '{one.joint}' turns at most at {motor.speed:g} rad/s in the file, "
                f"{motor.speed * one.radius:.2g} m/s"
            )
            break


def _slow_starts(wheels: Sequence[JointWheel], mass: float) -> Iterator[str]:
    """Whether the motors start the robot slowly, a text."""
    forces = [one.dynamics.effort / one.radius for one in wheels if one.dynamics is not None and one.radius]
    acceleration = sum(forces) / mass if mass and len(forces) == len(wheels) else math.inf
    if acceleration < _BRISK:
        yield (
            f"its motors accelerate its {mass:.3g} kg by at most {acceleration:.2g} m/s^2, by the efforts in the file: "
            f"after a start to {_USUAL:g} m/s it is {100.0 * _USUAL**2 / (2.0 * acceleration):.2g} cm behind"
        )


def _brakes(robot: Node, wheels: Sequence[JointWheel], others: Sequence[JointWheel]) -> Iterator[str]:
    """What reaches the ground beside the wheels, a text each; ``others`` are all joints that turn."""
    limited = {one.joint for one in others if not one.is_endless}
    rolling = set(rolling_wheels(others, [one.joint for one in wheels]))
    steered = [one for one in others if one.joint in rolling and one.carrier in limited]
    if steered:
        yield (
            f"the wheel of the joint '{steered[0].joint}' is steered by '{steered[0].carrier}', which holds it in a "
            "turn: MotionVWAckermann drives such a robot"
        )
    if all(one.radius for one in wheels):
        for name, depth in dragging_links(robot, wheels)[:1]:
            yield (
                f"the link '{name}' reaches the ground at the start, {max(1e3 * depth, 0.0):.0f} mm below the wheels, "
                "and brakes or lifts them: move its joint first"
            )


def _lever(wheels: Sequence[JointWheel], half: float, centre: float | None) -> float:
    """The speed of the treads of wheels that do not steer, m/s, with which a robot turns at 1 rad/s.

    Wheels in front of others slide sideways in a turn. Forces against the slip of each wheel, with equal friction in
    all directions and the loads of the wheels, are in balance at that speed about a point of the axis of symmetry: see
    Mandow et al., Experimental kinematics for wheeled skid-steer mobile robots, IROS 2007.

    Args:
        half: half the distance between the wheels on both sides, m.
        centre: x of the centre of mass, m; None for the middle of the wheels.
    """
    middle = fmean(one.x for one in wheels)
    xs = [one.x - middle for one in wheels]
    spread = sum(x * x for x in xs)
    if spread <= 1e-6 * half * half or not half:
        return half
    tilt = 0.0 if centre is None else len(xs) * (centre - middle) / spread
    loads = [max(0.0, 1.0 + tilt * x) for x in xs]

    def balance(speed: float) -> float:
        """The moment by which the wheels turn the robot faster, about the point where forces to the side are zero."""
        low, high = min(xs), max(xs)
        slips: list[float] = []
        for _ in range(_HALVINGS):
            pole = 0.5 * (low + high)
            slips = [max(math.hypot(x - pole, speed - half), 1e-9) for x in xs]
            side = sum(n * (x - pole) / slip for n, x, slip in zip(loads, xs, slips, strict=True))
            low, high = (pole, high) if side > 0.0 else (low, pole)
        turning = zip(loads, xs, slips, strict=True)
        return sum(n * (half * (speed - half) - (x - pole) ** 2) / slip for n, x, slip in turning)

    low, high = half, half + 2.0 * spread / half
    for _ in range(_HALVINGS):
        speed = 0.5 * (low + high)
        low, high = (low, speed) if balance(speed) > 0.0 else (speed, high)
    return 0.5 * (low + high)
