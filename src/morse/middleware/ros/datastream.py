"""Publishes data streams as topics of ROS 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.ros.kinds import Ros1Kinds
from morse.middleware.ros.mapping import MANAGER_OPTIONS
from morse.middleware.ros.node import RospyBackend
from morse.middleware.ros.transforms import TransformsOf14
from morse.middleware.ros2.datastream import Ros2DatastreamManager

if TYPE_CHECKING:
    from typing import Any

    from morse.core.context import Context
    from morse.middleware.ros2.backends.backend import Backend


class ROSDatastreamManager(Ros1Kinds, Ros2DatastreamManager):
    """Topics of ROS 1: the messages and frames of MORSE 1.4, and those of ROS 2 for all other components.

    Options of ``env.configure_stream_manager('ros', ...)`` are in `morse.middleware.ros.mapping`.
    """

    classpath = "morse.middleware.ros_datastream.ROSDatastreamManager"
    manager_options = MANAGER_OPTIONS
    title = "ros"

    def __init__(self, options: dict[str, Any], context: Context) -> None:
        super().__init__(options, context)
        if self.options["frames"] == "1.4":
            self.transforms = TransformsOf14(False, self._send_tf, lambda message: None)

    def _make_backend(self) -> Backend:
        # rospy has its own /rosout; descriptions of robots are parameters in ROS 1
        self.options = {**self.options, "rosout": False, "description": False}
        return RospyBackend(self.context.scene.settings.node_name)
