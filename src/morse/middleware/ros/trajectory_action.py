"""The action ``control_msgs/FollowJointTrajectory`` of armatures over ROS 1, as of a controller of ros_control."""

from __future__ import annotations

from morse.middleware.ros.actions import ActionServer
from morse.middleware.ros.messages import plain
from morse.middleware.ros2.trajectory_action import TrajectoryGoals


class TrajectoryActionServer(TrajectoryGoals, ActionServer):
    """Serves the action of one armature."""

    plain = staticmethod(plain)
