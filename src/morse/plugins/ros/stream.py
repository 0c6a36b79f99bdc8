"""The stream of a component over ROS 1."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, ClassVar, cast

import numpy as np

from morse.plugins.ros.mapping import STREAM_OPTIONS
from morse.rosmsgs.kinds import Ros2Topics
from morse.rosmsgs.kinds.states import clock, joined_joints
from morse.rosmsgs.parts import as_json, from_quaternion, from_xyz, header, header_at, pose_of
from morse.rosmsgs.table import Inlet, Outlet, Qos, topics
from morse.rosmsgs.topics.rosout import LogTopic, text_of
from morse.rosmsgs.topics.stream import Sending, TopicStream
from morse.rosmsgs.topics.transforms import Transforms, transform

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from morse.core.kinds import BoundKind, Message
    from morse.core.object import Object
    from morse.core.values import DecodedMessage, RosMessage
    from morse.helpers.transformation import Transformation3d
    from morse.rosmsgs.table import Carrier
    from morse.rosmsgs.topics.transforms import RobotFrames

    #: parent frame, child frame, pose
    Frame = tuple[str, str, Transformation3d]


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


def _from_pose(message: DecodedMessage) -> RosMessage:
    return {"position": from_xyz(message["position"]), "orientation": from_quaternion(message["orientation"])}


def _from_wrench(message: DecodedMessage) -> RosMessage:
    return {"force": from_xyz(message["force"]), "torque": from_xyz(message["torque"])}


#: frames of the messages of 1.4 by kind; the frames of all other messages have the names of their topics
_OF_1_4 = {"pose": "/map", "odometry": "/odom", "imu": "/imu", "scan": "/base_laser_link", "twist": "/base_link"}
_CHILD = "/base_footprint"
_SECOND = 10**9


class RosStream(TopicStream):
    """Sends the messages of a component with the frame names of 1.4 or of REP 105."""

    options = STREAM_OPTIONS
    table = Ros1Topics()

    def _is_of_1_4(self) -> bool:
        return bool(self.manager.options["frames"] == "1.4")

    def _find_frame_id(self, frame: str) -> str:
        option = self.kwargs["frame_id"]
        if option or not self._is_of_1_4():
            return str(option) if option else super()._find_frame_id(frame)
        kind = self.kinds[0].kind.name if self.kinds else ""
        topic: str = self.names.topic(self.component_instance, self.kwargs)
        return _OF_1_4.get(kind, topic)

    def child_frame_id(self) -> str:
        """See `TopicStream.child_frame_id`."""
        return str(self.kwargs["child_frame_id"] or _CHILD) if self._is_of_1_4() else super().child_frame_id()

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """See `TopicStream.ports`; the option ``topic_suffix`` replaces ``image``."""
        suffix = self.kwargs["topic_suffix"]
        outlets = super().ports(bound)
        if self._merges_joints():
            return [port._replace(make=self._all_joints, by_rows=False) for port in outlets if bound is self.kinds[0]]
        if suffix is None or bound.kind.name != "image":
            return outlets
        name = suffix.strip("/")
        return [port._replace(topic=name + port.topic.removeprefix("image")) for port in outlets]

    def _offered(self, bound: BoundKind, outlets: list[Outlet]) -> list[Sending]:
        if not self._merges_joints():
            return super()._offered(bound, outlets)
        topic = self.names.topic(self.component_instance, self.kwargs)
        offer = self.manager.offer(self, topic, outlets[0])
        return [] if offer is None else [Sending(*offer)]

    def _merges_joints(self) -> bool:
        """Whether the stream has the joints of several sensors, which 1.4 sent in one message."""
        several = self.direction == "OUT" and len(self.kinds) > 1
        return several and all(bound.kind.name == "joints" for bound in self.kinds)

    def _all_joints(self, message: Message, frame: str) -> RosMessage:
        messages = [bound.gather() for bound in self.kinds]
        measured, quantities = joined_joints(messages)
        # joints that are not simulated are at 0
        joints = getattr(self.component_instance.robot_parent, "all_joints", ())
        names = list(dict.fromkeys([*joints, *measured]))
        content: RosMessage = {"header": header(messages[0], ""), "name": names}
        for quantity, measurements in quantities.items():
            values = dict(zip(measured, measurements, strict=False))
            content[quantity] = [values.get(name, 0.0) for name in names] if values else []
        return content

    # -- transforms of 1.4 -------------------------------------------------------------------

    def transforms(self) -> Iterator[Frame]:
        """The transforms on ``/tf`` in each tick: of a camera on its robot, of the objects that a camera recognises."""
        component: Any = self.component_instance
        if component.is_camera and self.kwargs["pub_tf"]:
            yield (
                self.kwargs["parent_frame_id"] or "/base_link",
                self.own_frame(),
                component.sensor_to_robot_position_3d(),
            )
        for bound in self.kinds:
            if bound.kind.name == "detections" and component.active:
                parent = self.own_frame() if getattr(component, "relative", False) else "/map"
                for record in bound.gather().records:
                    yield parent, str(record["id"]), pose_of(record["position"], record["orientation"])

    def repeated_transforms(self) -> Iterator[Frame]:
        """The transforms on ``/tf`` once a second, which are valid for the next second."""
        yield from ()

    def fixed_transforms(self) -> Iterator[Frame]:
        """The transforms on ``/tf_static``."""
        yield from ()


class TransformsOf14(Transforms):
    """From ``/odom`` to ``/base_footprint`` for each odometry sensor, and those of `RosStream`."""

    #: time of the last repeated transforms, ns
    _repeated = -_SECOND

    def publish(self, stamp: int, *, wanted: bool) -> Callable[[], object] | None:
        """See `Transforms.publish`."""
        moving = super().publish(stamp, wanted=wanted)
        # simulated time goes back at a restart
        if moving is None or 0 <= stamp - self._repeated < _SECOND:
            return moving
        each = (stream for frames in self._robots.values() for stream in _streams(frames))
        # tf looks up the present time between two stamps
        repeated = [transform(stamp + _SECOND, *one) for stream in each for one in stream.repeated_transforms()]
        if not repeated:
            return moving
        self._repeated = stamp

        def send() -> None:
            moving()
            self._send({"transforms": repeated})

        return send

    def add(self, stream: Any, *, lenient: bool = False) -> None:
        """See `Transforms.add`: the frames of 1.4 do not contain the robot, and several sensors may publish them."""
        super().add(stream, lenient=True)

    def _static(self) -> Iterator[Frame]:
        for frames in self._robots.values():
            for stream in _streams(frames):
                yield from stream.fixed_transforms()

    def _with_base(self) -> Iterator[RobotFrames]:
        return (frames for frames in self._robots.values() if frames.source is not None)

    def _moving(self) -> Iterator[Frame]:
        for frames in self._robots.values():
            for stream in _streams(frames):
                yield from stream.transforms()


def _streams(frames: RobotFrames) -> list[RosStream]:
    return cast("list[RosStream]", frames.streams)


#: levels of rosgraph_msgs/Log are powers of two, from DEBUG on
_LEVELS, _STEP = (1, 2, 4, 8, 16), 10


class LogTopicOfRos1(LogTopic):
    """Publishes log records of MORSE on the topic that the node of rospy has in any case."""

    type: ClassVar = "rosgraph_msgs/msg/Log"
    qos: ClassVar = Qos(1000)

    def message(self, record: logging.LogRecord, stamp: int) -> RosMessage:
        """See `LogTopic.message`."""
        return {
            "header": header_at(stamp, ""),
            "level": _LEVELS[min(max(record.levelno // _STEP - 1, 0), len(_LEVELS) - 1)],
            "name": record.name,
            "msg": text_of(record),
            "file": record.pathname,
            "function": record.funcName or "",
            "line": record.lineno,
        }
