"""An autopilot with an estimator and a controller of its own, which knows a quadrotor by HIL messages only."""

import math
import socket
import threading
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import common

#: the airframe, as its user describes it: kg, kg m^2, N s^2, N m s^2, m, rad/s at the control 1.0
MASS, INERTIA, THRUST, DRAG, LEVER, FULL = 2.0, np.array([0.088, 0.088, 0.163]), 9.169e-6, 2.4e-7, 0.18, 1200.0
GRAVITY = np.array([0.0, 0.0, 9.81])
#: bit of fields_updated
_PRESSURE = 1 << 9
#: squared speeds of the rotors from thrust and torques about forward, right, down; configuration x of the actuator
_ARM = THRUST * LEVER * math.sqrt(0.5)
MIX = np.linalg.inv(
    np.array([[THRUST] * 4, [_ARM, -_ARM, -_ARM, _ARM], [_ARM, _ARM, -_ARM, -_ARM], [DRAG, -DRAG, DRAG, -DRAG]])
)


class Estimator:
    """Attitude, velocity and position: gyroscopes and accelerometers, corrected by satellites, pressure, field."""

    def __init__(self) -> None:
        self.rotation: Any = None  # forward, right, down to north, east, down
        self.velocity, self.position = np.zeros(3), np.zeros(3)
        self.rates = np.zeros(3)
        self._start: tuple[float, float, float] | None = None
        self._height: float | None = None
        self._still = 0

    def sense(self, m: Any, dt: float) -> None:
        """HIL_SENSOR."""
        force = np.array([m.xacc, m.yacc, m.zacc])
        field = np.array([m.xmag, m.ymag, m.zmag])
        self.rates = np.array([m.xgyro, m.ygyro, m.zgyro])
        if self.rotation is None:
            # it aligns itself when it has been still for a while
            is_still = abs(float(np.linalg.norm(force)) - 9.81) < 0.2 and float(np.linalg.norm(self.rates)) < 0.05
            self._still = self._still + 1 if is_still else 0
            if self._still < 100:
                return
            down = -force / np.linalg.norm(force)
            east = np.cross(down, field)
            east /= np.linalg.norm(east)
            self.rotation = np.array([np.cross(east, down), east, down])
        level = self.rotation @ field
        # without the declination, north is that of the field
        turn = np.array([0.0, 0.0, -0.5 * math.atan2(level[1], level[0])])
        self._turn(self.rotation @ self.rates * dt + turn * dt)
        self.velocity = self.velocity + (self.rotation @ force + GRAVITY) * dt
        self.position = self.position + self.velocity * dt
        self._force = self.rotation @ force
        if not m.fields_updated & _PRESSURE:
            return
        if self._height is None:
            self._height = m.pressure_alt
        error = -(m.pressure_alt - self._height) - self.position[2]
        self.position[2] += 0.02 * error
        self.velocity[2] += 0.01 * error

    def fix(self, m: Any) -> None:
        """HIL_GPS."""
        if self.rotation is None:
            return
        latitude, longitude = m.lat * 1e-7, m.lon * 1e-7
        if self._start is None:
            self._start = (latitude, longitude, 0.0)
        metres = 6371008.8 * math.pi / 180.0
        north = (latitude - self._start[0]) * metres
        east = (longitude - self._start[1]) * metres * math.cos(math.radians(latitude))
        self.position[:2] += 0.1 * (np.array([north, east]) - self.position[:2])
        error = np.array([m.vn, m.ve, m.vd]) * 0.01 - self.velocity
        self.velocity = self.velocity + 0.2 * error
        self._turn(0.05 * np.cross(self._force, error) / 9.81**2)

    def _turn(self, angle: Any) -> None:
        size = float(np.linalg.norm(angle))
        if size > 1e-12:
            x, y, z = angle / size
            k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            step = np.eye(3) + math.sin(size) * k + (1.0 - math.cos(size)) * k @ k
            self.rotation = step @ self.rotation


class Controller(threading.Thread):
    """Flies to a height and stays there, until it has received enough measurements. In lockstep, as PX4."""

    def __init__(self, port: int, height: float, count: int) -> None:
        super().__init__()
        self.estimator = Estimator()
        self.goal = np.array([0.0, 0.0, -height])
        self.sensors: list[Any] = []
        self.states: list[Any] = []
        self.others: list[Any] = []
        self._count = count
        self._integral = np.zeros(3)
        self._ahead: Any = None
        self._mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
        self._socket = socket.create_connection(("127.0.0.1", port))

    def run(self) -> None:
        # what PX4 sends first: it asks for the truth, for its log
        interval = self._mav.command_long_encode(0, 0, 511, 0, 115.0, 5000.0, 0, 0, 0, 0, 0)
        self._socket.sendall(interval.pack(self._mav))
        while len(self.sensors) < self._count and (data := self._socket.recv(1 << 16)):
            for message in self._mav.parse_buffer(bytearray(data)) or ():
                self._take(message)
        self._socket.close()

    def _take(self, message: Any) -> None:
        kind = message.get_type()
        if kind == "HIL_GPS":
            self.estimator.fix(message)
        elif kind == "HIL_STATE_QUATERNION":
            self.states.append(message)
        elif kind != "HIL_SENSOR":
            self.others.append(message)
        else:
            dt = (message.time_usec - self.sensors[-1].time_usec) * 1e-6 if self.sensors else 0.0
            self.sensors.append(message)
            self.estimator.sense(message, dt)
            is_armed = self.estimator.rotation is not None and len(self.sensors) > 250
            controls = self._controls(dt) if is_armed else [0.0] * 4
            mode = 1 | (128 if is_armed else 0)
            answer = self._mav.hil_actuator_controls_encode(message.time_usec, controls + [math.nan] * 12, mode, 1)
            self._socket.sendall(answer.pack(self._mav))

    def _controls(self, dt: float) -> list[float]:
        one = self.estimator
        wanted = np.clip(0.8 * (self.goal - one.position), -1.0, 1.0)
        error = wanted - one.velocity
        self._integral = np.clip(self._integral + 0.4 * error * dt, -2.0, 2.0)
        force = MASS * (np.clip(2.0 * error, -4.0, 4.0) + self._integral - GRAVITY)
        down = -force / np.linalg.norm(force)
        if self._ahead is None:
            self._ahead = one.rotation[:, 0]
        right = np.cross(down, self._ahead)
        right /= np.linalg.norm(right)
        target = np.column_stack([np.cross(right, down), right, down])
        skew = one.rotation.T @ target - target.T @ one.rotation
        angle = 0.5 * np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
        torque = INERTIA * np.clip(12.0 * (np.array([5.0, 5.0, 2.0]) * angle - one.rates), -30.0, 30.0)
        thrust = max(0.0, float(-force @ one.rotation[:, 2]))
        squares = MIX @ np.array([thrust, *torque])
        return [min(math.sqrt(max(0.0, square)) / FULL, 1.0) for square in squares]
