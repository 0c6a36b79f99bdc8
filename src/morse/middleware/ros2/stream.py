"""The stream of a component: its messages on topics."""

from __future__ import annotations

import struct
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple
from zlib import crc32

import numpy as np

from morse.core.exceptions import MorseMiddlewareError
from morse.core.kinds import bind
from morse.core.streams.kind_stream import KindStream
from morse.helpers.transformation import Transformation3d
from morse.middleware.ros2.mapping import STREAM_OPTIONS
from morse.rosmsgs.cdr import CdrError, encode_stamped
from morse.rosmsgs.fields import field_outlet, unsaid
from morse.rosmsgs.names import relative_name, robot_of
from morse.rosmsgs.parts import covariance, header, quaternion, three, xyz, xyzw
from morse.rosmsgs.poses import OPTICAL_INVERSE, motion_of_robot, pose_of, product, quaternion_of
from morse.rosmsgs.sizes import check_size

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from morse.core.kinds import BoundKind, Message
    from morse.core.object import Object
    from morse.middleware.ros2.backends.backend import Publisher, Subscription
    from morse.middleware.ros2.together import Together
    from morse.physics.objects.mounting import Mounting
    from morse.rosmsgs.outlets import Inlet, Outlet
    from morse.rosmsgs.poses import Motion

#: number of actions without a message after which a stream checks for senders of another type
_PATIENCE = 120
_UNKNOWN = (0.0,) * 36
_UNFIT = (ValueError, TypeError, OverflowError, struct.error, RecursionError)


def _numbers(matrix: Any) -> Sequence[float]:
    """The 36 numbers of a covariance; None becomes all zeros, which means unknown."""
    if matrix is None:
        return _UNKNOWN
    found: list[float] = np.asarray(matrix, dtype=np.float64).reshape(-1).tolist()
    return found


def _placed(mounting: Mounting) -> Transformation3d:
    """A pose in a rigid group."""
    made = Transformation3d()
    made.set_pose(mounting.offset, mounting.turned)
    return made


class Sending(NamedTuple):
    """A topic that a stream publishes."""

    topic: str
    outlet: Outlet
    publisher: Publisher


class _Hearing(NamedTuple):
    topic: str
    bound: BoundKind
    inlet: Inlet
    subscription: Subscription


