"""ROS 1: topics, services and actions by rospy, and the base classes of streams of users."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.plugins.ros.own_classes import ROSPublisher, ROSPublisherTF, ROSSubscriber

__all__ = ["ROSPublisher", "ROSPublisherTF", "ROSSubscriber"]


def __getattr__(name: str) -> object:
    # the list of middlewares imports this package, and scenes without such streams do not need them
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    from morse.plugins.ros import own_classes

    return getattr(own_classes, name)
