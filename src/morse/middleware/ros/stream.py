"""The stream of a component over ROS 1."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.middleware.ros.kinds import Ros1Topics
from morse.middleware.ros.mapping import STREAM_OPTIONS
from morse.rosmsgs.kinds.states import joint_state
from morse.rosmsgs.poses import pose_of
from morse.rosmsgs.topics.stream import Sending, TopicStream

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.helpers.transformation import Transformation3d
    from morse.rosmsgs.outlets import Outlet

    #: parent frame, child frame, pose
    Frame = tuple[str, str, Transformation3d]

#: frames of the messages of 1.4 by kind; the frames of all other messages have the names of their topics
_OF_1_4 = {"pose": "/map", "odometry": "/odom", "imu": "/imu", "scan": "/base_laser_link", "twist": "/base_link"}
_CHILD = "/base_footprint"


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

    def ports(self, bound: BoundKind) -> list[Any]:
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
        return joint_state([bound.gather() for bound in self.kinds])

    # -- transforms of 1.4 -------------------------------------------------------------------

    def transforms(self) -> Iterator[Frame]:
        """The transforms on ``/tf`` in each tick: of a camera on its robot, of the objects that a camera recognises."""
        component: Any = self.component_instance
        if component.is_camera and self.kwargs["pub_tf"]:
            yield self.kwargs["parent_frame_id"], self.own_frame(), component.sensor_to_robot_position_3d()
        for bound in self.kinds:
            if bound.kind.name == "detections" and component.active:
                parent = self.own_frame() if getattr(component, "relative", False) else "/map"
                for record in bound.gather().records:
                    yield parent, str(record["id"]), pose_of(record["position"], record["orientation"])

    def fixed_transforms(self) -> Iterator[Frame]:
        """The transforms on ``/tf_static``."""
        yield from ()
