"""The messages of one component, without a transport."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from morse.core.exceptions import MorseMiddlewareError
from morse.core.kinds import bind
from morse.helpers.transformation import Transformation3d
from morse.mathutils.rotations import turn
from morse.rosmsgs.kinds import Ros2Topics
from morse.rosmsgs.names import Names, relative_name, robot_of
from morse.rosmsgs.parts import (
    OPTICAL_INVERSE,
    as_json,
    covariance,
    covariance_of_robot,
    floats,
    header,
    motion_of_robot,
    pose_of,
    product,
    quaternion,
    quaternion_of,
    xyz,
)
from morse.rosmsgs.table import Outlet

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from morse.core.kinds import BoundKind, Message
    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.core.values import Options, RosMessage
    from morse.core.world.body import Mounting
    from morse.rosmsgs.parts import Motion
    from morse.rosmsgs.table import TopicTable

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


def kinds_of(component: Object, options: Mapping[str, object]) -> tuple[BoundKind, ...]:
    """The message kinds of a component, with the cloud of a laser scanner if the option ``points`` asks for it.

    Raises:
        MorseMiddlewareError: the component has no such cloud.
    """
    usual = bind(component)
    if not options.get("points"):
        return usual
    kinds = bind(component, on_request=True)
    if len(kinds) == len(usual):
        raise MorseMiddlewareError(
            f"{component.name()}: points=True is for laser scanners with one layer, at the levels raw and rssi"
        )
    return kinds


class ComponentMessages:
    """The messages, topics and frames of a component: the part of a stream that knows no transport.

    Attributes:
        component_instance, component_name: the component and its name.
        kinds: its message kinds.
        kwargs: its options, see `morse.rosmsgs.names.MESSAGE_OPTIONS`.
        robot: the robot of the component.
    """

    table: ClassVar[TopicTable] = Ros2Topics()
    component_instance: Object
    component_name: str
    kwargs: Options
    kinds: tuple[BoundKind, ...]

    def frames(self) -> set[str]:
        """The frames of the messages of the component."""
        return {bound.frame for bound in self.kinds}

    def name_frames(self, names: Names) -> None:
        """Begin with these names of topics and frames."""
        self.names = names
        self.robot: Robot = robot_of(self.component_instance)
        self._frame_ids: dict[str, str] = {}
        self._known_motion: tuple[Message | None, Motion | None] = None, None

    # -- topics ------------------------------------------------------------------------------

    def ports(self, bound: BoundKind) -> list[Outlet]:
        """The topics of a kind."""
        return self.table.outlets(self, bound)

    def outlets(self) -> Iterator[tuple[BoundKind, list[Outlet]]]:
        """Iterate over the topics of each kind, and of the fields without a kind if the options ask for them."""
        for bound in self.kinds:
            outlets = self.ports(bound)
            if outlets:
                yield bound, outlets
        if self.kwargs["fields"] and self.kinds:
            main = next((kind for kind in self.kinds if not kind.topic), self.kinds[0])
            yield main, [field_outlet(self.component_instance, name) for name in unsaid(self.kinds)]

    def topic_of(self, bound: BoundKind, outlet: Outlet) -> str:
        """The name of a topic: that of the kind and of the outlet, below that of the component."""
        base = self.names.topic(self.component_instance, self.kwargs)
        # a component whose own topic has this message needs no second topic below it
        last = "" if bound.topic.rpartition("/")[2] == outlet.topic else outlet.topic
        return "/".join(part for part in (base, bound.topic, last) if part)

    # -- frames ------------------------------------------------------------------------------

    def frame_id(self, frame: str) -> str:
        """The name of a frame of the component; an option of the stream may replace that of its messages."""
        cached_id = self._frame_ids.get(frame)
        if cached_id is None:
            cached_id = self._frame_ids[frame] = self._find_frame_id(frame)
        return cached_id

    def _find_frame_id(self, frame: str) -> str:
        option = self.kwargs["frame_id"]
        if option and (not self.kinds or frame == self.kinds[0].frame):
            return str(option)
        name: str = self.names.frame(self.component_instance, frame)
        return name

    def own_frame(self) -> str:
        """The name of the frame of the component."""
        return self.frame_id("own")

    def child_frame_id(self) -> str:
        """The name of the frame of the robot."""
        return str(self.kwargs["child_frame_id"] or self.names.base(self.robot))

    def mounting(self) -> Transformation3d:
        """The present pose of the component on its robot, X forward."""
        obj, body = self.component_instance.bge_object, self.robot.bge_object
        if self.is_rigid():
            # the same bits in all ticks
            pose = _placed(body.mounting).transformation3d_with(_placed(obj.mounting))
        else:
            pose = self.component_instance.sensor_to_robot_position_3d()
        # the axes of a camera object are those of its image
        return product(pose, OPTICAL_INVERSE) if self.component_instance.is_camera else pose

    def is_rigid(self) -> bool:
        """Whether the component is part of the body of the robot, in which only calls can move it."""
        return bool(self.component_instance.bge_object.slot == self.robot.bge_object.slot)

    def master(self) -> Object | None:
        """The camera in whose frame the images or clouds of several cameras are; None for all other components."""
        return self.component_instance.frame_owner()

    def is_carried(self) -> bool:
        """Whether it is on another component that may move it."""
        component = self.component_instance
        names = component.name().split(".")
        depth = relative_name(component).count(".")
        carriers = (component.context.component(".".join(names[:-up])) for up in range(1, depth + 1))
        return any(carrier is None or carrier.moves_parts for carrier in carriers)

    @property
    def gives_transform(self) -> bool:
        """Whether the transform from odom to base_link is derived from it."""
        return bool(self.kwargs["tf"]) and any(bound.kind.name == "odometry" for bound in self.kinds)

    # -- odometry ----------------------------------------------------------------------------

    def motion(self, message: Message, mounting: Transformation3d | None = None) -> Motion:
        """The motion of the robot, from a message of odometry.

        Args:
            message: of the sensor.
            mounting: pose of the sensor on the robot; None for the present one.
        """
        key, motion = self._known_motion
        if (
            mounting is None and motion is not None and message is key
        ):  # a message is used for the frames and for its own topic
            return motion
        sensor = pose_of(message.position, message.orientation)
        motion = motion_of_robot(sensor, message.linear, message.angular, mounting or self.mounting())
        if mounting is None:
            self._known_motion = message, motion
        return motion

    def _covariances(self, message: Message, pose: Transformation3d, mounting: Transformation3d | None) -> Any:
        """The covariances of pose and twist of the robot; None if they are unknown."""
        if message.pose_covariance is None and message.twist_covariance is None:
            return None, None
        mounting = mounting or self.mounting()
        arm, rotation = mounting.get_pose()[0], pose.get_pose()[1]
        return (
            covariance_of_robot(message.pose_covariance, mounting, turn(rotation, floats(arm))),
            covariance_of_robot(message.twist_covariance, mounting, floats(arm)),
        )

    def odometry(self, message: Message, frame: str, mounting: Transformation3d | None = None) -> RosMessage:
        """``nav_msgs/Odometry`` of the robot, wherever the sensor is mounted.

        Args:
            message: of the sensor.
            frame: of the pose.
            mounting: pose of the sensor on the robot; None for the present one.
        """
        pose, linear, angular = self.motion(message, mounting)
        of_pose, of_twist = self._covariances(message, pose, mounting)
        return {
            "header": header(message, frame),
            "child_frame_id": self.child_frame_id(),
            "pose": {
                "pose": {"position": xyz((pose.x, pose.y, pose.z)), "orientation": quaternion(quaternion_of(pose))},
                "covariance": covariance(of_pose),
            },
            "twist": {
                "twist": {"linear": xyz(linear), "angular": xyz(angular)},
                "covariance": covariance(of_twist),
            },
        }


def _placed(mounting: Mounting) -> Transformation3d:
    """A pose in a rigid group."""
    pose = Transformation3d()
    pose.set_pose(mounting.offset, mounting.turned)
    return pose
