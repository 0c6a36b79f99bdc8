"""``trajectory_msgs/JointTrajectory`` as the argument of the service ``trajectory`` of an armature."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.reports.hints import nearest

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.kinds import BoundKind

_SECOND = 1e9


def _seconds(time: Mapping[str, int]) -> float:
    return float(time["sec"] + time["nanosec"] / _SECOND)


def service_call(message: Mapping[str, Any], bound: BoundKind) -> tuple[str, list[Any]] | None:
    """The service that a trajectory calls, and its arguments; None for a single point at once, which is a command.

    A trajectory may be for some of the joints: the other ones keep their setpoints. It starts at the stamp of its
    header, or now if that is 0.

    Raises:
        ValueError: it does not fit the joints, or they do not follow trajectories.
    """
    points = message["points"]
    if not len(points):
        raise ValueError("0 points, expected at least one")
    if len(points) == 1 and not _seconds(points[0]["time_from_start"]):
        return None
    if not hasattr(bound.component, "trajectory"):
        raise ValueError(f"{len(points)} points for {bound.component.name()}, expected one with time_from_start 0")
    present = bound.gather()
    joints, chosen = [str(name) for name in present.names], list(message["joint_names"])
    for joint in chosen:
        if joint not in joints:
            raise ValueError(f"there is no joint {joint!r:.80}{nearest(joint, joints)}")
    places = [joints.index(joint) for joint in chosen]
    setpoints = np.nan_to_num(np.asarray(present.position, dtype=np.float64))
    trajectory: dict[str, Any] = {"points": [_point(point, places, setpoints) for point in points]}
    start = _seconds(message["header"]["stamp"])
    return "trajectory", [{"starttime": start, **trajectory} if start else trajectory]


def _point(point: Mapping[str, Any], places: Sequence[int], setpoints: Any) -> dict[str, Any]:
    result: dict[str, Any] = {"time_from_start": _seconds(point["time_from_start"])}
    resting = np.zeros(len(setpoints))
    for quantity, others in (("positions", setpoints), ("velocities", resting), ("accelerations", resting)):
        values = point[quantity]
        if not len(values) and quantity != "positions":
            continue
        if len(values) != len(places):
            raise ValueError(f"a point has {len(values)} {quantity} for {len(places)} joint_names")
        row = np.array(others)
        row[list(places)] = values
        result[quantity] = row.tolist()
    return result
