"""Commands for actuators."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.kinds.binding import fields_of
from morse.core.kinds.turning import quaternion_of
from morse.core.mapping import maps
from morse.mathutils.rotations import both_eulers, rotation_from_quaternion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.kinds import BoundKind
    from morse.core.values import Fields
    from morse.plugins.mavlink.messages import MavlinkMessage
    from morse.plugins.mavlink.stream import MavlinkStream

#: bits of type_mask: fields to ignore
_NO_POSITION = 0b111
#: frames of SET_POSITION_TARGET_GLOBAL_INT: altitudes above the sea
_GLOBAL = (0, 5)
#: the same for SET_ATTITUDE_TARGET
_NO_BODY_YAW_RATE, _NO_THRUST, _NO_ATTITUDE = 1 << 2, 1 << 6, 1 << 7

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
    def take_attitude(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> Fields | None:
        """SET_ATTITUDE_TARGET."""
        if message.get_type() != "SET_ATTITUDE_TARGET":
            return None
        slots: Fields = {}
        by_rate = bound.has("rates")
        if not message.type_mask & _NO_ATTITUDE:
            quaternion = stream.axes_of(bound.frame).quaternion(_unit(message.q))
            if by_rate:
                roll, pitch, _ = both_eulers(rotation_from_quaternion(*quaternion), "XYZ")[0]
                quaternion = quaternion_of(roll, pitch, 0.0)
            slots["orientation"] = quaternion
        if by_rate and not message.type_mask & _NO_BODY_YAW_RATE:
            slots["rates"] = stream.axes_of(bound.frame).body((0.0, 0.0, message.body_yaw_rate))
        if bound.has("thrust") and not message.type_mask & _NO_THRUST:
            slots["thrust"] = message.thrust
        return slots

    @maps("actuators", direction="IN")
    def take_actuators(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> Fields | None:
        """HIL_ACTUATOR_CONTROLS."""
        if message.get_type() != "HIL_ACTUATOR_CONTROLS":
            return None
        (name, field) = next((n, f) for n, f in fields_of(stream.component_instance).items() if n not in bound.rest)
        full = stream.kwargs["full"] or field.high or 1.0
        count = len(stream.data[name])
        # a motor for which there is no control stops
        return {"values": [0.0 if math.isnan(value) else value * full for value in message.controls[:count]]}

    @maps("fix", direction="IN")
    def take_fix(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> Fields | None:
        """SET_POSITION_TARGET_GLOBAL_INT; without a geoid, altitudes are above the ellipsoid."""
        if message.get_type() != "SET_POSITION_TARGET_GLOBAL_INT" or message.type_mask & _NO_POSITION:
            return None
        if message.coordinate_frame not in _GLOBAL:
            stream.complain("target", "a target without a position in MAV_FRAME_GLOBAL has no effect")
            return None
        place = {"latitude": message.lat_int * 1e-7, "longitude": message.lon_int * 1e-7, "altitude": message.alt}
        return {name: _finite(value) for name, value in place.items()}

    @maps("general", direction="IN")
    def take_general(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> Fields | None:
        """NAMED_VALUE_FLOAT with the name of a field."""
        if message.get_type() != "NAMED_VALUE_FLOAT" or bound.kind.name != "general":
            return None
        name = next((name for name in stream.data if name[:10] == message.name), None)
        return None if name is None else {name: message.value}


def _finite(number: float) -> float:
    if not math.isfinite(number):
        raise ValueError("a number that is not finite")
    return float(number)


def _unit(q: Sequence[float]) -> list[float]:
    length = math.hypot(*q)
    if not math.isfinite(length) or length < 1e-9:
        raise ValueError("a quaternion without length")
    return [number / length for number in q]
