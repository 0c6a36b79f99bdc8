"""The message kinds of facilities, and their topics with the messages of Open-RMF.

The types are those of the packages rmf_door_msgs and rmf_lift_msgs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.kinds import Kind, Slot
from morse.rosmsgs.parts import header
from morse.rosmsgs.table import Inlet, Outlet, RosExtension, TopicTable, topics

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.table import Carrier


def _kind(name: str, doc: str, *slots: Slot, sent: bool) -> Kind:
    return Kind(name, {slot.name: slot for slot in slots}, sent, not sent, 1, doc)


KINDS = (
    _kind(
        "door_state",
        "State of a door.",
        Slot("door_name", (), "str"),
        Slot("current_mode", (), "int", doc="0 closed, 1 moving, 2 open"),
        sent=True,
    ),
    _kind(
        "door_request",
        "Opens or closes a door.",
        Slot("door_name", (), "str", doc="empty for the door itself"),
        Slot("requested_mode", (), "int", doc="0 closed, 2 open"),
        sent=False,
    ),
    _kind(
        "lift_state",
        "State of a lift.",
        Slot("lift_name", (), "str"),
        Slot("available_floors", (None,), "object", doc="names of the floors"),
        Slot("current_floor", (), "str"),
        Slot("destination_floor", (), "str"),
        Slot("door_state", (), "int", doc="0 closed, 1 moving, 2 open"),
        Slot("motion_state", (), "int", doc="0 stopped, 1 up, 2 down"),
        sent=True,
    ),
    _kind(
        "lift_request",
        "Calls a lift to a floor.",
        Slot("lift_name", (), "str", doc="empty for the lift itself"),
        Slot("session_id", (), "str"),
        Slot("request_type", (), "int", doc="0 ends the session, 1 of a robot, 2 of a person"),
        Slot("destination_floor", (), "str"),
        Slot("door_state", (), "int", doc="0 closed, 2 open"),
        sent=False,
    ),
)

_MESSAGES = """
rmf_door_msgs/DoorMode: uint32 value
rmf_door_msgs/DoorState: builtin_interfaces/Time door_time, string door_name, rmf_door_msgs/DoorMode current_mode
rmf_door_msgs/DoorRequest: builtin_interfaces/Time request_time, string requester_id, string door_name,
    rmf_door_msgs/DoorMode requested_mode
rmf_lift_msgs/LiftState: builtin_interfaces/Time lift_time, string lift_name, string[] available_floors,
    string current_floor, string destination_floor, uint8 door_state, uint8 motion_state, uint8[] available_modes,
    uint8 current_mode, string session_id
rmf_lift_msgs/LiftRequest: string lift_name, builtin_interfaces/Time request_time, string session_id,
    uint8 request_type, string destination_floor, uint8 door_state
"""

#: the mode of a lift that robots may use
_AGV = 2


class FacilityTopics(TopicTable):
    """The topics of doors and lifts."""

    @topics("door_state")
    def door_state(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """State of a door."""
        return [Outlet("rmf_door_msgs/msg/DoorState", _door_state)]

    @topics("lift_state")
    def lift_state(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """State of a lift."""
        return [Outlet("rmf_lift_msgs/msg/LiftState", _lift_state)]

    @topics("door_request", direction="IN")
    def door_request(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """Requests to a door."""
        return [Inlet("rmf_door_msgs/msg/DoorRequest", _from_door_request)]

    @topics("lift_request", direction="IN")
    def lift_request(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """Requests to a lift."""
        return [Inlet("rmf_lift_msgs/msg/LiftRequest", _from_lift_request)]


def _door_state(message: Message, frame: str) -> RosMessage:
    return {
        "door_time": header(message, frame)["stamp"],
        "door_name": message.door_name,
        "current_mode": {"value": int(message.current_mode)},
    }


def _lift_state(message: Message, frame: str) -> RosMessage:
    return {
        "lift_time": header(message, frame)["stamp"],
        "lift_name": message.lift_name,
        "available_floors": list(message.available_floors),
        "current_floor": message.current_floor,
        "destination_floor": message.destination_floor,
        "door_state": int(message.door_state),
        "motion_state": int(message.motion_state),
        "available_modes": [_AGV],
        "current_mode": _AGV,
    }


def _from_door_request(m: DecodedMessage) -> DecodedMessage:
    return {"door_name": m["door_name"], "requested_mode": m["requested_mode"]["value"]}


def _from_lift_request(m: DecodedMessage) -> DecodedMessage:
    names = ("lift_name", "session_id", "request_type", "destination_floor", "door_state")
    return {name: m[name] for name in names}


MESSAGES = RosExtension(FacilityTopics(), _MESSAGES)
