"""Trajectories of joints from messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseRPCInvokationError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.values import RosMessage
    from morse.rosmsgs.objects import RosObject


def in_order_of(joints: Sequence[str], trajectory: RosObject) -> RosMessage:
    """The argument of the service ``trajectory`` of an armature, from ``trajectory_msgs/JointTrajectory``.

    Args:
        joints: the joints of the armature, in their order.

    Raises:
        MorseRPCInvokationError: the message is for other joints.
    """
    names = list(trajectory.joint_names)
    if sorted(names) != sorted(joints):
        raise MorseRPCInvokationError(
            f"the trajectory is for the joints {', '.join(names) or 'none'}, the armature has {', '.join(joints)}"
        )
    order = [names.index(joint) for joint in joints]
    points = []
    for point in trajectory.points:
        entry: RosMessage = {"time_from_start": point.time_from_start.to_sec()}
        for name in ("positions", "velocities", "accelerations"):
            values = list(getattr(point, name))
            if values and len(values) != len(order):
                raise MorseRPCInvokationError(f"a point has {len(values)} {name}, the armature {len(order)} joints")
            if values:
                entry[name] = [values[index] for index in order]
        points.append(entry)
    start = trajectory.header.stamp.to_sec()
    # time 0 means now
    return {"starttime": start, "points": points} if start else {"points": points}
