"""The transforms of MORSE 1.4: of odometry, and of cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.middleware.ros2.transforms import Transforms

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.helpers.transformation import Transformation3d


class TransformsOf14(Transforms):
    """From ``/odom`` to ``/base_footprint`` for each odometry sensor, from ``/base_link`` to each camera."""

    def add(self, stream: Any, *, lenient: bool = False) -> None:
        """See `Transforms.add`: the frames of 1.4 do not contain the robot, and several sensors may publish them."""
        super().add(stream, lenient=True)

    def _static(self) -> Iterator[tuple[str, str, Transformation3d]]:
        yield from ()

    def _with_base(self) -> Iterator[Any]:
        return (frames for frames in self._robots.values() if frames.source is not None)

    def _moving(self) -> Iterator[tuple[str, str, Transformation3d]]:
        for frames in self._robots.values():
            for stream in frames.streams:
                if hasattr(stream.component_instance, "lens") and stream.kwargs["pub_tf"]:
                    pose = stream.component_instance.sensor_to_robot_position_3d()
                    yield stream.kwargs["parent_frame_id"], stream.own_frame(), pose
