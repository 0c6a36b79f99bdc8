"""Reads and writes the socket as ArduPilot's backend for MORSE does: its search for keys, its axes and lines."""

from __future__ import annotations

import re
import socket
from typing import Any

#: section, key, number of values
KEYS = (
    ("", "timestamp", 1),
    ("vehicle.imu", "angular_velocity", 3),
    ("vehicle.imu", "linear_acceleration", 3),
    ("vehicle.imu", "magnetic_field", 3),
    ("vehicle.gps", "x", 1),
    ("vehicle.gps", "y", 1),
    ("vehicle.gps", "z", 1),
    ("vehicle.pose", "roll", 1),
    ("vehicle.pose", "pitch", 1),
    ("vehicle.pose", "yaw", 1),
    ("vehicle.velocity", "world_linear_velocity", 3),
)
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
#: the format of its sscanf: a space after each comma
_VECTOR = re.compile(rf"\[({_NUMBER}), ({_NUMBER}), ({_NUMBER})\]")
#: bytes that it keeps
_BUFFER = 50_000


def parse(line: str) -> dict[str, Any]:
    """The values of a line: each key is the first one behind the name of its section; nothing else is understood."""
    values: dict[str, Any] = {}
    for section, key, count in KEYS:
        at = line.find(section)
        assert at >= 0, f"there is no {section}"
        at = line.find(key, at + len(section) + 1)
        assert at >= 0, f"there is no {section}/{key}"
        rest = line[at + len(key) + 3 :]  # behind '": '
        if count == 3:
            match = _VECTOR.match(rest)
            assert match, f"{section}/{key}: {rest[:60]}"
            values[key] = [float(number) for number in match.groups()]
        else:
            number = re.match(rf"\s*({_NUMBER})", rest)
            assert number, f"{section}/{key}: {rest[:60]}"
            values[key] = float(number[1])
    return values


class Peer:
    """Has two connections: the first receives the sensors, the second sends the controls."""

    def __init__(self, sensors: int, controls: int) -> None:
        self._sensors = socket.create_connection(("127.0.0.1", sensors), timeout=60)
        self._controls = socket.create_connection(("127.0.0.1", controls), timeout=60)
        self._sensors.setblocking(False)
        self._buffer = b""
        self.has_sent = False

    def receive(self) -> dict[str, Any] | None:
        """The newest complete line between two ends of lines, north-west-up turned to north-east-down; or None."""
        try:
            self._buffer += self._sensors.recv(_BUFFER - len(self._buffer))
        except BlockingIOError:
            return None
        last = self._buffer.rfind(b"\n")
        first = self._buffer.rfind(b"\n", 0, max(last, 0))
        if last < 0 or first < 0:
            return None
        state = parse(self._buffer[first + 1 : last].decode())
        self._buffer = self._buffer[last:]
        for name in ("angular_velocity", "linear_acceleration", "world_linear_velocity"):
            x, y, z = state[name]
            state[name] = [x, -y, -z]
        state["position"] = [state["x"], -state["y"], -state["z"]]
        state["pitch"], state["yaw"] = -state["pitch"], -state["yaw"]
        return state

    def drive(self, steer: float, force: float) -> None:
        """A rover."""
        self.has_sent = True
        self._controls.sendall(b'{"steer": %.3f, "force": %.2f, "brake": %.2f}\n' % (steer, force, 0.0))

    def fly(self, right: float, left: float, front: float, back: float) -> None:
        """A quadrotor of the frame +."""
        self.has_sent = True
        self._controls.sendall(b'{"engines": [%.3f, %.3f, %.3f, %.3f]}\n' % (back, right, front, left))

    def close(self) -> None:
        self._sensors.close()
        self._controls.close()
