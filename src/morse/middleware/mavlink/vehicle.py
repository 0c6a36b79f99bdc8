"""A robot as a MAVLink system with an id on one link."""

from __future__ import annotations

import logging
import struct
from typing import TYPE_CHECKING, Any

from morse.core.clients.complaints import Complaints

if TYPE_CHECKING:
    from morse.middleware.mavlink.links import Link

logger = logging.getLogger(__name__)

_AUTOPILOT = 1
#: constants of the message HEARTBEAT
_GENERIC, _INVALID = 0, 8
_ACTIVE, _HIL = 4, 32
#: bits of fields_updated
_BITS = {
    "xacc": 0, "yacc": 1, "zacc": 2, "xgyro": 3, "ygyro": 4, "zgyro": 5, "xmag": 6, "ymag": 7, "zmag": 8,
    "abs_pressure": 9, "diff_pressure": 10, "pressure_alt": 11, "temperature": 12,
}  # fmt: skip


class Vehicle:
    """Sends the messages of one robot.

    Attributes:
        system: its system id.
        link: where its messages go.
        hil: whether an autopilot in the loop is the peer.
        streams: the streams of its actuators.
    """

    def __init__(self, dialect: Any, system: int, link: Link, kind: int, hil: bool) -> None:
        self._dialect, self._kind = dialect, kind
        self.system, self.link, self.hil = system, link, hil
        self._mav = dialect.MAVLink(None, srcSystem=system, srcComponent=_AUTOPILOT)
        self.streams: list[Any] = []
        self._numbers: dict[str, int] = {}
        self._sensed: dict[str, float] = {}
        self._complaints = Complaints(logger)

    def number_of(self, name: str) -> int:
        """The id of a component."""
        return self._numbers.setdefault(name, len(self._numbers))

    def send(self, name: str, *values: Any) -> None:
        """Send a message.

        Args:
            name: of the message, in lower case.
            values: of its fields, in order. A message with invalid values is omitted, and the log reports it.
        """
        try:
            data = getattr(self._mav, f"{name}_encode")(*values).pack(self._mav)
        except (struct.error, ValueError, TypeError, OverflowError) as error:
            self._complaints.warn(name, f"mavlink: {name.upper()} of the system {self.system} is left out: {error}")
            return
        self._mav.seq = (self._mav.seq + 1) % 256
        self.link.send(bytes(data))

    def sense(self, **values: float) -> None:
        """Add fields to the message that contains all sensors of the tick."""
        self._sensed.update(values)

    def tick(self, stamp: int) -> None:
        """The end of a tick: send the sensors of the tick, and a heartbeat.

        Args:
            stamp: simulated time, ns.
        """
        sensed, self._sensed = self._sensed, {}
        if sensed and (self.hil or "xacc" in sensed or "xmag" in sensed):
            bits = sum(1 << _BITS[name] for name in sensed)
            values = [sensed.get(name, 0.0) for name in _BITS]
            self.send("hil_sensor" if self.hil else "highres_imu", stamp // 1000, *values, bits)
        autopilot = _INVALID if self.hil else _GENERIC
        self.send("heartbeat", self._kind, autopilot, _HIL if self.hil else 0, 0, _ACTIVE)
