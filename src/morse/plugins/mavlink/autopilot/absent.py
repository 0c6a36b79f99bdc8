"""Answers for what a vehicle does not have: logs and a shell."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.plugins.mavlink.messages import MavlinkMessage
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