class Ros2Stream(KindStream):
    """Sends the messages of a component on their topics, or writes received messages into the component."""

    options = STREAM_OPTIONS

    def initialize(self) -> None:
        """Open the topics.

        Raises:
            MorseMiddlewareError: a topic is in use, or has a name that ROS does not allow.
        """
        super().initialize()
        self.robot = robot_of(self.component_instance)
        self._frame_ids: dict[str, str] = {}
        self._sender = self.manager.context.arrivals.sender()
        # streams check in different ticks
        self._silence = crc32(self.component_name.encode()) % _PATIENCE
        self._prepared = self.manager.backend.is_cdr
        self.sending: list[tuple[BoundKind, list[Sending]]] = []
        self._hearing: list[_Hearing] = []
        for bound in self.kinds:
            ports = self.ports(bound)
            if not ports:
                continue
            if self.direction == "IN":
                self._hearing += [
                    _Hearing(topic, bound, inlet, subscription)
                    for inlet in ports
                    for topic, subscription in self.manager.hear(self, bound, inlet)
                ]
            else:
                self.sending.append((bound, self._offered(bound, ports)))
        self._known_motion: tuple[Message | None, Any] = None, None
        odometry = [bound for bound in self.kinds if bound.kind.name == "odometry"]
        self._odometry = odometry[0] if odometry and self.gives_transform else None
        if self.direction == "OUT":
            self._offer_fields()
            self.manager.robots.add(self)
            # a scene that was not made for ROS may have two odometry sensors
            self.manager.transforms.add(self, lenient="ros2" in self.manager.context.scene.interfaces)
        together = self.manager.together
        self._rigid: Transformation3d | None = None
        self._together: Together | None = (
            together if together is not None and together.takes(self, self.sending) else None
        )

    def find_kinds(self) -> tuple[BoundKind, ...]:
        """See `KindStream.find_kinds`: with the cloud of a laser scanner if the script asks for it.

        Raises:
            MorseMiddlewareError: the component has no such cloud.
        """
        usual = super().find_kinds()
        if not self.kwargs.get("points"):
            return usual
        found = bind(self.component_instance, on_request=True)
        if len(found) == len(usual):
            raise MorseMiddlewareError(
                f"{self.component_name}: points=True is for laser scanners with one layer, at the levels raw and rssi"
            )
        return found

    def ports(self, bound: BoundKind) -> list[Any]:
        """The topics of a kind: instances of `Outlet`, or of `Inlet` if the stream receives messages."""
        method = self.manager.mapping(bound.kind.name, self.direction)
        return [] if method is None else list(method(self, bound))

    def _offer_fields(self) -> None:
        if self.kwargs["fields"] and self.kinds:
            outlets = [field_outlet(self.component_instance, name) for name in unsaid(self.kinds)]
            main = next((kind for kind in self.kinds if not kind.topic), self.kinds[0])
            self.sending.append((main, self._offered(main, outlets)))

    def _offered(self, bound: BoundKind, outlets: list[Outlet]) -> list[Sending]:
        offers = [self.manager.offer(self, bound, outlet) for outlet in outlets]
        return [Sending(*offer) for offer in offers if offer is not None]

    # -- frames ------------------------------------------------------------------------------

    def frame_id(self, frame: str) -> str:
        """The name of a frame of the component; an option of the stream may replace that of its messages."""
        known = self._frame_ids.get(frame)
        if known is None:
            known = self._frame_ids[frame] = self._find_frame_id(frame)
        return known

    def _find_frame_id(self, frame: str) -> str:
        given = self.kwargs["frame_id"]
        if given and (not self.kinds or frame == self.kinds[0].frame):
            return str(given)
        name: str = self.manager.names.frame(self.component_instance, frame)
        return name

    def own_frame(self) -> str:
        """The name of the frame of the component."""
        return self.frame_id("own")

    def child_frame_id(self) -> str:
        """The name of the frame of the robot."""
        return str(self.kwargs["child_frame_id"] or self.manager.names.base(self.robot))

    def frames(self) -> set[str]:
        """The frames of the messages of the component."""
        said = {line.outlet.frame for _, lines in self.sending for line in lines if line.outlet.frame}
        return {bound.frame for bound in self.kinds} | said

    def mounting(self) -> Transformation3d:
        """The present pose of the component on its robot, X forward."""
        obj, body = self.component_instance.bge_object, self.robot.bge_object
        if self.is_rigid():
            # the same bits in all ticks
            pose = _placed(body.mounting).transformation3d_with(_placed(obj.mounting))
        else:
            pose = self.component_instance.sensor_to_robot_position_3d()
        # the axes of a camera object are those of its image
        return product(pose, OPTICAL_INVERSE) if hasattr(self.component_instance, "lens") else pose

    def is_rigid(self) -> bool:
        """Whether the component is part of the body of the robot, in which only calls can move it."""
        return bool(self.component_instance.bge_object.slot == self.robot.bge_object.slot)

    def master(self) -> Any:
        """The camera in whose frame the images or clouds of several cameras are; None for all other components."""
        component: Any = self.component_instance
        clouds = getattr(component, "clouds", None)
        return component.master() if clouds is not None and clouds() else None

    def is_carried(self) -> bool:
        """Whether it is on another component that may move it."""
        component = self.component_instance
        names = component.name().split(".")
        depth = relative_name(component).count(".")
        carriers = (".".join(names[: len(names) - up]) for up in range(1, depth + 1))
        return any(getattr(component.context.component(name), "moves_parts", True) for name in carriers)

    @property
    def gives_transform(self) -> bool:
        """Whether the transform from odom to base_link is derived from it."""
        return bool(self.kwargs["tf"]) and any(bound.kind.name == "odometry" for bound in self.kinds)

    # -- acting together ---------------------------------------------------------------------

    @property
    def waiting(self) -> Collection[Any] | None:
        """See `AbstractDatastream.waiting`."""
        return None if self._together is None else ()

    @property
    def moves_frames(self) -> bool:
        """Whether the frame of the robot follows from its messages."""
        return self._odometry is not None

    def is_ready(self, written: Collection[str]) -> bool:
        """Whether its messages follow from these data fields, which are measured in each tick.

        Messages about the robot also need the pose of the sensor on the robot, which must be constant.
        """
        if any(bound.needs is None or not bound.needs <= set(written) for bound, _ in self.sending):
            return False
        if not self._tells_of_robot():
            return True
        self._rigid = self.mounting()
        return self.is_rigid()

    def _tells_of_robot(self) -> bool:
        return any(line.outlet.has_child for _, lines in self.sending for line in lines)

    def move_frames(self, message: Message) -> None:
        """Set the pose of the robot in the tree of frames, in the thread that publishes the tree."""
        self.manager.transforms.moved(self, self._motion(message, self._rigid).pose)

    def detached(self, line: Sending) -> Sending:
        """A topic whose messages another thread may make; the pose on the robot is that found by `is_ready`."""
        if not line.outlet.has_child:
            return line
        make = partial(self.odometry, mounting=self._rigid)
        numbers = partial(self.odometry_numbers, mounting=self._rigid)
        return line._replace(outlet=line.outlet._replace(make=make, numbers=numbers))

    # -- publishing --------------------------------------------------------------------------

    def default(self, ci: Object | None = None) -> bool:
        """Publish, or process received messages; True if there were any."""
        if self.direction == "IN":
            self._hear()
            return super().default(ci)
        for bound, lines in self.sending:
            wanted = [line for line in lines if line.publisher.wanted()]
            moves = bound is self._odometry and self.manager.wants_transforms()
            if not wanted and not moves:
                continue
            message = bound.gather()
            if moves:
                pose = self._motion(message, None).pose
                self.manager.sender.do(partial(self.manager.transforms.moved, self, pose))
            for line in wanted:
                if line.outlet.when is not None and not line.outlet.when():
                    continue
                frame = self.frame_id(line.outlet.frame or message.frame)
                if line.outlet.takes_long:
                    self.manager.sender.do(partial(self.send, line, message, frame), self)
                else:
                    self.send(line, message, frame)
        return False

    def send(self, line: Sending, message: Message, frame: str) -> None:
        """Encode and send a message."""
        try:
            outlet, backend = line.outlet, self.manager.backend
            if outlet.numbers is not None and self._prepared:
                child = self.child_frame_id() if outlet.has_child else None
                data = encode_stamped(outlet.type, message.stamp, frame, outlet.numbers(message), child)
            else:
                made = outlet.make(message, frame)
                if made is None:
                    return
                data = backend.encode(outlet.type, made)
        except _UNFIT as error:
            self.complain(
                f"encode {line.topic}",
                f"a message for {line.topic} is not a valid {line.outlet.type} and is omitted: {error}",
            )
            return
        if not line.publisher.publish(data):
            self.complain(f"slow {line.topic}", f"a reader of {line.topic} is too slow: a message is lost")

    def _motion(self, message: Message, mounting: Transformation3d | None) -> Motion:
        known, motion = self._known_motion
        if mounting is None and message is known:  # a message is used for the frames and for its own topic
            return motion  # type: ignore[no-any-return]
        sensor = pose_of(message.position, message.orientation)
        motion = motion_of_robot(sensor, message.linear, message.angular, mounting or self.mounting())
        if mounting is None:
            self._known_motion = message, motion
        return motion

    def odometry_numbers(self, message: Message, mounting: Transformation3d | None = None) -> tuple[float, ...]:
        """The numbers of `odometry`."""
        pose, linear, angular = self._motion(message, mounting)
        return (
            *three((pose.x, pose.y, pose.z)), *xyzw(quaternion_of(pose)), *_numbers(message.pose_covariance),
            *three(linear), *three(angular), *_numbers(message.twist_covariance),
        )  # fmt: skip

    def odometry(self, message: Message, frame: str, mounting: Transformation3d | None = None) -> dict[str, Any]:
        """``nav_msgs/Odometry`` of the robot, wherever the sensor is mounted.

        Args:
            message: of the sensor.
            frame: of the pose.
            mounting: pose of the sensor on the robot; None for the present one.
        """
        pose, linear, angular = self._motion(message, mounting)
        return {
            "header": header(message, frame),
            "child_frame_id": self.child_frame_id(),
            "pose": {
                "pose": {"position": xyz((pose.x, pose.y, pose.z)), "orientation": quaternion(quaternion_of(pose))},
                "covariance": covariance(message.pose_covariance),
            },
            "twist": {
                "twist": {"linear": xyz(linear), "angular": xyz(angular)},
                "covariance": covariance(message.twist_covariance),
            },
        }

    # -- commands ----------------------------------------------------------------------------

    def _hear(self) -> None:
        """Read what has arrived, unless it took more than its share of the time in the last ticks."""
        if self._sender.rests:
            return
        silent = True
        for hearing in self._hearing:
            messages = hearing.subscription.take()
            if messages:
                silent = False
                with self._sender.measured():
                    for data in messages:
                        self._read(hearing, data)
        if silent:
            self._look_for_others()
        elif self.manager.context.paced():
            self._sender.rest_if_due()

    def _look_for_others(self) -> None:
        """If no messages arrive, warn about senders of messages of another type, which are not received."""
        self._silence += 1
        if self._silence % _PATIENCE:
            return
        for hearing in self._hearing:
            for other in sorted(hearing.subscription.other_types()):
                stamped = "TwistStamped" in other and not self.kwargs["stamped"]
                mend = "; set stamped=True" if stamped else ""
                self.complain(
                    f"type {hearing.topic}",
                    f"somebody sends {other} on {hearing.topic}, which takes {hearing.inlet.type}{mend}",
                )

    def _read(self, hearing: _Hearing, data: bytes) -> None:
        try:
            check_size(hearing.inlet.type, data)
            message = self.manager.backend.decode(hearing.inlet.type, data)
            slots = hearing.inlet.take(message)
        except (CdrError, *_UNFIT) as error:
            self.complain(f"read {hearing.topic}", f"a message on {hearing.topic} is refused: {error}")
            return
        frame_id = message.get("header", {}).get("frame_id", "")
        frame = ""
        if frame_id and any(hearing.bound.kind.slots[name].moves for name in slots if name in hearing.bound.kind.slots):
            known = self._from_frame(frame_id, slots)
            if known is None:
                self.complain(
                    f"frame {hearing.topic}", f"a message on {hearing.topic} is in the unknown frame {frame_id!r:.80}"
                )
                return
            frame = known
        self.receive(hearing.bound, slots, frame)

    def _from_frame(self, frame_id: str, slots: dict[str, Any]) -> str | None:
        """The frame of a command; a pose relative to the start is converted to the world frame."""
        names = self.manager.names
        if frame_id.lstrip("/") != names.odom(self.robot) or "position" not in slots:
            known: str | None = names.frame_of(self.component_instance, frame_id)
            return known
        given = slots.get("orientation", (1.0, 0.0, 0.0, 0.0))
        turned = bool(np.any(given))
        place = pose_of(slots["position"], given if turned else (1.0, 0.0, 0.0, 0.0))
        pose = product(self.robot.initial_position_3d, place)
        slots["position"] = [pose.x, pose.y, pose.z]
        if "orientation" in slots and turned:
            slots["orientation"] = list(quaternion_of(pose))
        return "world"
