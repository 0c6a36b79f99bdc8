"""Data fields with their own topics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.rosmsgs.json_text import as_json
from morse.rosmsgs.outlets import Outlet

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.kinds import BoundKind, Message
    from morse.core.object import Object
    from morse.core.values import RosMessage

_SINGLE = ((bool, "Bool"), (int, "Int64"), (float, "Float64"), (str, "String"))


def unsaid(kinds: Iterable[BoundKind]) -> list[str]:
    """The fields of a component that are in none of its messages; all fields if it has no kind."""
    rests = [kind.rest for kind in kinds]
    return [name for name in (rests[0] if rests else ()) if all(name in rest for rest in rests)]


def field_outlet(component: Object, name: str) -> Outlet:
    """The topic of a field; the type of the message is that of its initial value."""
    value = component.local_data[name]
    for kind, message in _SINGLE:
        if isinstance(value, kind):
            return Outlet(f"std_msgs/msg/{message}", _single(component, name), name)
    if _are_numbers(value):
        return Outlet("std_msgs/msg/Float64MultiArray", _array(component, name), name)
    return Outlet("std_msgs/msg/String", lambda m, f: {"data": as_json(component.local_data[name])}, name)


def _are_numbers(value: object) -> bool:
    try:
        array = np.asarray(value)
    except ValueError:  # lists of different lengths
        return False
    return array.ndim > 0 and array.dtype.kind in "biuf"


def _single(component: Object, name: str) -> Callable[[Message, str], RosMessage]:
    return lambda m, f: {"data": component.local_data[name]}


def _array(component: Object, name: str) -> Callable[[Message, str], RosMessage]:
    def make(message: Message, frame: str) -> RosMessage:
        array = np.asarray(component.local_data[name], dtype=np.float64)
        strides = [int(np.prod(array.shape[axis:])) for axis in range(array.ndim)]
        dimensions = [
            {"label": f"axis{axis}", "size": size, "stride": stride}
            for axis, (size, stride) in enumerate(zip(array.shape, strides, strict=True))
        ]
        return {"layout": {"dim": dimensions}, "data": array}

    return make
