"""Messages that differ between ROS 1 and ROS 2: those of MORSE 1.4."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.json_text import as_json
from morse.rosmsgs.kinds import Ros2Topics
from morse.rosmsgs.kinds.states import clock
from morse.rosmsgs.outlets import Inlet, Outlet
from morse.rosmsgs.parts import from_quaternion, from_xyz, header
from morse.rosmsgs.table import topics

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.kinds import BoundKind, Message
    from morse.core.object import Object
    from morse.core.values import RosMessage
    from morse.rosmsgs.table import Carrier

logger = logging.getLogger(__name__)

_STRING = "std_msgs/msg/String"
#: components whose data 1.4 published as the text of a Python dictionary
_AS_REPR = ("Proximity", "Gyroscope")
#: minimum range of every scan of 1.4, m
_NEAREST = 0.3


def _is_a(component: Object, *names: str) -> bool:
    return any(cls.__name__ in names for cls in type(component).__mro__)


def _text_of(component: Object) -> Outlet:
    return Outlet(_STRING, lambda m, f: {"data": repr(dict(component.local_data))})


class Ros1Topics(Ros2Topics):
    """Messages that differ from those of ROS 2."""

    # -- sensors -----------------------------------------------------------------------------

    @topics("pose")
    def pose(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A GPS without orientation publishes a ``NavSatFix`` in metres, as in 1.4."""
        if not _is_a(bound.component, "GPS"):
            return super().pose(stream, bound)
        logger.warning(
            "ros: %s sends metres as latitude (x), longitude (y) and altitude (z), as MORSE 1.4 did; "
            "level('raw') sends degrees",
            stream.component_name,
        )
        return [Outlet("sensor_msgs/msg/NavSatFix", _metres)]

    @topics("imu")
    def imu(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """On the topic of the component."""
        return [outlet._replace(topic="") for outlet in super().imu(stream, bound)]

    @topics("attitude")
    def attitude(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A gyroscope publishes its angles as text."""
        if _is_a(bound.component, *_AS_REPR):
            return [_text_of(bound.component)]
        return super().attitude(stream, bound)

    @topics("battery")
    def battery(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Per cent."""
        return [Outlet("std_msgs/msg/Float32", lambda m, f: {"data": 100.0 * m.charge})]

    @topics("scan")
    def scan(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """As in 1.4: from a minimum range of 0.3 m to the maximum range, which rays that hit nothing have."""
        infinite = stream.kwargs["infinite"]

        def limited(make: Callable[..., Any]) -> Callable[[Message, str], RosMessage]:
            def scan(message: Message, frame: str) -> RosMessage:
                content = {**make(message, frame), "range_min": _NEAREST}
                if not infinite:
                    content["ranges"] = np.minimum(content["ranges"], content["range_max"])
                return content

            return scan

        outlets = super().scan(stream, bound)
        return [outlet._replace(make=limited(outlet.make)) for outlet in outlets]

    @topics("detections")
    def detections(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """As JSON."""
        return [Outlet(_STRING, lambda m, f: {"data": as_json(bound.component.local_data["visible_objects"])})]

    @topics("clock")
    def clock_sensor(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """The time of the simulation, on the topic of the component."""
        return [Outlet("rosgraph_msgs/msg/Clock", lambda m, f: clock(m.stamp))]

    @topics("general")
    def general(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """All fields as JSON, or in the format of 1.4 for its components."""
        if _is_a(bound.component, *_AS_REPR):
            return [_text_of(bound.component)]
        return super().general(stream, bound)

    # -- actuators ---------------------------------------------------------------------------

    @topics("pose", direction="IN")
    def take_pose(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A ``Pose``, or a ``Point`` for actuators without orientation."""
        if not bound.has("orientation"):
            return [Inlet("geometry_msgs/msg/Point", lambda m: {"position": from_xyz(m)})]
        return [Inlet("geometry_msgs/msg/Pose", _from_pose)]

    @topics("attitude", direction="IN")
    def take_attitude(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A ``Quaternion``; with thrust four numbers, as in ROS 2."""
        if bound.has("thrust"):
            return super().take_attitude(stream, bound)
        return [Inlet("geometry_msgs/msg/Quaternion", lambda m: {"orientation": from_quaternion(m)})]

    @topics("wrench", direction="IN")
    def take_wrench(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A ``Wrench``."""
        return [Inlet("geometry_msgs/msg/Wrench", _from_wrench)]

    @topics("joints", direction="IN")
    def take_joints(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A pan-tilt unit takes a ``Vector3``: y is pan, z is tilt."""
        if _is_a(bound.component, "PTU"):
            return [Inlet("geometry_msgs/msg/Vector3", lambda m: {"position": [m["y"], m["z"]]})]
        return super().take_joints(stream, bound)


def _metres(message: Message, frame: str) -> RosMessage:
    x, y, z = message.position
    return {"header": header(message, frame), "latitude": float(x), "longitude": float(y), "altitude": float(z)}


def _from_pose(message: RosMessage) -> RosMessage:
    return {"position": from_xyz(message["position"]), "orientation": from_quaternion(message["orientation"])}


def _from_wrench(message: RosMessage) -> RosMessage:
    return {"force": from_xyz(message["force"]), "torque": from_xyz(message["torque"])}
