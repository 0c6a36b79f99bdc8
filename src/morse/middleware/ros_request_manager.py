"""The class path under which clients and scene scripts know the services of ROS 1, and their decorators."""

from morse.middleware.ros.decorators import ros_action, ros_service
from morse.middleware.ros.request_manager import RosRequestManager

__all__ = ["RosRequestManager", "ros_action", "ros_service"]
