"""The progress of services that take time, by the names of fields of the feedback of common actions."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import JsonObject


def of_distance(distance: float, speed: float = 0.0) -> JsonObject:
    """The progress of a motion to a position, as in ``nav2_msgs/NavigateToPose``.

    Args:
        distance: distance to the position, m.
        speed: speed, m/s; 0 if it is unknown.
    """
    rest = {"estimated_time_remaining": distance / speed} if speed > 0.0 else {}
    return {"distance_remaining": distance, **rest}


def of_joints(names: Sequence[str], actual: Sequence[float], desired: Sequence[float]) -> JsonObject:
    """The progress of joints, as in ``control_msgs/FollowJointTrajectory``.

    Args:
        names: names of the joints.
        actual: joint values, rad or m.
        desired: setpoints, rad or m.
    """
    error = [goal - value for goal, value in zip(desired, actual, strict=True)]
    return {
        "joint_names": list(names),
        "desired": {"positions": list(desired)},
        "actual": {"positions": list(actual)},
        "error": {"positions": error},
    }
