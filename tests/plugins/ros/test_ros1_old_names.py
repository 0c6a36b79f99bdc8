"""Class paths of ROS 1 that need no master."""

import pytest

from morse.core.exceptions import MorseMiddlewareError
from morse.plugins.ros.mapping import MIDDLEWARE
from morse.plugins.ros.overlays import action_type
from morse.plugins.ros.variants import class_path


@pytest.mark.parametrize(
    ("given", "used"),
    [
        ("morse.middleware.ros.pose.TFPublisher", "morse.plugins.ros.variants.TFPublisher"),
        ("morse.middleware.ros.waypoint2D.Pose2DReader", "morse.plugins.ros.variants.Pose2DReader"),
        ("morse.middleware.ros.imu.ImuPublisher", MIDDLEWARE.default_publisher),
        ("my_lab.streams.TFPublisher", "my_lab.streams.TFPublisher"),
    ],
)
def test_streams_have_the_class_paths_of_1_4(given, used):
    assert class_path(given, "robot.pose") == used


def test_an_unknown_class_is_reported(caplog):
    assert class_path("morse.middleware.ros.pose.Posse", "robot.pose") == MIDDLEWARE.default_publisher
    assert "there is no class morse.middleware.ros.pose.Posse: robot.pose uses its usual messages" in caplog.text


def test_a_missing_package_of_messages_is_named():
    with pytest.raises(MorseMiddlewareError, match="sudo apt install ros-noetic-no-such-msgs"):
        action_type("AnyAction", "no_such_msgs")
