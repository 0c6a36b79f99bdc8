"""Registers this process again when the master of ROS 1 was started again: rospy registers only once."""

from __future__ import annotations

import logging
import os
import threading
import time
from typing import TYPE_CHECKING

from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from types import ModuleType


logger = logging.getLogger(__name__)

#: wall-clock seconds between two questions to the master
_INTERVAL = 1.0


class MasterWatch:
    """Asks the master from time to time whether it knows this process; in a thread of its own.

    Args:
        rospy: the module, after the process has become a node.
    """

    def __init__(self, rospy: ModuleType) -> None:
        self._rospy = rospy
        self._is_there = True

    def start(self) -> None:
        """Start the thread, which ends with the process."""
        threading.Thread(target=self._run, name="morse-ros-master", daemon=True).start()

    def _run(self) -> None:
        while not self._rospy.is_shutdown():
            time.sleep(_INTERVAL)
            self.look()

    def look(self) -> None:
        """Ask once, and register everything again if a new master has taken the place of the former one."""
        import rosgraph

        name = self._rospy.get_name()
        try:
            rosgraph.Master(name).lookupNode(name)
        except rosgraph.MasterError:
            self._is_there = True
            count = register_again()
            logger.warning(
                "ros: the master at %s was started again: %d topics and services are registered again",
                _uri(),
                count,
                extra=OF_MACHINE,
            )
        except Exception as error:  # the errors of sockets, of HTTP and of XML
            if self._is_there:
                self._is_there = False
                logger.warning(
                    "ros: there is no master at %s (%s); the simulation goes on, and new nodes do not find it until a "
                    "master is started",
                    _uri(),
                    error,
                    extra=OF_MACHINE,
                )
        else:
            self._is_there = True


def register_again() -> int:
    """Register all topics and services of this process with the master; returns their number."""
    from rospy.impl import registration

    listeners = registration.get_registration_listeners()
    kinds = registration.Registration
    topics, services = registration.get_topic_manager(), registration.get_service_manager()
    entries = [
        *((name, kind, kinds.PUB) for name, kind in topics.get_publications()),
        *((name, kind, kinds.SUB) for name, kind in topics.get_subscriptions()),
        *((name, uri, kinds.SRV) for name, uri in services.get_services()),
    ]
    for one in entries:
        listeners.notify_added(*one)
    return len(entries)


def _uri() -> str:
    return os.environ.get("ROS_MASTER_URI", "")
