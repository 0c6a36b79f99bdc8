"""``JointTrajectory`` and the goal of ``FollowJointTrajectory`` as the argument of the service ``trajectory``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.kinds import BoundKind
    from morse.core.values import RosMessage

_SECOND = 1e9
_QUANTITIES = ("positions", "velocities", "accelerations")


def seconds(time: Mapping[str, int]) -> float:
    """A time or a duration, s."""
    return float(time["sec"] + time["nanosec"] / _SECOND)


def service_call(message: RosMessage, bound: BoundKind) -> tuple[str, list[object]] | None:
    """The service that a trajectory calls, and its arguments; None for a single point at once, which is a command.

    Raises:
        ValueError: it has no points, or its joints do not follow trajectories.
    """
    points = message["points"]
    if not len(points):
        raise ValueError("0 points, expected at least one")
    if len(points) == 1 and not seconds(points[0]["time_from_start"]):
        return None
    if not hasattr(bound.component, "trajectory"):
        raise ValueError(f"{len(points)} points for {bound.component.name()}, expected one with time_from_start 0")
    return "trajectory", [trajectory_of(message)]


def trajectory_of(message: RosMessage) -> RosMessage:
    """The trajectory of some joints; the other joints keep their setpoints.

    It starts at the stamp of its header, or now if that is 0.

    Raises:
        ValueError: a point has another number of values than of joints.
    """
    joints = [str(name) for name in message["joint_names"]]
    trajectory = {"joints": joints, "points": [_point(point, len(joints)) for point in message["points"]]}
    start = seconds(message["header"]["stamp"])
    return {"starttime": start, **trajectory} if start else trajectory


def goal_of(goal: RosMessage) -> RosMessage:
    """The trajectory of a goal of ``control_msgs/FollowJointTrajectory``, with its tolerances.

    Raises:
        ValueError: a point has another number of values than of joints.
    """
    trajectory = trajectory_of(goal["trajectory"])
    for key in ("path_tolerance", "goal_tolerance"):
        tolerances = {str(one["name"]): _tolerance(one) for one in goal[key]}
        if tolerances:
            trajectory[key] = tolerances
    late = seconds(goal["goal_time_tolerance"])
    if late > 0.0:
        trajectory["goal_time_tolerance"] = late
    return trajectory


def _tolerance(tolerance: RosMessage) -> dict[str, float]:
    """The tolerances of a joint: 0 means none is set, a negative number removes it."""
    return {name: tolerance[name] for name in ("position", "velocity") if tolerance[name] > 0.0}


def _point(point: RosMessage, count: int) -> RosMessage:
    result: RosMessage = {"time_from_start": seconds(point["time_from_start"])}
    for quantity in _QUANTITIES:
        values = point[quantity]
        if not len(values) and quantity != "positions":
            continue
        if len(values) != count:
            raise ValueError(f"a point has {len(values)} {quantity} for {count} joint_names")
        result[quantity] = [float(value) for value in values]
    return result
