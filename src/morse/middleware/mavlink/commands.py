"""Commands for actuators."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from morse.core.kinds.binding import fields_of
from morse.core.kinds.turning import quaternion_of
from morse.core.mapping import maps
from morse.mathutils.rotations import both_eulers, rotation_from_quaternion

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.middleware.mavlink.stream import MavlinkStream

#: frames of SET_POSITION_TARGET_LOCAL_NED: the world; the vehicle, with two names
_LOCAL_NED, _BODY = 1, (8, 12)
#: bits of type_mask: fields to ignore
_NO_POSITION, _NO_VELOCITY, _NO_YAW, _NO_YAW_RATE = 0b111, 0b111000, 1 << 10, 1 << 11
#: frames of SET_POSITION_TARGET_GLOBAL_INT: altitudes above the sea
_GLOBAL = (0, 5)
#: the same for SET_ATTITUDE_TARGET
_NO_BODY_YAW_RATE, _NO_THRUST, _NO_ATTITUDE = 1 << 2, 1 << 6, 1 << 7
#: m: as in MORSE 1.4
_TOLERANCE = 0.5

#: messages that contain commands, by name
COMMANDS = (
    "SET_ATTITUDE_TARGET",
    "SET_POSITION_TARGET_LOCAL_NED",
    "SET_POSITION_TARGET_GLOBAL_INT",
    "HIL_ACTUATOR_CONTROLS",
    "GIMBAL_MANAGER_SET_PITCHYAW",
    "NAMED_VALUE_FLOAT",
)


class CommandKinds:
    """The part of the stream manager for commands; each method returns slots, or None."""

    @maps("attitude", direction="IN")
    def take_attitude(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """SET_ATTITUDE_TARGET."""
        if message.get_type() != "SET_ATTITUDE_TARGET":
            return None
        slots: dict[str, Any] = {}
        by_rate = bound.has("rates")
        if not message.type_mask & _NO_ATTITUDE:
            turned = stream.axes_of(bound.frame).quaternion(_unit(message.q))
            if by_rate:
                roll, pitch, _ = both_eulers(rotation_from_quaternion(*turned), "XYZ")[0]
                turned = quaternion_of(roll, pitch, 0.0)
            slots["orientation"] = turned
        if by_rate and not message.type_mask & _NO_BODY_YAW_RATE:
            slots["rates"] = stream.axes_of(bound.frame).body((0.0, 0.0, message.body_yaw_rate))
        if bound.has("thrust") and not message.type_mask & _NO_THRUST:
            slots["thrust"] = message.thrust
        return slots

    @maps("pose", direction="IN")
    def take_pose(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """SET_POSITION_TARGET_LOCAL_NED in the world."""
        if message.get_type() != "SET_POSITION_TARGET_LOCAL_NED":
            return None
        if message.coordinate_frame != _LOCAL_NED or message.type_mask & _NO_POSITION:
            if message.coordinate_frame not in _BODY:
                stream.complain("target", "a target without a position in MAV_FRAME_LOCAL_NED has no effect")
            return None
        axes = stream.axes_of(bound.frame)
        slots: dict[str, Any] = {"position": axes.vector((message.x, message.y, message.z))}
        if bound.has("orientation") and not message.type_mask & _NO_YAW:
            slots["orientation"] = quaternion_of(0.0, 0.0, axes.heading(_finite(message.yaw)))
        if bound.has("tolerance"):
            slots["tolerance"] = _TOLERANCE
        return slots

    @maps("twist", direction="IN")
    def take_twist(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """SET_POSITION_TARGET_LOCAL_NED with velocities in the frame of the vehicle."""
        if message.get_type() != "SET_POSITION_TARGET_LOCAL_NED":
            return None
        if message.coordinate_frame not in _BODY or message.type_mask & _NO_VELOCITY == _NO_VELOCITY:
            if message.type_mask & _NO_POSITION == _NO_POSITION:
                stream.complain("target", "velocities are only supported in MAV_FRAME_BODY_NED or MAV_FRAME_BODY_FRD")
            return None
        axes = stream.axes_of("world")
        rate = 0.0 if message.type_mask & _NO_YAW_RATE else message.yaw_rate
        return {
            "linear": axes.body((message.vx, message.vy, message.vz)),
            "angular": axes.body((0.0, 0.0, rate)),
        }

    @maps("actuators", direction="IN")
    def take_actuators(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """HIL_ACTUATOR_CONTROLS."""
        if message.get_type() != "HIL_ACTUATOR_CONTROLS":
            return None
        (name, field) = next((n, f) for n, f in fields_of(stream.component_instance).items() if n not in bound.rest)
        full = stream.kwargs["full"] or field.high or 1.0
        count = len(stream.data[name])
        return {"values": [value * full for value in message.controls[:count]]}

    @maps("fix", direction="IN")
    def take_fix(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """SET_POSITION_TARGET_GLOBAL_INT; without a geoid, altitudes are above the ellipsoid."""
        if message.get_type() != "SET_POSITION_TARGET_GLOBAL_INT" or message.type_mask & _NO_POSITION:
            return None
        if message.coordinate_frame not in _GLOBAL:
            stream.complain("target", "a target without a position in MAV_FRAME_GLOBAL has no effect")
            return None
        place = {"latitude": message.lat_int * 1e-7, "longitude": message.lon_int * 1e-7, "altitude": message.alt}
        return {name: _finite(value) for name, value in place.items()}

    @maps("joints", direction="IN")
    def take_joints(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """GIMBAL_MANAGER_SET_PITCHYAW, for pan-tilt units; NaN keeps an angle."""
        present = bound.gather()
        if message.get_type() != "GIMBAL_MANAGER_SET_PITCHYAW" or tuple(present.names) != ("pan", "tilt"):
            return None
        pan, tilt = (float(angle) for angle in present.position)
        given = -message.yaw, -message.pitch
        angles = [old if math.isnan(new) else _finite(new) for old, new in zip((pan, tilt), given, strict=True)]
        return {"position": angles}

    @maps("general", direction="IN")
    def take_general(self, stream: MavlinkStream, bound: BoundKind, message: Any) -> dict[str, Any] | None:
        """NAMED_VALUE_FLOAT with the name of a field."""
        if message.get_type() != "NAMED_VALUE_FLOAT" or bound.kind.name != "general":
            return None
        name = next((name for name in stream.data if name[:10] == message.name), None)
        return None if name is None else {name: message.value}


def _finite(number: float) -> float:
    if not math.isfinite(number):
        raise ValueError("a number that is not finite")
    return float(number)


def _unit(q: Any) -> list[float]:
    length = math.hypot(*q)
    if not math.isfinite(length) or length < 1e-9:
        raise ValueError("a quaternion without length")
    return [number / length for number in q]
