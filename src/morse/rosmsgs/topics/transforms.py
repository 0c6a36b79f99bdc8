"""The tree of frames: /tf and /tf_static (REP 105: map, odom, base_link, sensors)."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseMiddlewareError
from morse.helpers.geodesy import LocalPlane, angle_against_north
from morse.helpers.transformation import Transformation3d
from morse.rosmsgs.moving import MovingFrame, joints_of, poses_of
from morse.rosmsgs.names import MAP, OF_WORLD
from morse.rosmsgs.parts import OPTICAL_TURN, between, inverse, pose_of, product, quaternion, quaternion_of, time, xyz

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.core.robot import Robot
    from morse.core.values import RosMessage

    _Send = Callable[[RosMessage], object]

    from morse.rosmsgs.component import ComponentMessages
    from morse.rosmsgs.moving import Joint

#: rotations between the frames of a component, as quaternions w, x, y, z: camera images have X right, Y down, Z forward
_FROM_OWN = {"optical": OPTICAL_TURN, "frd": (0.0, 1.0, 0.0, 0.0)}
#: X down, Y left, Z forward, along the axes of the world
_DOWN = (0.7071067811865476, 0.0, 0.7071067811865476, 0.0)
#: north-east-down in axes that point east, north and up
_NED = (0.0, 0.7071067811865476, 0.7071067811865476, 0.0)
_NO_TURN = (1.0, 0.0, 0.0, 0.0)


class RobotFrames:
    """The frames of one robot.

    Attributes:
        odom, base: names of frames.
        source: name of the sensor whose odometry moves the robot in the tree; None: the true pose is used.
        moved: pose of the robot in the frame odom, from the last message of that sensor.
    """

    def __init__(self, robot: Robot, odom: str, base: str) -> None:
        self.robot, self.odom, self.base = robot, odom, base
        self.source: str | None = None
        self.moved = Transformation3d()
        self.streams: list[ComponentMessages] = []
        #: parts that move, and parts that do not
        self.moving: list[Joint] = []
        self.fixed: list[Joint] = []
        #: streams with a frame that keeps the axes of the world, independent of the robot
        self.upright: list[ComponentMessages] = []

    def true_pose(self) -> tuple[Transformation3d, Transformation3d] | None:
        """The initial and the present pose of the robot in the world; None if its odometry moves it in the tree."""
        if self.source is not None:
            return None
        return self.robot.initial_position_3d, Transformation3d(self.robot.bge_object)


class Transforms:
    """All frames of the robots that have streams.

    Args:
        localization: another node publishes the transform from map to odom.
        send, send_static: send a ``tf2_msgs/TFMessage``; the first one may be called in another thread.

    Attributes:
        changed: whether the frames have changed since `publish` was called.
    """

    def __init__(self, localization: bool, send: _Send, send_static: _Send) -> None:
        self._localization, self._send, self._send_static = localization, send, send_static
        self._robots: dict[str, RobotFrames] = {}
        self.changed = False

    def add(self, stream: ComponentMessages, *, lenient: bool = False) -> None:
        """Add the stream of a sensor.

        Args:
            lenient: of several odometry sensors, the first one is used.

        Raises:
            MorseMiddlewareError: the transform of its robot already comes from another sensor.
        """
        robot = stream.robot
        names = stream.names
        frames = self._robots.get(robot.name())
        if frames is None or frames.robot is not robot:
            frames = self._robots[robot.name()] = RobotFrames(robot, names.odom(robot), names.base(robot))
        if stream.gives_transform and not (lenient and frames.source is not None):
            if frames.source is not None:
                raise MorseMiddlewareError(
                    f"{stream.component_name}: tf {frames.odom} → {frames.base} already comes from {frames.source}; "
                    "set tf=False"
                )
            frames.source = stream.component_name
            frames.odom, frames.base = stream.frame_id("start"), stream.child_frame_id()
        frames.streams.append(stream)
        self.changed = True

    def remove(self, stream: ComponentMessages) -> None:
        """Remove a stream."""
        frames = self._robots.get(stream.robot.name())
        if frames is None or stream not in frames.streams:
            return
        frames.streams.remove(stream)
        if frames.source == stream.component_name:
            frames.source = None
        if not frames.streams:
            del self._robots[stream.robot.name()]

    def moved(self, stream: ComponentMessages, pose: Transformation3d) -> None:
        """Set the odometry of a robot."""
        frames = self._robots.get(stream.robot.name())
        if frames is not None and frames.source == stream.component_name:
            frames.moved = pose

    def plain(self) -> list[MovingFrame] | None:
        """Return all frames that move, in the order of the message, as determined by `publish`.

        Returns:
            None if a frame moves that is neither the base of a robot nor a joint between two bodies of the engine, or
            if odometry moves a base.
        """
        bases, parts = [], []
        for frames in self._robots.values():
            streams = frames.streams
            if frames.source is not None or frames.upright:
                return None
            if any(stream.is_carried() or stream.master() is not None for stream in streams):
                return None
            if not all(joint.is_between_bodies() for joint in frames.moving):
                return None
            robot = frames.robot
            bases.append(MovingFrame(frames.odom, frames.base, robot.bge_object, None, robot.initial_position_3d))
            parts += [MovingFrame(one.parent, one.frame, one.part.object, one.against, None) for one in frames.moving]
        return [*bases, *parts]

    def publish(self, stamp: int, *, wanted: bool) -> Callable[[], object] | None:
        """Send the fixed transforms if they have changed, and collect the moving transforms.

        Returns:
            A function that sends the moving transforms, in the thread that calls `moved`; None if nobody wants them.

        Args:
            stamp: simulated time, ns. Time 0 has a special meaning in tf, and is not sent.
            wanted: whether the moving transforms have subscribers.
        """
        if stamp <= 0:
            return None
        if self.changed:
            self.changed = False
            self._put_in_order()
            for frames in self._robots.values():
                joints = joints_of(frames.robot, frames.streams[0].names)
                frames.moving = [joint for joint in joints if not joint.is_fixed]
                frames.fixed = [joint for joint in joints if joint.is_fixed]
                frames.upright = [stream for stream in frames.streams if "down" in stream.frames()]
            self._send_static({"transforms": [transform(stamp, *one) for one in self._static()]})
        if not wanted or not self._robots:
            return None
        bases = [(frames, frames.true_pose()) for frames in self._with_base()]
        return partial(self._send_moving, stamp, bases, list(self._moving()))

    def _put_in_order(self) -> None:
        """Sort the frames as the scene, because robots and streams may have come in another order, after a restart."""
        context = next((frames.robot.context for frames in self._robots.values()), None)
        if context is None:
            return
        ranks = {name: rank for rank, name in enumerate([*context.robots, *context.components])}
        last = len(ranks)
        self._robots = dict(sorted(self._robots.items(), key=lambda item: ranks.get(item[0], last)))
        for frames in self._robots.values():
            frames.streams.sort(key=lambda stream: ranks.get(stream.component_name, last))

    def _with_base(self) -> Iterator[RobotFrames]:
        """The robots whose base is a frame that moves."""
        yield from self._robots.values()

    def _send_moving(
        self,
        stamp: int,
        bases: Sequence[tuple[RobotFrames, tuple[Transformation3d, Transformation3d] | None]],
        others: Sequence[tuple[str, str, Transformation3d]],
    ) -> None:
        messages = []
        for frames, poses in bases:
            pose = frames.moved if poses is None else poses[0].transformation3d_with(poses[1])
            messages.append(transform(stamp, frames.odom, frames.base, pose))
        self._send({"transforms": [*messages, *(transform(stamp, *one) for one in others)]})

    def _static(self) -> Iterator[tuple[str, str, Transformation3d]]:
        frames_of_world = set()
        for frames in self._robots.values():
            if not self._localization:
                yield MAP, frames.odom, frames.robot.initial_position_3d
            for stream in frames.streams:
                if not stream.is_carried():
                    yield frames.base, stream.own_frame(), stream.mounting()
                names = stream.frames()
                for frame, rotation in _FROM_OWN.items():
                    if frame in names and stream.master() is None:
                        yield stream.own_frame(), stream.frame_id(frame), pose_of((0.0, 0.0, 0.0), rotation)
                frames_of_world |= names
            yield from poses_of(frames.fixed)
        properties = next(iter(self._robots.values())).robot.context.scene.properties if self._robots else {}
        # the axes of the world are rotated relative to east and north
        half = -0.5 * angle_against_north(properties)
        east = pose_of((0.0, 0.0, 0.0), (math.cos(half), 0.0, 0.0, math.sin(half)))
        for frame, rotation in (("enu", _NO_TURN), ("ned", _NED)):
            if frame in frames_of_world:
                yield MAP, OF_WORLD[frame], product(east, pose_of((0.0, 0.0, 0.0), rotation))
        if "earth" in frames_of_world:
            earth = Transformation3d()
            earth.set_pose(*LocalPlane.of(properties).pose_of_earth())
            # by REP 105 the earth is the parent of the map
            yield OF_WORLD["earth"], MAP, inverse(earth)
        origin = self._origin_of_grid() if "utm" in frames_of_world else None
        if origin is not None:
            yield MAP, OF_WORLD["utm"], pose_of(origin, _NO_TURN)

    def _origin_of_grid(self) -> tuple[float, float, float] | None:
        """The origin of the frame ``utm`` in the world, m, of the first stream with such coordinates."""
        for stream in (one for frames in self._robots.values() for one in frames.streams if "utm" in one.frames()):
            modifiers: Sequence[Any] = stream.component_instance.output_modifiers
            for modifier in modifiers:
                origin: tuple[float, float, float] | None = modifier.origin()
                if origin is not None:
                    return origin
        return None

    def _moving(self) -> Iterator[tuple[str, str, Transformation3d]]:
        """All frames that move, except the bases of the robots."""
        for frames in self._robots.values():
            for stream in frames.streams:
                if stream.is_carried():
                    yield frames.base, stream.own_frame(), stream.mounting()
                master = stream.master()
                if master is not None:
                    yield frames.base, stream.frame_id("optical"), between(frames.robot.bge_object, master.bge_object)
            for stream in frames.upright:
                body = Transformation3d(frames.robot.bge_object)
                x, y, z = stream.component_instance.bge_object.world_pose()[0]
                yield frames.base, stream.frame_id("down"), body.transformation3d_with(pose_of((x, y, z), _DOWN))
            yield from poses_of(frames.moving)


def transform(stamp: int, parent: str, child: str, pose: Transformation3d) -> RosMessage:
    """``geometry_msgs/TransformStamped`` from whole ns."""
    return {
        "header": {"stamp": time(stamp), "frame_id": parent},
        "child_frame_id": child,
        "transform": {"translation": xyz((pose.x, pose.y, pose.z)), "rotation": quaternion(quaternion_of(pose))},
    }
