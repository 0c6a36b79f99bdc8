"""Messages of rospy and rclpy, which make their classes at run time."""

from __future__ import annotations

from typing import Any, Protocol


class RosObject(Protocol):
    """A message, a request or a response of a ROS client library: its fields are attributes."""

    def __getattr__(self, field: str) -> Any:
        """A field: a number, a string, a list, or another message."""

    def __setattr__(self, field: str, value: object) -> None:
        """Set a field."""


class RosClass(Protocol):
    """The class of messages, services or actions of a ROS client library."""

    def __call__(self, *values: object, **fields: object) -> Any:
        """A message; of services and actions, the classes of the parts are attributes."""

    def __getattr__(self, name: str) -> Any:
        """A constant or a class of it."""
