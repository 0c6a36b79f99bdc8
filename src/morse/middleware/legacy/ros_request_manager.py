"""The class path of the ROS 1 services and their decorators, for clients and scene scripts."""

from morse.middleware.ros.decorators import ros_action, ros_service
from morse.middleware.ros.request_manager import RosRequestManager

__all__ = ["RosRequestManager", "ros_action", "ros_service"]
