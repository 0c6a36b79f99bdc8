"""The options of the messages of a component."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import Option

if TYPE_CHECKING:
    from collections.abc import Mapping

#: encodings of images that an option can select
_ENCODINGS = ("rgb8", "rgba8", "bgr8", "bgra8", "mono8")

MESSAGE_OPTIONS: Mapping[str, Option] = {
    "topic": Option(str, None, "name of the topic; without a leading slash: below the namespace"),
    "namespace": Option(str, None, "namespace of the topics of this stream"),
    "frame_id": Option(str, None, "frame of the messages"),
    "child_frame_id": Option(str, None, "for odometry: frame of the robot"),
    "stamped": Option(bool, False, "for velocity commands: TwistStamped instead of Twist"),
    "fields": Option(bool, False, "every data field that is in no message gets its own topic"),
    "tf": Option(bool, True, "for odometry: publish the transform from odom to base_link"),
    "encoding": Option(str, None, "of images with colours; default: that of the camera", choices=_ENCODINGS),
    "depth16": Option(bool, False, "depth images in whole millimetres, 16UC1; 0 where there is no depth"),
    "points": Option(bool, False, "for laser scanners: a cloud on points, too"),
}
