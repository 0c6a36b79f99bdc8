"""Decorators that declare methods of components and overlays as services and actions of ROS 1, as in MORSE 1.4."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

from morse.core.services import service

if TYPE_CHECKING:
    from collections.abc import Callable


def ros_service(
    fn: Callable[..., object] | None = None,
    type: object = None,
    component: str | None = None,
    name: str | None = None,
    asynchronous: bool = False,
) -> object:
    """Declare a method as a ROS service.

    The method takes the fields of the request as its arguments, in order, and returns the response, or the values of
    its fields.

    Args:
        type: class of the service, such as ``std_srvs.srv.SetBool``.
        component: see `morse.core.services.service`.
        name: see `morse.core.services.service`.
        asynchronous: the service ends with ``self.completed(status, result)``.
    """
    if fn is None:
        return functools.partial(ros_service, type=type, component=component, name=name, asynchronous=asynchronous)
    method: Any = service(component=component, name=name, asynchronous=asynchronous)(fn)
    method._ros_service_type = type
    return method


def ros_action(
    fn: Callable[..., object] | None = None,
    type: object = None,
    component: str | None = None,
    name: str | None = None,
    feedback: str | None = None,
) -> Any:
    """Declare a method as a ROS action; it takes the goal, and ends with ``self.completed(status, result)``.

    Args:
        type: class of the action, such as ``move_base_msgs.msg.MoveBaseAction``.
        feedback: name of a method that returns the feedback message of the running goal, or None for no message; it
            is called five times per simulated second. By default, the fields that are known are filled in: see
            `morse.middleware.ros2.feedback`.
        component: see `morse.core.services.service`.
        name: see `morse.core.services.service`.
    """
    if fn is None:
        return functools.partial(ros_action, type=type, component=component, name=name, feedback=feedback)
    method: Any = service(component=component, name=name, asynchronous=True)(fn)
    method._ros_action_type, method._ros_action_feedback = type, feedback
    return method
