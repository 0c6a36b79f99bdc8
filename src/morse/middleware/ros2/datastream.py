"""Publishes data streams as topics of ROS 2."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.ros2.diagnostics import Diagnostics
from morse.middleware.ros2.domain import join
from morse.middleware.ros2.mapping import MANAGER_OPTIONS
from morse.rosmsgs.options import ROS2_MANAGER
from morse.rosmsgs.topics.manager import TopicManager

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.values import Options
    from morse.rosmsgs.topics.backend import Backend


class Ros2DatastreamManager(TopicManager):
    """Topics of ROS 2, with simulated time and the tree of frames.

    Options of ``env.configure_stream_manager('ros2', ...)`` are in `morse.middleware.ros2.mapping`.
    """

    classpath = ROS2_MANAGER
    manager_options = MANAGER_OPTIONS
    title = "ros2"

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._diagnostics = Diagnostics(self) if self.options["diagnostics"] else None

    def _make_backend(self) -> Backend:
        return join(self.context, self.options)

    def flush(self) -> None:
        """See `TopicManager.flush`."""
        if self._diagnostics is not None:
            self._diagnostics.publish()
        super().flush()

    def finalize(self) -> None:
        """See `TopicManager.finalize`."""
        if self._diagnostics is not None:
            self._diagnostics.close()
        super().finalize()
