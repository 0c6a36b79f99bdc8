"""Sends data streams as MAVLink messages."""

from __future__ import annotations

import logging
import math
import time
from collections import Counter
from itertools import zip_longest
from typing import TYPE_CHECKING

import msgspec

from morse.core.clients.budgets import TimeShare
from morse.core.clients.complaints import Complaints
from morse.core.datastream import DatastreamManager
from morse.core.exceptions import MorseMiddlewareError
from morse.core.kinds.binding import fields_of
from morse.core.kinds.turning import quaternion_of
from morse.core.mapping import maps
from morse.core.state import StateError
from morse.helpers.geodesy import angle_against_north
from morse.mathutils.rotations import both_eulers, rotation_from_quaternion
from morse.plugins.mavlink import MANAGER_OPTIONS
from morse.plugins.mavlink.autopilot.pilot import MESSAGES, Autopilot
from morse.plugins.mavlink.autopilot.saved import checked
from morse.plugins.mavlink.autopilot.steering import type_of
from morse.plugins.mavlink.axes import Axes, Place
from morse.plugins.mavlink.framing import Framer
from morse.plugins.mavlink.links import open_link
from morse.plugins.mavlink.loop import Loop
from morse.plugins.mavlink.telemetry import Telemetry
from morse.plugins.mavlink.vehicle import Vehicle
from morse.system.extras import install

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.core.context import Context
    from morse.core.interfaces import Carrier
    from morse.core.kinds import BoundKind
    from morse.core.object import Object
    from morse.core.values import Options
    from morse.plugins.mavlink.framing import Frame, MavlinkMessage
    from morse.plugins.mavlink.links import Link
    from morse.plugins.mavlink.vehicle import MavlinkStream
    from morse.scene import StreamDeclaration

    #: values of slots of a kind
    _Slots = dict[str, object]


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
    def take_attitude(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> _Slots | None:
        """SET_ATTITUDE_TARGET."""
        if message.get_type() != "SET_ATTITUDE_TARGET":
            return None
        slots: _Slots = {}
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
    def take_actuators(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> _Slots | None:
        """HIL_ACTUATOR_CONTROLS."""
        if message.get_type() != "HIL_ACTUATOR_CONTROLS":
            return None
        (name, field) = next((n, f) for n, f in fields_of(stream.component_instance).items() if n not in bound.rest)
        full = stream.kwargs["full"] or field.high or 1.0
        count = len(stream.data[name])
        # a motor for which there is no control stops
        return {"values": [0.0 if math.isnan(value) else value * full for value in message.controls[:count]]}

    @maps("fix", direction="IN")
    def take_fix(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> _Slots | None:
        """SET_POSITION_TARGET_GLOBAL_INT; without a geoid, altitudes are above the ellipsoid."""
        if message.get_type() != "SET_POSITION_TARGET_GLOBAL_INT" or message.type_mask & _NO_POSITION:
            return None
        if message.coordinate_frame not in _GLOBAL:
            stream.complain("target", "a target without a position in MAV_FRAME_GLOBAL has no effect")
            return None
        place = {"latitude": message.lat_int * 1e-7, "longitude": message.lon_int * 1e-7, "altitude": message.alt}
        return {name: _finite(value) for name, value in place.items()}

    @maps("general", direction="IN")
    def take_general(self, stream: MavlinkStream, bound: BoundKind, message: MavlinkMessage) -> _Slots | None:
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


#: limits for one sender in one tick: bytes, and candidates for messages; ten times what an autopilot sends at 1 kHz
_MOST_BYTES, _MOST_FRAMES = 1 << 14, 256
#: all senders of a link together may use as much as this number of senders, and each of them this part in any case
_SENDERS, _PART = 2, 1 / 32


class Intake:
    """The bytes and messages that one tick takes from a link.

    Attributes:
        lost: whether bytes or messages were dropped.
    """

    def __init__(self) -> None:
        self.lost = False
        self._bytes: Counter[object] = Counter()
        self._frames: Counter[object] = Counter()

    def frames(self, sender: object, framer: Framer, data: bytes) -> Iterator[Frame]:
        """The candidates for messages that the tick takes.

        Args:
            sender: identifies the sender.
            framer: has the earlier bytes of the sender.
            data: newly received bytes.
        """
        room = _room(self._bytes, sender, _MOST_BYTES)
        self._bytes[sender] += min(len(data), room)
        self.lost |= len(data) > room
        frames = framer.feed(data[:room])
        count = min(len(frames), _room(self._frames, sender, _MOST_FRAMES))
        self._frames[sender] += count
        self.lost |= len(frames) > count
        yield from frames[:count]


def _room(counts: Counter[object], sender: object, most: int) -> int:
    free = max(_SENDERS * most - counts.total(), int(most * _PART) - counts[sender])
    return max(0, min(most - counts[sender], free))


logger = logging.getLogger(__name__)

#: angle of the X axis of the world from east, counter-clockwise, rad
_X_AXIS = {"enu": 0.0, "nwu": math.pi / 2.0}
_EVERYBODY = 0
#: wall-clock seconds: how long an autopilot in lockstep may take for a tick, and how often its answer is looked for
_PATIENCE, _LOOK = 1.0, 1e-4
#: maximum number of senders with an incomplete message on a link
_MOST_FRAMERS = 16


class MavlinkDatastreamManager(Telemetry, CommandKinds, DatastreamManager):
    """Each robot is a MAVLink system with an autopilot, unless an autopilot is in the loop.

    Options of ``env.configure_stream_manager('mavlink', ...)`` are in `morse.plugins.mavlink`.

    Attributes:
        axes: conversions of the frames ``world``, ``nwu``, ``enu`` and ``ned``.
    """

    classpath = "morse.middleware.mavlink_datastream.MavlinkDatastreamManager"
    manager_options = MANAGER_OPTIONS

    def __init__(self, options: Options, context: Context) -> None:
        super().__init__(options, context)
        try:
            from pymavlink.dialects.v20 import common
        except ImportError:
            raise MorseMiddlewareError(
                f"mavlink: pymavlink is not installed; to install it: {install('mavlink')}"
            ) from None
        self._dialect = common
        self.axes = {name: Axes(name) for name in ("nwu", "enu", "ned")}
        self.axes["world"] = self.axes[self.options["world"]]
        self._message_ids = {getattr(common, f"MAVLINK_MSG_ID_{name}") for name in (*COMMANDS, *MESSAGES, "HEARTBEAT")}
        self._links: dict[str, Link] = {}
        self._framers: dict[str, dict[object, Framer]] = {}
        self._vehicles: dict[tuple[str, str], Vehicle] = {}
        self._parser = common.MAVLink(None)
        self._share = TimeShare(context.time_shares)
        self._complaints = Complaints(logger)
        self._is_changed = True

    # -- streams -----------------------------------------------------------------------------

    def make_stream(self, component: Object, declaration: StreamDeclaration) -> object:
        """See `DatastreamManager.make_stream`."""
        stream = super().make_stream(component, declaration)
        robot = component.robot_parent or component
        device = stream.kwargs["device"] or self.options["device"]
        stream.axes, stream.other_north = self.axes, self._other_north()
        stream.vehicle = self._vehicle(robot, device, stream.kwargs["system_id"])
        return stream

    def _vehicle(self, body: Object | Carrier, device: str, wanted: int | None) -> Vehicle:
        robot = body.name()
        present = self._vehicles.get((robot, device))
        if present is not None:
            if wanted not in (None, present.system):
                raise MorseMiddlewareError(f"mavlink: {robot} has the system_id {present.system} already, not {wanted}")
            present.robot = body
            return present
        if device not in self._links:
            self._links[device] = open_link(device)
            self._framers[device] = {}
        owners = {one.system: name for (name, at), one in self._vehicles.items() if at == device}
        of_robot = next((one.system for (name, _), one in self._vehicles.items() if name == robot), None)
        system = wanted or of_robot or next(number for number in range(1, 257) if number not in owners)
        if system > 255 or system in owners:
            raise MorseMiddlewareError(
                f"mavlink: the system_id {system} of {robot} is that of {owners.get(system, 'nobody')}; "
                "a device has room for 255 robots with different ones"
            )
        options = self.options
        vehicle = Vehicle(self._dialect, system, self._links[device], options["hil"])
        vehicle.robot, vehicle.kind = body, options["vehicle"]
        x, y, z = (float(v) for v in body.bge_object.world_pose()[0])
        world = options["world"]
        place = Place(self.axes[world], (x, y, z), self.context.scene.properties, _X_AXIS[world])
        if options["hil"]:
            vehicle.loop = Loop(vehicle, place)
        else:
            vehicle.pilot = Autopilot(vehicle, place, self.context)
        self._vehicles[robot, device] = vehicle
        return vehicle

    def opened(self, stream: MavlinkStream) -> None:
        """Register an actuator for the messages to its robot."""
        if stream.direction == "IN":
            stream.vehicle.streams.append(stream)
        self._is_changed = True

    def closed(self, stream: MavlinkStream) -> None:
        """Unregister an actuator."""
        if stream in stream.vehicle.streams:
            stream.vehicle.streams.remove(stream)
        stream.vehicle.measured.clear()
        self._is_changed = True
        vehicles = {id(one.vehicle) for streams in self.streams.values() for one in streams}
        self._vehicles = {key: one for key, one in self._vehicles.items() if id(one) in vehicles}

    def _other_north(self) -> str:
        """In what the direction of north in the scene differs from that of the links; empty if it does not."""
        angle = angle_against_north(self.context.scene.properties)
        world = self.options["world"]
        if abs(math.remainder(angle - _X_AXIS[world], math.tau)) < 1e-6:
            return ""
        other = next((name for name, x in _X_AXIS.items() if abs(math.remainder(angle - x, math.tau)) < 1e-6), None)
        mend = (
            f"say env.configure_stream_manager('mavlink', world='{other}')"
            if other is not None
            else f"say env.properties(angle_against_north={_X_AXIS[world]:.6g})"
        )
        return f"finds north at another place than the link with world='{world}'; {mend}"

    # -- the tick ----------------------------------------------------------------------------

    def action(self) -> None:
        """Read received messages at the beginning of a tick, within its share of the time; the autopilots steer."""
        if self._is_changed:
            self._is_changed = False
            self._look_at_robots()
        self._read()
        self._keep_step()
        stamp = self.context.clock.stamp()
        for vehicle in self._vehicles.values():
            if vehicle.pilot is not None:
                vehicle.pilot.steer(stamp)

    def _keep_step(self) -> None:
        """Wait for the answers of autopilots in the loop to the measurements of the last tick."""
        loops = [one.loop for one in self._vehicles.values() if one.loop is not None and one.loop.is_waiting]
        if not loops:
            return
        end = time.monotonic() + _PATIENCE
        while late_loops := [loop for loop in loops if loop.is_waiting]:
            if time.monotonic() > end:
                for loop in late_loops:
                    loop.lose_step()
                return
            time.sleep(_LOOK)
            self._read()

    def _read(self) -> None:
        is_paced = self.context.paced()
        has_time = self._share.begin() or not is_paced
        for device, link in self._links.items():
            framers, intake = self._framers[device], Intake()
            messages: dict[object, list[tuple[object, bytes]]] = {}
            for sender, data in link.receive():
                if sender not in framers:
                    self._greet(device)
                # the one that has not been used for longest comes first, and is forgotten first
                framer = framers.pop(sender) if sender in framers else Framer(self._message_ids)
                framers[sender] = framer
                if len(framers) > _MOST_FRAMERS:
                    del framers[next(iter(framers))]
                frames = [(sender, frame.data) for frame in intake.frames(sender, framer, data)]
                messages.setdefault(sender, []).extend(frames)
            # in turns, so that the flood of one sender does not take the time of another; each of them has one
            for turn in zip_longest(*messages.values()):
                for sender, data in filter(None, turn):
                    if self._arrived(device, data):
                        link.understood(sender)
                has_time = not (self._share.end_request() and is_paced) and has_time
                if not has_time:
                    intake.lost |= any(len(frames) > 1 for frames in messages.values())
                    break
            if intake.lost:
                self._complaints.warn(device, f"mavlink: {device} receives more than a tick can process: some is lost")

    def drain(self) -> None:
        """See `DatastreamManager.drain`."""
        self.action()

    def _greet(self, device: str) -> None:
        """Send heartbeats in this tick: a new peer need not wait for them."""
        for (_, at), vehicle in self._vehicles.items():
            if at == device:
                vehicle.greet()

    def _look_at_robots(self) -> None:
        """Find out what steers each vehicle, and what it is."""
        for vehicle in self._vehicles.values():
            components = [one for one in self.context.components.values() if one.robot_parent is vehicle.robot]
            vehicle.kind = self.options["vehicle"] or type_of(vehicle.robot, components)
            if vehicle.pilot is not None:
                vehicle.pilot.look_at(components)

    def _arrived(self, device: str, data: bytes) -> bool:
        """Pass a candidate for a message on; False if it is none."""
        try:
            message = self._parser.decode(bytearray(data))
        except Exception:  # pymavlink raises several errors for an invalid message, which is only noise
            return False
        target = getattr(message, "target_system", getattr(message, "target", _EVERYBODY))
        for (_, at), vehicle in self._vehicles.items():
            if at == device and target in (_EVERYBODY, vehicle.system):
                if vehicle.pilot is not None and vehicle.pilot.take(message):
                    continue
                if vehicle.loop is not None:
                    vehicle.loop.take(message)
                for stream in vehicle.streams if message.get_type() in COMMANDS else ():
                    stream.receive(message)
        return True

    def get_state(self) -> object:
        """See `DatastreamManager.get_state`: the autopilots by robot and device."""
        pilots = {key: vehicle.pilot for key, vehicle in self._vehicles.items() if vehicle.pilot is not None}
        return [[*key, pilot.get_state()] for key, pilot in pilots.items()] or None

    def set_state(self, state: object) -> None:
        """See `DatastreamManager.set_state`."""
        try:
            entries = msgspec.convert(state, list[tuple[str, str, object]])
        except msgspec.ValidationError as error:
            raise StateError(f"mavlink: the saved state of the autopilots is damaged: {error}") from None
        for *_, data in entries:
            checked(data)
        states = {(robot, device): data for robot, device, data in entries}
        if self._is_changed:
            self._is_changed = False
            self._look_at_robots()
        for key, vehicle in self._vehicles.items():
            if vehicle.pilot is not None and key in states:
                vehicle.pilot.set_state(states[key])

    def flush(self) -> None:
        """The end of a tick: send the messages of each robot."""
        stamp = self.context.clock.stamp()
        for vehicle in self._vehicles.values():
            vehicle.tick(stamp)

    def finalize(self) -> None:
        """Close the links."""
        super().finalize()
        for link in self._links.values():
            link.close()
        self._links.clear()
