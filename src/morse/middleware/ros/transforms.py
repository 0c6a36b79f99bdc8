"""The transforms of MORSE 1.4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from morse.rosmsgs.topics.transforms import Transforms

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.middleware.ros.stream import Frame, RosStream
    from morse.rosmsgs.topics.transforms import RobotFrames


class TransformsOf14(Transforms):
    """From ``/odom`` to ``/base_footprint`` for each odometry sensor, and those of `RosStream.transforms`."""

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
