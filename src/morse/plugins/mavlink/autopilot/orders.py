"""Executes COMMAND_LONG and COMMAND_INT."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from morse.plugins.mavlink.autopilot.failsafe import WARNING
from morse.plugins.mavlink.autopilot.modes import Mode, mode_of, mode_of_base

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.flight import Flight
    from morse.plugins.mavlink.autopilot.gimbal import Gimbal
    from morse.plugins.mavlink.autopilot.reports import Reports
    from morse.plugins.mavlink.framing import MavlinkMessage
    from morse.plugins.mavlink.vehicle import Vehicle

#: MAV_RESULT
ACCEPTED, REJECTED, DENIED, UNSUPPORTED = 0, 1, 2, 3
#: parameter 2 of MAV_CMD_COMPONENT_ARM_DISARM: also in flight
_FORCE = 21196.0
#: MAV_COMP_ID
_AUTOPILOT = 1
#: frames of COMMAND_INT whose altitude is above home
_ABOVE_HOME = (3, 6, 10, 11)
_HIGHEST = 1e6
_CUSTOM = 1
_CONFIGURE_GIMBAL = 1001


class Order(NamedTuple):
    """The parameters of a command.

    Attributes:
        params: seven, the fifth and sixth of which are degrees.
        frame: MAV_FRAME, for COMMAND_INT; above the sea for COMMAND_LONG.
    """

    params: tuple[float, ...]
    frame: int


class Orders:
    """The commands of a vehicle, and their answers."""

    def __init__(self, vehicle: Vehicle, flight: Flight, reports: Reports, gimbal: Gimbal) -> None:
        self._vehicle, self._flight, self._reports, self._gimbal = vehicle, flight, reports, gimbal
        self._cameras = flight.cameras

    def take(self, message: MavlinkMessage) -> None:
        """Execute a message, and answer it."""
        component = message.target_component or _AUTOPILOT
        if message.get_type() == "COMMAND_INT":
            place: tuple[float, float] = message.x * 1e-7, message.y * 1e-7
            order = Order((*_four(message), *place, message.z), message.frame)
        else:
            order = Order((*_four(message), message.param5, message.param6, message.param7), 0)
        execute = self._COMMANDS.get(message.command)
        result = UNSUPPORTED
        sender = message.get_srcSystem(), message.get_srcComponent()
        if component == _AUTOPILOT and message.command == _CONFIGURE_GIMBAL:
            result = ACCEPTED if self._gimbal.configure(order.params, sender) else UNSUPPORTED
        elif self._cameras.is_for(component, message.command):
            result = self._cameras.obey(component, message.command, order.params)
        elif component == _AUTOPILOT and execute is not None:
            result = execute(self, order)
        # also for a component that does not exist: the sender would ask again until it gives up
        self._vehicle.send_from(component, "command_ack", message.command, result, 0, 0, *sender)

    def _altitude(self, order: Order) -> float:
        """The altitude above the sea of an order, m; NaN if it has none."""
        value = order.params[6]
        if order.frame in _ABOVE_HOME:
            value += self._flight.place.earth(self._flight.home)[2]
        return value if abs(value) < _HIGHEST else math.nan

    def _position(self, order: Order, *, zero_is_here: bool = False) -> Triple | None:
        """The position of an order in the world; None if it is not valid. What it does not say is as it is."""
        place = self._flight.place
        latitude, longitude, altitude = place.earth(self._flight.now.position)
        coordinates = order.params[4:6]
        if not (zero_is_here and coordinates == (0.0, 0.0)) and not any(math.isnan(v) for v in coordinates):
            latitude, longitude = coordinates
        if not (abs(latitude) <= 90.0 and abs(longitude) <= 180.0):
            return None
        height = self._altitude(order)
        return place.from_earth(latitude, longitude, altitude if math.isnan(height) else height)

    # -- commands ----------------------------------------------------------------------------

    def _arm(self, order: Order) -> int:
        flight = self._flight
        if flight.helm is None:
            return UNSUPPORTED
        if order.params[0] == 1.0:
            return ACCEPTED if flight.arm() else DENIED
        if order.params[0] == 0.0:
            return ACCEPTED if flight.disarm(force=order.params[1] == _FORCE) else DENIED
        return DENIED

    def _take_off(self, order: Order) -> int:
        flight = self._flight
        if not flight.is_aircraft or flight.helm is None:
            return UNSUPPORTED
        if not flight.is_armed:
            return REJECTED
        height = flight.home[2] + flight.parameters["MIS_TAKEOFF_ALT"]
        altitude = self._altitude(order)
        if math.isfinite(altitude):
            home = flight.place.earth(flight.home)[2]
            # what is below home is meant as a height above home, as ArduPilot reads it
            height = flight.home[2] + (altitude - home if altitude > home else altitude)
            if not 0.1 < height - flight.home[2] < 1e5:
                height = flight.home[2] + flight.parameters["MIS_TAKEOFF_ALT"]
        return ACCEPTED if flight.take_off(max(height, flight.now.position[2])) else REJECTED

    def _land(self, order: Order) -> int:
        return self._enter(Mode.LAND)

    def _return(self, order: Order) -> int:
        return self._enter(Mode.RETURN)

    def _hold(self, order: Order) -> int:
        return self._enter(Mode.HOLD)

    def _enter(self, mode: Mode) -> int:
        flight = self._flight
        if flight.helm is None or (mode is Mode.LAND and not flight.is_aircraft):
            return UNSUPPORTED
        return ACCEPTED if flight.switch(mode) else REJECTED

    def _set_mode(self, order: Order) -> int:
        base, main, sub = order.params[:3]
        if not base >= 0.0:
            return UNSUPPORTED
        bits = int(min(base, 255.0))
        mode = mode_of(main, 0.0 if math.isnan(sub) else sub) if bits & _CUSTOM else mode_of_base(bits)
        if mode is None:
            return UNSUPPORTED
        if mode is Mode.TAKEOFF and not self._flight.is_armed:
            return REJECTED
        return self._enter(mode)

    def _start_mission(self, order: Order) -> int:
        flight = self._flight
        first = order.params[0]
        if flight.helm is None:
            return UNSUPPORTED
        if 0.0 < first < len(flight.mission.items):
            flight.mission.go_on_at(int(first))
        if not flight.switch(Mode.MISSION):
            return DENIED
        return ACCEPTED if flight.arm() else DENIED

    def _pause(self, order: Order) -> int:
        if order.params[0] == 0.0:
            return self._enter(Mode.HOLD)
        return self._enter(Mode.MISSION) if order.params[0] == 1.0 else DENIED

    def _set_item(self, order: Order) -> int:
        index = order.params[0]
        return ACCEPTED if 0.0 <= index < 65536.0 and self._flight.mission.go_on_at(int(index)) else DENIED

    def _reposition(self, order: Order) -> int:
        flight = self._flight
        if flight.helm is None:
            return UNSUPPORTED
        goal = self._position(order)
        if goal is None or not flight.is_armed:
            return DENIED if goal is None else REJECTED
        if flight.failsafe.is_outside(goal):
            flight.say(WARNING, "Reposition is outside geofence")
            return DENIED
        speed, yaw = order.params[0], order.params[3]
        if speed > 0.0:
            flight.change_speed(speed)
        heading = flight.place.heading(yaw) if abs(yaw) < 1e3 else None
        flight.go(goal, heading)
        return ACCEPTED

    def _change_speed(self, order: Order) -> int:
        return ACCEPTED if self._flight.change_speed(order.params[1]) else DENIED

    def _set_home(self, order: Order) -> int:
        flight = self._flight
        home = flight.now.position if order.params[0] == 1.0 else self._position(order)
        if home is None:
            return DENIED
        flight.home = home
        self._reports.request("HOME_POSITION")
        return ACCEPTED

    def _end(self, order: Order) -> int:
        if self._flight.helm is None:
            return UNSUPPORTED
        return ACCEPTED if order.params[0] == 1.0 and self._flight.disarm(force=True) else DENIED

    def _set_interval(self, order: Order) -> int:
        return ACCEPTED if self._reports.set_interval(order.params[0], order.params[1]) else UNSUPPORTED

    def _get_interval(self, order: Order) -> int:
        self._reports.tell_interval(order.params[0])
        return ACCEPTED

    def _request(self, order: Order) -> int:
        number = order.params[0]
        if self._gimbal.request(number) or self._reports.request_number(number):
            return ACCEPTED
        return UNSUPPORTED

    def _request_version(self, order: Order) -> int:
        return ACCEPTED if order.params[0] == 1.0 and self._reports.request("AUTOPILOT_VERSION") else DENIED

    def _request_home(self, order: Order) -> int:
        return ACCEPTED if self._reports.request("HOME_POSITION") else DENIED

    def _look(self, order: Order) -> int:
        return ACCEPTED if self._gimbal.look(*(math.radians(angle) for angle in order.params[:4])) else UNSUPPORTED

    def _look_at(self, order: Order) -> int:
        place = self._position(order)
        if not self._gimbal.is_there:
            return UNSUPPORTED
        return ACCEPTED if place is not None and self._gimbal.look_at(place) else DENIED

    def _look_ahead(self, order: Order) -> int:
        return ACCEPTED if self._gimbal.look_at(None) else UNSUPPORTED

    _COMMANDS: ClassVar[dict[int, Callable[[Orders, Order], int]]] = {
        17: _hold, 20: _return, 21: _land, 22: _take_off, 176: _set_mode, 178: _change_speed, 179: _set_home,
        185: _end, 192: _reposition, 193: _pause, 224: _set_item, 300: _start_mission, 400: _arm,
        410: _request_home,
        510: _get_interval, 511: _set_interval, 512: _request, 520: _request_version, 1000: _look,
        195: _look_at, 197: _look_ahead,
    }  # fmt: skip


def _four(message: MavlinkMessage) -> tuple[float, float, float, float]:
    return message.param1, message.param2, message.param3, message.param4
