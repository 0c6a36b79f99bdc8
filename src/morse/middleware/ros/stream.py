"""The stream of a component over ROS 1."""

from __future__ import annotations

from morse.middleware.ros.mapping import STREAM_OPTIONS
from morse.middleware.ros2.stream import Ros2Stream

#: frames of the messages of 1.4 by kind; the frames of all other messages have the names of their topics
_OF_1_4 = {"pose": "/map", "odometry": "/odom", "imu": "/imu", "scan": "/base_laser_link", "twist": "/base_link"}
_CHILD = "/base_footprint"


class RosStream(Ros2Stream):
    """Sends the messages of a component with the frame names of 1.4 or of REP 105."""

    options = STREAM_OPTIONS

    def _is_of_1_4(self) -> bool:
        return bool(self.manager.options["frames"] == "1.4")

    def _find_frame_id(self, frame: str) -> str:
        given = self.kwargs["frame_id"]
        if given or not self._is_of_1_4():
            return str(given) if given else super()._find_frame_id(frame)
        kind = self.kinds[0].kind.name if self.kinds else ""
        topic: str = self.manager.names.topic(self.component_instance, self.kwargs)
        return _OF_1_4.get(kind, topic)

    def child_frame_id(self) -> str:
        """See `Ros2Stream.child_frame_id`."""
        return str(self.kwargs["child_frame_id"] or _CHILD) if self._is_of_1_4() else super().child_frame_id()
