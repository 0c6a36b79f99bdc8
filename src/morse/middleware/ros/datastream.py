"""Publishes data streams as topics of ROS 1."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.middleware.ros.kinds import Ros1Kinds
from morse.middleware.ros.mapping import MANAGER_OPTIONS
from morse.middleware.ros.node import RospyBackend
from morse.middleware.ros.old_names import class_path
from morse.middleware.ros.transforms import TransformsOf14
from morse.middleware.ros2.datastream import TF, Ros2DatastreamManager

if TYPE_CHECKING:
    from typing import Any

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.middleware.ros2.backends.backend import Backend
    from morse.scene import StreamDeclaration


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
            self.transforms = TransformsOf14(False, self._send_tf, self._send_static)

    def _send_static(self, message: dict[str, Any]) -> None:
        if message["transforms"]:
            self._publish(self._tf_static, TF, message)

    def make_stream(self, component: Object, declaration: StreamDeclaration) -> Any:
        """See `DatastreamManager.make_stream`; the class may have its name in 1.4."""
        stream = class_path(declaration.stream, component.name())
        return super().make_stream(component, replace(declaration, stream=stream))

    def _make_backend(self) -> Backend:
        # rospy has its own /rosout; descriptions of robots are parameters in ROS 1
        self.options = {**self.options, "rosout": False, "description": False}
        return RospyBackend(self.context.scene.settings.node_name)
