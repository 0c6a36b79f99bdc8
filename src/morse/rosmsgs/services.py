"""Service calls with the standard types of ROS.

A service without arguments is ``std_srvs/Trigger``, a service with one boolean ``std_srvs/SetBool``. All others take
named and typed arguments, for which ROS has only one type: ``rcl_interfaces/SetParametersAtomically``.
"""

from __future__ import annotations

import functools
import inspect
from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest, shown
from morse.core.services import hints_of, service, signature_of
from morse.rosmsgs.parts import as_json, from_json

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.values import DecodedMessage, RosMessage


TRIGGER, SET_BOOL = "std_srvs/srv/Trigger", "std_srvs/srv/SetBool"
SET_PARAMETERS = "rcl_interfaces/srv/SetParametersAtomically"
#: fields of rcl_interfaces/ParameterValue by its type
VALUES = {
    1: "bool_value", 2: "integer_value", 3: "double_value", 4: "string_value", 5: "byte_array_value",
    6: "bool_array_value", 7: "integer_array_value", 8: "double_array_value", 9: "string_array_value",
}  # fmt: skip
_NOTHING = inspect.Parameter.empty


class Call:
    """The signature of a service.

    Args:
        callback: the service.

    Attributes:
        type: of the ROS service.
    """

    def __init__(self, callback: Callable[..., object]) -> None:
        try:
            parameters = list(signature_of(callback).parameters.values())
        except (TypeError, ValueError):
            parameters = []
        self._parameters = {one.name: one for one in parameters}
        self._words = {name for name, hint in hints_of(callback).items() if hint in (str, str | None)}
        hints = hints_of(callback)
        if not parameters:
            self.type = TRIGGER
        elif len(parameters) == 1 and hints.get(parameters[0].name) is bool:
            self.type = SET_BOOL
        else:
            self.type = SET_PARAMETERS

    def arguments(self, request: DecodedMessage) -> list[object]:
        """The arguments in the order of the service.

        Raises:
            MorseRPCInvokationError: an argument is missing, duplicated or unknown.
        """
        if self.type == TRIGGER:
            return []
        if self.type == SET_BOOL:
            return [bool(request["data"])]
        result: RosMessage = {}
        for one in request["parameters"]:
            name = one["name"]
            if name not in self._parameters:
                raise MorseRPCInvokationError(
                    f"there is no argument {shown(name)}{nearest(name, list(self._parameters))}; "
                    f"known: {', '.join(self._parameters)}"
                )
            if name in result:
                raise MorseRPCInvokationError(f"the argument '{name}' is given twice")
            result[name] = self._value(name, one["value"])
        values = []
        # an optional argument may be omitted although a later one is given
        last = max((list(self._parameters).index(name) for name in result), default=-1)
        for index, (name, parameter) in enumerate(self._parameters.items()):
            if name in result:
                values.append(result[name])
            elif parameter.default is _NOTHING:
                raise MorseRPCInvokationError(f"the argument '{name}' is missing")
            elif index < last:
                values.append(parameter.default)
        return values

    def _value(self, name: str, value: DecodedMessage) -> object:
        field = VALUES.get(value["type"])
        if field is None:
            return None
        content = value[field]
        if hasattr(content, "tolist"):
            return content.tolist()
        if field == "string_value" and name not in self._words:
            # values without a parameter type, such as a list of lists, are JSON
            try:
                return from_json(content)
            except ValueError:
                return content
        return content

    def answer(self, state: str, result: object) -> RosMessage:
        """The response: the result as JSON, or an error message."""
        good = state == status.SUCCESS
        text = "" if result is None else result if isinstance(result, str) and not good else as_json(result)
        if not good:
            text = f"{state}: {text}" if text else state
        if self.type == SET_PARAMETERS:
            return {"result": {"successful": good, "reason": text}}
        return {"success": good, "message": text}


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
            `morse.rosmsgs.actions`.
        component: see `morse.core.services.service`.
        name: see `morse.core.services.service`.
    """
    if fn is None:
        return functools.partial(ros_action, type=type, component=component, name=name, feedback=feedback)
    method: Any = service(component=component, name=name, asynchronous=True)(fn)
    method._ros_action_type, method._ros_action_feedback = type, feedback
    return method
