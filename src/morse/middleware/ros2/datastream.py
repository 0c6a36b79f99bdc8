"""Publishes data streams as topics of ROS 2."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.middleware.ros2 import MANAGER_OPTIONS, NODE
from morse.middleware.ros2.diagnostics import Diagnostics
from morse.middleware.ros2.domain import join
from morse.rosmsgs.names import ROS2_MANAGER
from morse.rosmsgs.topics.manager import TopicManager

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.values import Options
    from morse.rosmsgs.topics.backend import Backend


logger = logging.getLogger(__name__)

#: number of ticks after which other simulations are looked for again
_LOOK = 30


class Ros2DatastreamManager(TopicManager):
    """Topics of ROS 2, with simulated time and the tree of frames.

    Options of ``env.configure_stream_manager('ros2', ...)`` are in `morse.middleware.ros2`.
    """

    classpath = ROS2_MANAGER
    manager_options = MANAGER_OPTIONS
    title = "ros2"

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        self._diagnostics = Diagnostics(self) if self.options["diagnostics"] else None
        self._ticks, self._is_alone = 0, True

    def _make_backend(self) -> Backend:
        return join(self.context, self.options)

    def flush(self) -> None:
        """See `TopicManager.flush`."""
        if self._diagnostics is not None:
            self._diagnostics.publish()
        self._ticks += 1
        if self._is_alone and self._ticks % _LOOK == 0 and self.backend.has_namesake():
            self._is_alone = False
            logger.warning(
                "ros2: another simulation of this domain has a node /%s as well (%s): both publish /clock, /tf and the "
                "topics of robots with the same name, and both obey their commands; set another ROS_DOMAIN_ID for one "
                "of them, or env.configure_stream_manager('ros2', domain_id=...)",
                NODE,
                self.backend.opens,
            )
        super().flush()

    def finalize(self) -> None:
        """See `TopicManager.finalize`."""
        if self._diagnostics is not None:
            self._diagnostics.close()
        super().finalize()
