"""A robot as a MAVLink system with an id on one link."""

from __future__ import annotations

import logging
import struct
from typing import TYPE_CHECKING, Any, Protocol

from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseMiddlewareError
from morse.core.streams.kind_stream import KindStream
from morse.plugins.mavlink import STREAM_OPTIONS
from morse.plugins.mavlink.loop import BITS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from types import ModuleType

    from morse.core.interfaces import Carrier
    from morse.core.kinds import BoundKind
    from morse.core.object import Object
    from morse.plugins.mavlink.axes import Axes, Place
    from morse.plugins.mavlink.framing import MavlinkMessage
    from morse.plugins.mavlink.links import Link
    from morse.plugins.mavlink.loop import Loop


#: frames of positions without a MAVLink message
_ELSEWHERE = ("utm", "earth", "geocentric")


class MavlinkStream(KindStream):
    """Sends the messages of a component, or passes the messages for its vehicle to the component.

    Attributes:
        vehicle: the vehicle of the robot; set before `initialize`.
        axes: conversions of the frames ``world``, ``nwu``, ``enu`` and ``ned``; set before `initialize`.
        other_north: why components that find north do not fit to the link, for messages; empty if they do.
    """

    options = STREAM_OPTIONS
    vehicle: Vehicle
    axes: Mapping[str, Axes]
    other_north: str

    def initialize(self) -> None:
        """Determine the message kinds of the component.

        Raises:
            MorseMiddlewareError: MAVLink has no such coordinates, or the link has another direction of north.
        """
        super().initialize()
        for bound in self.kinds:
            if bound.frame in _ELSEWHERE:
                raise MorseMiddlewareError(
                    f"mavlink: {self.component_name} is in the frame '{bound.frame}', for which MAVLink has no message"
                )
            if bound.kind.name in ("fix", "magnetic_field") and self.other_north:
                raise MorseMiddlewareError(f"mavlink: {self.component_name} {self.other_north}")

    def axes_of(self, frame: str) -> Axes:
        """The conversion for a frame of MORSE."""
        return self.axes[frame if frame in ("ned", "enu") else "world"]

    def number(self, bound: BoundKind) -> int:
        """The id of the component on its vehicle, 0..255."""
        return self.vehicle.number_of(self.component_name) % 256


logger = logging.getLogger(__name__)

_AUTOPILOT = 1
#: constants of the message HEARTBEAT. MAVSDK and ground stations know the modes of PX4 and ArduPilot only
_INVALID, _PX4 = 8, 12
#: what has no battery does not run out of it
_NO_BATTERY = (0xFFFF, -1, 100)
#: number of requested messages that are sent in a tick
_MOST_REQUESTS = 32


class Pilot(Protocol):
    """What a vehicle and its link call; see `morse.plugins.mavlink.autopilot.pilot.Autopilot`."""

    place: Place

    def greet(self) -> None:
        """Introduce the vehicle to a new peer."""

    def report(self, stamp: int) -> None:
        """Send the state of the vehicle at a time, ns."""

    def steer(self, stamp: int) -> None:
        """Steer the vehicle in a tick, whose time is in ns."""

    def take(self, message: MavlinkMessage) -> bool:
        """Answer a message; False if it is for the streams of the actuators."""

    def get_state(self) -> object:
        """What a saved state contains, as plain data."""

    def set_state(self, state: object) -> None:
        """Restore what `get_state` has returned."""

    def look_at(self, components: Iterable[Object]) -> None:
        """Find out which components of the robot the vehicle has."""


class Vehicle:
    """Sends the messages of one robot.

    Attributes:
        system: its system id.
        link: where its messages go.
        robot: the robot; set before the first tick.
        streams: the streams of its actuators.
        pilot: the autopilot; None with an autopilot in the loop.
        loop: the autopilot in the loop; None if there is none.
        kind: MAV_TYPE.
        autopilot: MAV_AUTOPILOT.
        battery: voltage, mV, current, 0.01 A, and charge, percent, as SYS_STATUS has them.
        measured: names of the messages that sensors send, in lower case.
        after_tick: what sends the messages that were requested.
    """

    robot: Object | Carrier

    def __init__(self, dialect: ModuleType, system: int, link: Link, hil: bool) -> None:
        self._dialect = dialect
        self.system, self.link = system, link
        #: by the id of the component, each of which counts its messages
        self._senders: dict[int, Any] = {}
        self.streams: list[MavlinkStream] = []
        self.pilot: Pilot | None = None
        self.loop: Loop | None = None
        self.kind = 0
        self.autopilot = _INVALID if hil else _PX4
        self.battery = _NO_BATTERY
        self.measured: set[str] = set()
        self.after_tick: list[Callable[[], object]] = []
        self._numbers: dict[str, int] = {}
        self._readings: dict[str, float] = {}
        self._complaints = Complaints(logger)

    def number_of(self, name: str) -> int:
        """The id of a component."""
        return self._numbers.setdefault(name, len(self._numbers))

    def name_of(self, number: int) -> str | None:
        """The name of a message; None if there is none of that number."""
        entry = self._dialect.mavlink_map.get(number)
        return None if entry is None else str(entry.msgname)

    def knows(self, name: str) -> bool:
        """Whether the installed version of pymavlink has a message."""
        return hasattr(self._dialect.MAVLink, f"{name}_encode")

    def complain(self, kind: str, text: str) -> None:
        """Log a problem of a client, at most once in a while for each kind."""
        self._complaints.warn(kind, f"mavlink: system {self.system}: {text}")

    def send(self, name: str, *values: object) -> None:
        """Send a message.

        Args:
            name: of the message, in lower case.
            values: of its fields, in order. A message with invalid values is omitted, and the log reports it.
        """
        self.send_from(_AUTOPILOT, name, *values)

    def send_from(self, component: int, name: str, *values: object) -> None:
        """Send a message of a component of the vehicle, such as a camera; see `send`."""
        sender = self._senders.get(component)
        if sender is None:
            sender = self._senders[component] = self._dialect.MAVLink(None, self.system, component)
        try:
            data = getattr(sender, f"{name}_encode")(*values).pack(sender)
        except (struct.error, ValueError, TypeError, OverflowError) as error:
            self._complaints.warn(name, f"mavlink: {name.upper()} of the system {self.system} is left out: {error}")
            return
        sender.seq = (sender.seq + 1) % 256
        self.link.send(bytes(data))

    def measure(self, name: str, *values: object) -> None:
        """Send a message of a sensor; the autopilot does not send it any more."""
        self.measured.add(name)
        self.send(name, *values)

    def sense(self, **values: float) -> None:
        """Add fields to the message that contains all sensors of the tick."""
        self._readings.update(values)

    def greet(self) -> None:
        """Send the next heartbeat at the end of the tick."""
        for one in (self.pilot, self.loop):
            if one is not None:
                one.greet()

    def tick(self, stamp: int) -> None:
        """The end of a tick: send the sensors of the tick, and what the autopilot reports.

        Args:
            stamp: simulated time, ns.
        """
        readings, self._readings = self._readings, {}
        if self.loop is not None:
            self.loop.tick(stamp, readings)
        elif "xacc" in readings or "xmag" in readings:
            bits = sum(1 << BITS[name] for name in readings)
            self.send("highres_imu", stamp // 1000, *(readings.get(name, 0.0) for name in BITS), bits)
        if self.pilot is not None:
            self.pilot.report(stamp)
        calls, self.after_tick = self.after_tick, []
        for send in calls[:_MOST_REQUESTS]:
            send()
