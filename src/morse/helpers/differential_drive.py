"""The wheels of a differential drive, named or found by their geometry."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import fmean
from typing import TYPE_CHECKING

from morse.core.reports.hints import nearest
from morse.helpers.joint_wheels import JointWheel, driven_wheels, joint_wheels

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.world import Body

#: cosine of the largest angle between the axle of a wheel and the Y axis of a robot that drives along X
_LATERAL = 0.5


@dataclass(frozen=True, slots=True)
class DifferentialDrive:
    """Wheels on both sides of a robot.

    Attributes:
        joints: their names.
        sides: -1 on the left, 1 on the right.
        signs: -1 for joints that turn backwards if the robot drives forward.
        radii: m; 0 for wheels without shapes.
        separation: distance between the wheels on the left and those on the right, m.
    """

    joints: tuple[str, ...]
    sides: tuple[float, ...]
    signs: tuple[float, ...]
    radii: tuple[float, ...]
    separation: float


def differential_drive(robot: Body, left: Sequence[str], right: Sequence[str]) -> DifferentialDrive | None:
    """The drive of a robot with joints as wheels; None if it has no wheels.

    Args:
        left, right: names of joints; empty to search for wheels.

    Raises:
        ValueError: the robot has no such joint, or only the joints of one side are named.
    """
    wheels = joint_wheels(robot)
    if not left and not right:
        pairs = driven_wheels(wheels)
        return _drive(*pairs) if all(pairs) else None
    if not left or not right:
        raise ValueError(f"only wheels on one side are named, left={', '.join(left)!r}, right={', '.join(right)!r}")
    by_name = {wheel.joint: wheel for wheel in wheels}
    for name in (*left, *right):
        if name not in by_name:
            raise ValueError(f"there is no joint '{name}' that turns{nearest(name, by_name)}; {joint_list(robot)}")
    return _drive([by_name[name] for name in left], [by_name[name] for name in right])


def joint_list(robot: Body) -> str:
    """The joints of a robot that turn, for messages."""
    wheels = joint_wheels(robot)
    remarks = {True: "", False: " (no wheel: it has limits, or swivels)"}
    names = ", ".join(f"{one.joint}{remarks[one.is_driven]}" for one in wheels)
    return f"its joints that turn: {names[:600]}" if names else "it has no joints that turn"


def _drive(left: list[JointWheel], right: list[JointWheel]) -> DifferentialDrive:
    wheels = [*left, *right]
    separation = fmean(one.y for one in left) - fmean(one.y for one in right)
    # the names of files of older versions of Gazebo are exchanged
    is_lateral = all(abs(one.along) > _LATERAL for one in wheels)
    side = 1.0 if separation < 0.0 and is_lateral else -1.0
    return DifferentialDrive(
        tuple(one.joint for one in wheels),
        (side,) * len(left) + (-side,) * len(right),
        tuple(-1.0 if is_lateral and one.along < 0.0 else 1.0 for one in wheels),
        tuple(one.radius for one in wheels),
        abs(separation),
    )
