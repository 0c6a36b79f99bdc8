"""The autopilot of a vehicle: what it does with a message, and in a tick."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from morse.plugins.mavlink.autopilot import saved
from morse.plugins.mavlink.autopilot.files import Files
from morse.plugins.mavlink.autopilot.flight import Flight
from morse.plugins.mavlink.autopilot.gimbal import Gimbal
from morse.plugins.mavlink.autopilot.modes import mode_of_base, mode_of_custom
from morse.plugins.mavlink.autopilot.orders import Orders
from morse.plugins.mavlink.autopilot.parameters import Parameters
from morse.plugins.mavlink.autopilot.reports import Reports
from morse.plugins.mavlink.autopilot.setpoints import SetpointError, setpoint_of
from morse.plugins.mavlink.autopilot.steering import helms_of
from morse.plugins.mavlink.autopilot.transfers import Transfers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.context import Context
    from morse.core.object import Object
    from morse.plugins.mavlink.axes import Place
    from morse.plugins.mavlink.framing import MavlinkMessage
    from morse.plugins.mavlink.vehicle import Vehicle


_LOG_BYTES, _SHELL_BYTES = 90, 70
#: SERIAL_CONTROL_FLAG: the sender wants an answer; this is an answer
_WANTED, _REPLY = 2, 1
_TEXT = b"There is no shell: the vehicle is simulated by MORSE.\n"


class Absent:
    """Says that nothing is there: who asks would otherwise ask again until it gives up."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    def take_log_request_list(self, message: MavlinkMessage) -> None:
        """The list of logs is empty."""
        self._vehicle.send("log_entry", 0, 0, 0, 0, 0)

    def take_log_request_data(self, message: MavlinkMessage) -> None:
        """A log without bytes is at its end."""
        self._vehicle.send("log_data", message.id, message.ofs, 0, [0] * _LOG_BYTES)

    def take_serial_control(self, message: MavlinkMessage) -> None:
        """Commands of a shell have no effect."""
        if message.flags & _WANTED and message.count:
            data = list(_TEXT.ljust(_SHELL_BYTES, b"\0"))
            self._vehicle.send("serial_control", message.device, _REPLY, 0, 0, len(_TEXT), data)


#: MAV_TYPE
_GROUND_STATION = 6
#: INT16_MAX: a stick that does not exist
_NO_STICK = 0x7FFF


