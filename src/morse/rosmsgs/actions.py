"""The feedback of actions, for ROS 1 and ROS 2.

A method of the component or overlay makes the message. Without such a method, these fields of a message are filled in
if the type of the action has them: the pose of the robot (``current_pose``, ``base_position``), the simulated time
since the goal was accepted (``navigation_time``), and what `morse.core.abstractobject.AbstractObject.progress` returns.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, Protocol

from morse.core.clients.complaints import Complaints
from morse.rosmsgs.parts import header_at, quaternion, quaternion_of, time, xyz

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.topics.backend import RosObject

logger = logging.getLogger(__name__)

#: time between two messages, ns of simulated time: five messages per second, as in 1.4
PERIOD = 200_000_000
_SECOND = 1e9
_POSES = ("current_pose", "base_position")
_DURATIONS = ("builtin_interfaces/Duration", "duration")


class Progress(Protocol):
    """Makes the feedback of running goals."""

    def is_due(self, stamp: int) -> bool:
        """Whether goals should be told at a simulated time, ns; True once in each period."""

    def message(self, begun: int, stamp: int) -> RosObject | None:
        """The feedback of a goal that was accepted at a simulated time, ns; None if there is nothing to tell."""


class Feedback:
    """Makes the feedback messages of an action.

    Args:
        callback: the method that serves the action.
        kind: class of a feedback message.
        kinds: types of the fields of a feedback message, by name.
        make: makes a message from some of its fields.
    """

    def __init__(
        self,
        callback: Callable[..., Any],
        kind: type,
        kinds: Mapping[str, str],
        make: Callable[[RosMessage], Any],
    ) -> None:
        self._owner: Any = getattr(callback, "__self__", None)
        self._kind = kind
        self._method = getattr(callback, "_ros_action_feedback", None)
        self._kinds, self._make = kinds, make
        self._complaints = Complaints(logger)
        self._told = -PERIOD

    def is_due(self, stamp: int) -> bool:
        """Whether goals should be told; True once in each period.

        Args:
            stamp: the present simulated time, ns.
        """
        if 0 <= stamp - self._told < PERIOD:
            return False
        self._told = stamp
        return True

    def message(self, start: int, stamp: int) -> RosObject | None:
        """The feedback message of a running goal; None if there is nothing to tell.

        Args:
            start: simulated time at which the goal was accepted, ns.
            stamp: the present simulated time, ns.
        """
        if self._owner is None:
            return None
        try:
            if self._method is not None:
                return self._checked(getattr(self._owner, self._method)())
            fields = {name: value for name, value in self._known(start, stamp).items() if name in self._kinds}
            return self._make(fields) if fields else None
        except Exception as error:  # the code of the user, or a field of another type
            self.failed(error)
            return None

    def failed(self, error: Exception) -> None:
        """Log why there is no message."""
        name = f"the feedback of {self._owner.name()}"
        self._complaints.log(logging.ERROR, name, f"{name} failed: {type(error).__name__}: {error}")

    def _checked(self, message: RosObject | None) -> RosObject | None:
        if message is not None and not isinstance(message, self._kind):
            raise TypeError(f"{self._method} returned a {type(message).__name__}, expected a {self._kind.__name__}")
        return message

    def _known(self, start: int, stamp: int) -> RosMessage:
        component = getattr(self._owner, "overlaid_object", self._owner)
        robot = getattr(component, "robot_parent", None) or component
        values: DecodedMessage = {"navigation_time": (stamp - start) / _SECOND, **self._owner.progress()}
        for name, kind in self._kinds.items():
            if name in _POSES and hasattr(robot, "position_3d"):
                pose = robot.position_3d
                place = {"position": xyz((pose.x, pose.y, pose.z)), "orientation": quaternion(quaternion_of(pose))}
                pose_stamped = {"header": header_at(stamp, "map"), "pose": place}
                values[name] = pose_stamped if kind.endswith("PoseStamped") else place
            elif kind in _DURATIONS and isinstance(values.get(name), float):
                values[name] = time(round(values[name] * _SECOND))
            elif kind == "std_msgs/Header":
                values.setdefault(name, header_at(stamp, ""))
        return values
