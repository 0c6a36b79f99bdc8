"""Requests whose outcome is passed to a function: the base of managers that answer callers by their own messages."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseError
from morse.core.request_manager import Outcome, RequestManager
from morse.core.status import FAILED

if TYPE_CHECKING:
    import uuid
    from collections.abc import Callable, Sequence

    from morse.core.context import Context
    from morse.core.values import JsonObject


#: maximum number of active calls
MOST_ACTIVE = 1024


class AnsweredRequests(RequestManager):
    """A request manager that calls a function at the end of each call."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        self._ends: dict[uuid.UUID, Callable[[Outcome], object]] = {}
        self._complaints = Complaints(logging.getLogger(type(self).__module__))

    def call(
        self, component: str, service: str, arguments: list[object], on_end: Callable[[Outcome], object]
    ) -> uuid.UUID | None:
        """Call a service of this manager.

        Args:
            on_end: called with status and result, in this tick or in a later one.

        Returns:
            The call, if it is asynchronous.
        """
        if len(self._ends) >= MOST_ACTIVE:
            on_end((FAILED, f"{MOST_ACTIVE} calls are active: wait until they end"))
            return None
        try:
            is_complete, outcome = self.on_incoming_request(component, service, arguments)
        except MorseError as error:
            on_end((FAILED, str(error)))
        except Exception as error:  # the service may be user code
            on_end((FAILED, self._complaints.service_failed(f"the service {service} of {component}", error)))
        else:
            if not is_complete:
                self._ends[outcome] = on_end
                return outcome  # type: ignore[no-any-return]
            on_end(outcome)
        return None

    def on_service_completion(self, request_id: uuid.UUID, result: Outcome) -> None:
        """See `RequestManager.on_service_completion`."""
        on_end = self._ends.pop(request_id, None)
        if on_end is not None:
            on_end(result)


def of_distance(distance: float, speed: float = 0.0) -> JsonObject:
    """The progress of a motion to a position, as in ``nav2_msgs/NavigateToPose``.

    Args:
        distance: distance to the position, m.
        speed: speed, m/s; 0 if it is unknown.
    """
    rest = {"estimated_time_remaining": distance / speed} if speed > 0.0 else {}
    return {"distance_remaining": distance, **rest}


def of_joints(names: Sequence[str], actual: Sequence[float], desired: Sequence[float]) -> JsonObject:
    """The progress of joints, as in ``control_msgs/FollowJointTrajectory``.

    Args:
        names: names of the joints.
        actual: joint values, rad or m.
        desired: setpoints, rad or m.
    """
    error = [goal - value for goal, value in zip(desired, actual, strict=True)]
    return {
        "joint_names": list(names),
        "desired": {"positions": list(desired)},
        "actual": {"positions": list(actual)},
        "error": {"positions": error},
    }
