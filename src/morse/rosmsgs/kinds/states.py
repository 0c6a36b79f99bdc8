"""Joints, motors, switches, contacts, time, and data of no kind."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.parts import as_json, from_json, header, time, xyz
from morse.rosmsgs.table import Inlet, Outlet, TopicTable, topics
from morse.rosmsgs.trajectories import service_call

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.table import Carrier

_STRING, _BOOL, _FLOATS = "std_msgs/msg/String", "std_msgs/msg/Bool", "std_msgs/msg/Float32MultiArray"
_NUMBERS, _TRAJECTORY = "std_msgs/msg/Float64MultiArray", "trajectory_msgs/msg/JointTrajectory"
_QUANTITIES = ("position", "velocity", "effort")


class StateKinds(TopicTable):
    """The kinds contact, joints, actuators, switch, clock and general."""

    @topics("contact")
    def contact(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Whether there is a contact, the names, and the force."""
        outlets = [Outlet(_BOOL, lambda m, f: {"data": m.touching}, by_rows=True)]
        if bound.has("names"):
            outlets.append(Outlet(_STRING, lambda m, f: {"data": ",".join(m.names or ())}, "names", by_rows=True))
        if bound.has("forces"):
            outlets.append(Outlet("geometry_msgs/msg/WrenchStamped", _total_force, "wrench", frame="world"))
        return outlets

    @topics("joints")
    def joints(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """All joints of the component."""
        return [Outlet("sensor_msgs/msg/JointState", _joints, by_rows=True)]

    @topics("actuators")
    def actuators(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """One number for each motor."""
        return [Outlet(_FLOATS, lambda m, f: {"data": m.values}, by_rows=True)]

    @topics("switch")
    def switch(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """On or off, or one of several states."""
        if bound.has("choice"):
            return [Outlet(_STRING, lambda m, f: {"data": m.choice})]
        return [Outlet(_BOOL, lambda m, f: {"data": m.on})]

    @topics("clock")
    def clock_sensor(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """No topic: the time of the simulation is published once, on /clock."""
        return []

    @topics("general")
    def general(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """All fields as JSON."""
        return [Outlet(_STRING, lambda m, f: {"data": as_json(dict(m.fields))})]

    # -- commands ----------------------------------------------------------------------------

    @topics("joints", direction="IN")
    def take_joints(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """A subset of the joints is allowed; the others keep their commands.

        The other topics are those of the controllers of ros2_control: ``commands`` of the forward command controllers,
        and ``joint_trajectory`` of the joint trajectory controller.
        """
        return [
            Inlet("sensor_msgs/msg/JointState", lambda m: _from_joints(m, bound)),
            Inlet(_NUMBERS, lambda m: _from_numbers(m["data"], bound), "commands", or_none=True),
            Inlet(
                _TRAJECTORY,
                lambda m: _from_point(m, bound),
                "joint_trajectory",
                or_none=True,
                call=lambda m: service_call(m, bound),
            ),
        ]

    @topics("actuators", direction="IN")
    def take_actuators(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """One number for each motor."""
        return [Inlet(_FLOATS, lambda m: {"values": m["data"]})]

    @topics("switch", direction="IN")
    def take_switch(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """On or off, or one of several states."""
        if bound.has("choice"):
            return [Inlet(_STRING, lambda m: {"choice": m["data"]})]
        return [Inlet(_BOOL, lambda m: {"on": m["data"]})]

    @topics("general", direction="IN")
    def take_general(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """Fields as JSON."""
        return [Inlet(_STRING, _from_text)]


def clock(stamp: int) -> RosMessage:
    """``rosgraph_msgs/Clock`` from whole ns."""
    return {"clock": time(stamp)}


def _total_force(message: Message, frame: str) -> RosMessage | None:
    if message.forces is None:
        return None
    return {"header": header(message, frame), "wrench": {"force": xyz(np.sum(message.forces, axis=0))}}


def _joints(message: Message, frame: str) -> RosMessage:
    quantities = {name: getattr(message, name) for name in _QUANTITIES}
    return {
        "header": header(message, ""),
        "name": list(message.names),
        **{name: () if values is None else values for name, values in quantities.items()},
    }


def joined_joints(messages: Sequence[Message]) -> tuple[list[str], dict[str, list[float]]]:
    """Return the names of the joints in several messages, and of the quantities those that all messages have."""
    names = [name for message in messages for name in message.names] if all(m.names for m in messages) else []
    quantities: dict[str, list[float]] = {}
    for name in _QUANTITIES:
        parts = [[] if (values := getattr(m, name)) is None else list(values) for m in messages]
        quantities[name] = [value for part in parts for value in part] if all(parts) else []
    return names, quantities


def _from_joints(message: DecodedMessage, bound: BoundKind) -> RosMessage:
    present = bound.gather()
    names = list(present.names)
    slots: DecodedMessage = {}
    for joint in message["name"]:
        if joint not in names:
            raise ValueError(f"there is no joint {joint!r}; known: {', '.join(names)}")
    for quantity in _QUANTITIES:
        numbers = message[quantity]
        if not len(numbers):
            continue
        is_there = bound.has(quantity)
        values = np.array(getattr(present, quantity), dtype=np.float64) if is_there else np.full(len(names), math.nan)
        joints = message["name"]
        if len(numbers) != len(joints):
            # topic_based_ros2_control sends each joint the quantities that its motor controls, and no others
            joints = [joint for joint in joints if not math.isnan(values[names.index(joint)])]
        if len(numbers) != len(joints):
            raise ValueError(f"{len(numbers)} numbers of '{quantity}' for {len(message['name'])} names")
        for joint, value in zip(joints, numbers, strict=True):
            if not math.isnan(value):  # a controller that is not active says nothing
                values[names.index(joint)] = value
        if is_there:
            slots[quantity] = values
    return slots


def _from_numbers(numbers: Any, bound: BoundKind) -> RosMessage:
    """Commands of the quantity that the motors control, in the order of the joints."""
    present = bound.gather()
    names, quantities = list(present.names), [quantity for quantity in _QUANTITIES if bound.has(quantity)]
    if len(numbers) != len(names):
        raise ValueError(f"{len(numbers)} numbers for {len(names)} joints: {', '.join(names)}")
    columns = {quantity: np.asarray(getattr(present, quantity), dtype=np.float64) for quantity in quantities}
    # a quantity is NaN for the joints whose motors control another one
    return {quantity: np.where(np.isnan(column), column, numbers) for quantity, column in columns.items()}


def _from_point(message: DecodedMessage, bound: BoundKind) -> RosMessage:
    point = message["points"][0]
    quantities = {"position": point["positions"], "velocity": point["velocities"], "effort": point["effort"]}
    return _from_joints({"name": message["joint_names"], **quantities}, bound)


def _from_text(message: DecodedMessage) -> RosMessage:
    fields = from_json(message["data"])
    if not isinstance(fields, dict):
        raise ValueError(f"a JSON object of fields is expected, not {type(fields).__name__}")
    return fields