class Autopilot:
    """Answers ground stations, and steers the vehicle.

    Args:
        vehicle: sends its messages.
        context: of the simulation.

    Attributes:
        place: its frame.
    """

    def __init__(self, vehicle: Vehicle, place: Place, context: Context) -> None:
        self._vehicle = vehicle
        self.place = place
        parameters = Parameters(vehicle)
        self.flight = Flight(vehicle, place, parameters, context)
        self._parameters = parameters
        self._reports = Reports(vehicle, self.flight)
        self._gimbal = Gimbal(vehicle, self.flight)
        orders = Orders(vehicle, self.flight, self._reports, self._gimbal)
        self._transfers = transfers = Transfers(vehicle, self.flight.mission, self.flight.fence)
        self._files = Files(vehicle, self.flight.cameras.photos)
        absent = Absent(vehicle)
        self._takes: dict[str, Callable[[MavlinkMessage], object]] = {
            "COMMAND_LONG": orders.take,
            "COMMAND_INT": orders.take,
            "SET_MODE": self._set_mode,
            "HEARTBEAT": self._heard,
            "SET_POSITION_TARGET_LOCAL_NED": self._setpoint,
            "SET_POSITION_TARGET_GLOBAL_INT": self._setpoint,
            "MANUAL_CONTROL": self._manual,
            "GIMBAL_MANAGER_SET_PITCHYAW": self._look,
            "TIMESYNC": self._timesync,
            "FOLLOW_TARGET": self.flight.follow.take,
            "FILE_TRANSFER_PROTOCOL": self._files.take,
            "SET_GPS_GLOBAL_ORIGIN": lambda _: self._reports.request("GPS_GLOBAL_ORIGIN"),
            **{name: getattr(absent, f"take_{name.lower()}") for name in ABSENT_MESSAGES},
            **dict.fromkeys(MISSION_MESSAGES, transfers.take),
            **dict.fromkeys(PARAMETER_MESSAGES, parameters.take),
        }

    def take(self, message: MavlinkMessage) -> bool:
        """Answer a message; False if it is for the streams of the actuators."""
        kind = message.get_type()
        if self.flight.helm is None and kind.startswith("SET_POSITION_TARGET"):
            return False
        if kind == "SET_ATTITUDE_TARGET":
            # it goes to the actuator as it is
            is_followed = self.flight.follows()
            if is_followed:
                self.flight.setpoint = None
                self.flight.is_released = True
            return not is_followed
        take = self._takes.get(kind)
        if take is not None:
            take(message)
        return take is not None

    def look_at(self, components: Iterable[Object]) -> None:
        """Determine what can steer the vehicle, and the cameras among the components of the robot."""
        self.flight.helms = helms_of(self._vehicle, self.place)
        self.flight.cameras.look_at(components)

    def get_state(self) -> object:
        """What a saved state contains, as plain data."""
        return msgspec.to_builtins(saved.save(self.flight, self._parameters, self._gimbal))

    def set_state(self, state: object) -> None:
        """Restore what `get_state` has returned, and `morse.plugins.mavlink.autopilot.saved.checked` accepts."""
        saved.restore(saved.checked(state), self.flight, self._parameters, self._gimbal)

    def greet(self) -> None:
        """Send a heartbeat."""
        self._reports.request("HEARTBEAT")

    def steer(self, stamp: int) -> None:
        """The beginning of a tick, at a simulated time, ns."""
        self._gimbal.tick(stamp)
        self.flight.tick(stamp)

    def report(self, stamp: int) -> None:
        """The end of a tick, at a simulated time, ns."""
        self.flight.look()
        self._reports.tick(stamp)
        self._transfers.tick(stamp)
        self._parameters.tick()
        self.flight.cameras.tick(stamp)
        self._files.tick()

    def _setpoint(self, message: MavlinkMessage) -> None:
        flight = self.flight
        try:
            setpoint = setpoint_of(message, flight.place, flight.home, flight.now)
        except SetpointError as error:
            self._vehicle.complain("setpoint", str(error))
            return
        flight.take_setpoint(setpoint)

    def _heard(self, message: MavlinkMessage) -> None:
        if message.type == _GROUND_STATION:
            self.flight.failsafe.hear_station()

    def _set_mode(self, message: MavlinkMessage) -> None:
        base = message.base_mode
        mode = mode_of_custom(message.custom_mode) if base & 1 else mode_of_base(base)
        if mode is not None:
            self.flight.switch(mode)

    def _manual(self, message: MavlinkMessage) -> None:
        sticks = (message.x, message.y, message.z, message.r)
        x, y, z, r = (0 if v == _NO_STICK else max(-1000, min(v, 1000)) for v in sticks)
        if self.flight.mode.by_hand:
            self.flight.take_sticks(x / 1000.0, y / 1000.0, max(-1.0, z / 500.0 - 1.0), r / 1000.0)

    def _look(self, message: MavlinkMessage) -> None:
        self._gimbal.look(message.pitch, message.yaw, message.pitch_rate, message.yaw_rate)

    def _timesync(self, message: MavlinkMessage) -> None:
        if message.tc1 == 0:
            self._vehicle.send("timesync", self.flight.stamp, message.ts1)


MISSION_MESSAGES = (
    "MISSION_COUNT",
    "MISSION_ITEM",
    "MISSION_ITEM_INT",
    "MISSION_REQUEST_LIST",
    "MISSION_REQUEST",
    "MISSION_REQUEST_INT",
    "MISSION_CLEAR_ALL",
    "MISSION_SET_CURRENT",
    "MISSION_ACK",
)
PARAMETER_MESSAGES = (
    *("PARAM_REQUEST_LIST", "PARAM_REQUEST_READ", "PARAM_SET"),
    *("PARAM_EXT_REQUEST_LIST", "PARAM_EXT_REQUEST_READ", "PARAM_EXT_SET"),
)
#: of things that no vehicle has here
ABSENT_MESSAGES = ("LOG_REQUEST_LIST", "LOG_REQUEST_DATA", "SERIAL_CONTROL")
#: messages that an autopilot reads
MESSAGES = (
    *MISSION_MESSAGES,
    *PARAMETER_MESSAGES,
    *ABSENT_MESSAGES,
    "FILE_TRANSFER_PROTOCOL",
    "FOLLOW_TARGET",
    "SET_GPS_GLOBAL_ORIGIN",
    "COMMAND_LONG",
    "COMMAND_INT",
    "SET_MODE",
    "MANUAL_CONTROL",
    "TIMESYNC",
)
