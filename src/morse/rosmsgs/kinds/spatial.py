"""Poses, velocities, accelerations, forces."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.kinds.turning import quaternion_of
from morse.rosmsgs.parts import (
    ABSENT,
    covariance,
    from_quaternion,
    from_xyz,
    header,
    quaternion,
    xyz,
)
from morse.rosmsgs.table import Inlet, Outlet, TopicTable, topics

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.table import Carrier

_FLOAT = "std_msgs/msg/Float64"
_STICK = ("roll", "pitch", "yaw", "thrust")


class SpatialKinds(TopicTable):
    """The kinds pose, twist, accel, attitude, odometry and wrench."""

    @topics("pose")
    def pose(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """A point if there is no orientation."""
        if not bound.has("orientation"):
            return [Outlet("geometry_msgs/msg/PointStamped", _point, is_detached=True, by_rows=True)]
        return [_spatial(bound, "Pose", pose_message)]

    @topics("twist")
    def twist(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """In the frame of the component."""
        return [_spatial(bound, "Twist", _twist)]

    @topics("accel")
    def accel(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Without gravity, therefore not an IMU message."""
        return [_with_covariance("Accel", _twist)]

    @topics("attitude")
    def attitude(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """An IMU message that marks the missing quantities."""
        return [Outlet("sensor_msgs/msg/Imu", _attitude, frame="own", by_rows=True)]

    @topics("odometry")
    def odometry(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Odometry of the robot, wherever the sensor is mounted; the transform of base_link is derived from it."""
        return [Outlet("nav_msgs/msg/Odometry", stream.odometry, is_of_robot=True, is_detached=True)]

    @topics("wrench")
    def wrench(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Force and torque."""
        return [
            Outlet(
                "geometry_msgs/msg/WrenchStamped",
                lambda m, f: {"header": header(m, f), "wrench": {"force": xyz(m.force), "torque": xyz(m.torque)}},
                by_rows=True,
            )
        ]

    # -- commands ----------------------------------------------------------------------------

    @topics("pose", direction="IN")
    def take_pose(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A goal from rviz or nav2; an orientation has no effect if the actuator does not use it."""
        turns = bound.has("orientation")

        def take(message: DecodedMessage) -> RosMessage:
            pose = message["pose"]
            slots: RosMessage = {"position": from_xyz(pose["position"])}
            return {**slots, "orientation": from_quaternion(pose["orientation"])} if turns else slots

        return [
            Inlet("geometry_msgs/msg/PoseStamped", take, also="goal_pose"),
            *(_number(slot) for slot in ("tolerance", "speed") if bound.has(slot)),
        ]

    @topics("twist", direction="IN")
    def take_twist(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A topic has one type at a time: that of nav2 up to Jazzy, or the newer type; the sender decides.

        A car also takes the angle of its steering.
        """
        plain = Inlet("geometry_msgs/msg/Twist", _from_twist, also="cmd_vel")
        with_stamp = Inlet("geometry_msgs/msg/TwistStamped", lambda m: _from_twist(m["twist"]), also="cmd_vel")
        first, second = (with_stamp, plain) if stream.kwargs["stamped"] else (plain, with_stamp)
        inlets = [first._replace(other=second)]
        if hasattr(bound.component, "turning_speed"):
            kind, name, car = "ackermann_msgs/msg/AckermannDrive", "ackermann_cmd", bound.component
            plain = Inlet(kind, lambda m: _from_car(m, car), name, also=name, or_none=True)
            take = lambda m: _from_car(m["drive"], car)  # noqa: E731 - beside that of the other type
            inlets.append(plain._replace(type=f"{kind}Stamped", take=take, other=plain))
        return inlets

    @topics("attitude", direction="IN")
    def take_attitude(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """An orientation; with thrust roll, pitch, yaw (or its rate) and thrust as four numbers."""
        if bound.has("thrust"):
            return [Inlet("std_msgs/msg/Float32MultiArray", lambda m: _from_stick(m, by_rate=bound.has("rates")))]
        return [
            Inlet("geometry_msgs/msg/QuaternionStamped", lambda m: {"orientation": from_quaternion(m["quaternion"])})
        ]

    @topics("wrench", direction="IN")
    def take_wrench(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """Force and torque."""
        return [
            Inlet(
                "geometry_msgs/msg/WrenchStamped",
                lambda m: {"force": from_xyz(m["wrench"]["force"]), "torque": from_xyz(m["wrench"]["torque"])},
            )
        ]


def _spatial(bound: BoundKind, name: str, content: Callable[[Message], RosMessage]) -> Outlet:
    """A message with a header, and with the covariance if there is one."""
    if bound.has("covariance"):
        return _with_covariance(name, content)
    return Outlet(
        f"geometry_msgs/msg/{name}Stamped",
        lambda m, f: {"header": header(m, f), name.lower(): content(m)},
        is_detached=True,
        by_rows=True,
    )


def _with_covariance(name: str, content: Callable[[Message], RosMessage]) -> Outlet:
    part = name.lower()
    return Outlet(
        f"geometry_msgs/msg/{name}WithCovarianceStamped",
        lambda m, f: {"header": header(m, f), part: {part: content(m), "covariance": covariance(m.covariance)}},
        by_rows=True,
    )


def _point(message: Message, frame: str) -> RosMessage:
    return {"header": header(message, frame), "point": xyz(message.position)}


def _number(slot: str) -> Inlet:
    return Inlet(_FLOAT, lambda message: {slot: message["data"]}, slot)


def pose_message(message: Message) -> RosMessage:
    """``geometry_msgs/Pose``."""
    return {"position": xyz(message.position), "orientation": quaternion(message.orientation)}


def _twist(message: Message) -> RosMessage:
    return {"linear": xyz(message.linear), "angular": xyz(message.angular)}


def _from_twist(message: DecodedMessage) -> RosMessage:
    return {"linear": from_xyz(message["linear"]), "angular": from_xyz(message["angular"])}


def _from_car(drive: DecodedMessage, car: Any) -> RosMessage:
    speed = float(drive["speed"])
    angular = car.turning_speed(speed, float(drive["steering_angle"]))
    return {"linear": [speed, 0.0, 0.0], "angular": [0.0, 0.0, angular]}


def _from_stick(message: DecodedMessage, *, by_rate: bool) -> RosMessage:
    if len(message["data"]) != len(_STICK):
        raise ValueError(f"{len(message['data'])} numbers, expected {', '.join(_STICK)}")
    roll, pitch, yaw, thrust = (float(number) for number in message["data"])
    if not all(map(math.isfinite, (roll, pitch, yaw))):
        raise ValueError("angles have to be finite")
    if by_rate:
        return {"orientation": quaternion_of(roll, pitch, 0.0), "rates": (0.0, 0.0, yaw), "thrust": thrust}
    return {"orientation": quaternion_of(roll, pitch, yaw), "thrust": thrust}


def _attitude(message: Message, frame: str) -> RosMessage:
    return {
        "header": header(message, frame),
        "orientation": quaternion(message.orientation),
        "orientation_covariance": covariance(message.orientation_covariance)
        if message.orientation is not None
        else ABSENT,
        "angular_velocity": xyz(message.rates),
        "angular_velocity_covariance": covariance(message.rates_covariance) if message.rates is not None else ABSENT,
        "linear_acceleration_covariance": ABSENT,
    }
