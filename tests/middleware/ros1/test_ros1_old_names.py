"""Class paths and trajectories of ROS 1 that need no master."""

from __future__ import annotations

from types import SimpleNamespace as Message

import pytest

from morse.core.exceptions import MorseMiddlewareError, MorseRPCInvokationError
from morse.middleware.ros.mapping import MIDDLEWARE
from morse.middleware.ros.old_names import class_path
from morse.middleware.ros.overlays import action_type
from morse.middleware.ros.overlays.trajectories import in_order_of


@pytest.mark.parametrize(
    ("given", "used"),
    [
        ("morse.middleware.ros.pose.TFPublisher", "morse.middleware.ros.variants.TFPublisher"),
        ("morse.middleware.ros.waypoint2D.Pose2DReader", "morse.middleware.ros.variants.Pose2DReader"),
        ("morse.middleware.ros.imu.ImuPublisher", MIDDLEWARE.default_publisher),
        ("my_lab.streams.TFPublisher", "my_lab.streams.TFPublisher"),
    ],
)
def test_streams_have_the_class_paths_of_1_4(given, used):
    assert class_path(given, "robot.pose") == used


def test_an_unknown_class_is_reported(caplog):
    assert class_path("morse.middleware.ros.pose.Posse", "robot.pose") == MIDDLEWARE.default_publisher
    assert "there is no class morse.middleware.ros.pose.Posse: robot.pose uses its usual messages" in caplog.text


def _seconds(number):
    return Message(to_sec=lambda: number)


def _trajectory(names, *points, start=0.0):
    return Message(header=Message(stamp=_seconds(start)), joint_names=names, points=points)


def _point(at, positions, velocities=(), accelerations=()):
    return Message(
        time_from_start=_seconds(at), positions=positions, velocities=velocities, accelerations=accelerations
    )


def test_a_trajectory_is_put_into_the_order_of_the_joints():
    given = _trajectory(["b", "a"], _point(0.5, [2.0, 1.0], [0.2, 0.1]), start=7.0)
    assert in_order_of(("a", "b"), given) == {
        "starttime": 7.0,
        "points": [{"time_from_start": 0.5, "positions": [1.0, 2.0], "velocities": [0.1, 0.2]}],
    }


def test_a_trajectory_without_a_stamp_starts_now():
    assert "starttime" not in in_order_of(["a"], _trajectory(["a"], _point(1.0, [1.0])))


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        (_trajectory(["a"], _point(1.0, [1.0])), "is for the joints a, the armature has a, b"),
        (_trajectory(["a", "b"], _point(1.0, [1.0])), "a point has 1 positions, the armature 2 joints"),
    ],
)
def test_a_trajectory_for_other_joints_is_refused(given, reason):
    with pytest.raises(MorseRPCInvokationError, match=reason):
        in_order_of(["a", "b"], given)


def test_a_missing_package_of_messages_is_named():
    with pytest.raises(MorseMiddlewareError, match="sudo apt install ros-noetic-no-such-msgs"):
        action_type("AnyAction", "no_such_msgs")
