"""A ground station in the process of the simulation, made of pymavlink: it sees each tick."""

import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pymavlink.dialects.v20 import common

import morse
from tests.kit.programs import free_ports

#: simulated seconds after which a test no longer waits
LIMIT = 120.0


class GroundStation:
    """Receives what vehicles send to a port.

    Attributes:
        seen: the last message of each kind, by system and name.
        heard: all messages in their order, if `keeps` is true.
    """

    def __init__(self, port: int, system: int = 255) -> None:
        self.mav = common.MAVLink(None, srcSystem=system, srcComponent=190)
        self.mav.robust_parsing = True
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", port))
        self._socket.setblocking(False)
        self._peer: Any = None
        self.sim: Any = None
        self.seen: dict[tuple[int, str], Any] = {}
        self.heard: list[Any] = []
        self.times: list[float] = []

    def close(self) -> None:
        self._socket.close()

    def read(self) -> None:
        while True:
            try:
                data, self._peer = self._socket.recvfrom(1 << 16)
            except BlockingIOError:
                return
            for message in self.mav.parse_buffer(bytearray(data)) or ():
                self.seen[message.get_srcSystem(), message.get_type()] = message
                self.heard.append(message)
                self.times.append(self.sim.clock.time)

    def send(self, name: str, *values: Any) -> None:
        """Send a message by the name of its encoder without ``_encode``."""
        self.send_bytes(getattr(self.mav, f"{name}_encode")(*values).pack(self.mav))

    def send_bytes(self, data: bytes) -> None:
        if self._peer is None:
            self.until(lambda: self._peer is not None)
        self._socket.sendto(bytes(data), self._peer)

    def step(self, ticks: int = 1) -> None:
        for _ in range(ticks):
            self.sim.step()
            self.read()

    def until(self, condition: Callable[[], object], limit: float = LIMIT) -> None:
        end = self.sim.clock.time + limit
        while not condition():
            assert self.sim.clock.time < end, "it does not become so"
            self.step()

    def last(self, name: str, system: int = 1) -> Any:
        """The next message of a kind."""
        self.seen.pop((system, name), None)
        self.until(lambda: (system, name) in self.seen)
        return self.seen[system, name]

    def last_of(self, number: int, system: int = 1) -> Any:
        """The next message of a number, or the one that has just come."""
        name = common.mavlink_map[number].msgname
        self.until(lambda: (system, name) in self.seen)
        return self.seen.pop((system, name))

    def command(self, number: int, *params: float, system: int = 1, component: int = 1) -> int:
        """Send COMMAND_LONG; its result."""
        values = [*params, *[0.0] * (7 - len(params))]
        self.seen.pop((system, "COMMAND_ACK"), None)
        self.send("command_long", system, component, number, 0, *values)
        ack = self.last("COMMAND_ACK", system)
        assert (ack.command, ack.target_system) == (number, self.mav.srcSystem)
        assert ack.get_srcComponent() == component
        return int(ack.result)

    def is_armed(self, system: int = 1) -> bool:
        return bool(self.last("HEARTBEAT", system).base_mode & 128)

    def upload(self, items: list[tuple[Any, ...]], system: int = 1, type_: int = 0) -> int:
        """Upload items (frame, command, param1..4, x, y, z) of a mission or another plan; the result."""
        self.seen.pop((system, "MISSION_ACK"), None)
        self.seen.pop((system, "MISSION_REQUEST_INT"), None)
        self.send("mission_count", system, 1, len(items), type_)
        while True:
            self.until(lambda: {(system, "MISSION_ACK"), (system, "MISSION_REQUEST_INT")} & self.seen.keys())
            if (system, "MISSION_ACK") in self.seen:
                return int(self.seen[system, "MISSION_ACK"].type)
            seq = self.seen.pop((system, "MISSION_REQUEST_INT")).seq
            frame, command, *rest = items[seq]
            self.send("mission_item_int", system, 1, seq, frame, command, int(seq == 0), 1, *rest, type_)


def fly(
    folder: Path, body: str, *, world: str = "nwu", stations: int = 1, properties: str = "", fastmode: bool = True
) -> list[GroundStation]:
    """Load a scene of robots with MAVLink; its ground stations, whose ``sim`` is the simulation."""
    ports = free_ports(stations, socket.SOCK_DGRAM)
    device = ",".join(f"udpout:127.0.0.1:{port}" for port in ports)
    scene = folder / "scene.py"
    scene.write_text(
        f"from morse.builder import *\n{body}\nenv = Environment('empty', fastmode={fastmode})\n{properties}\n"
        f"env.configure_stream_manager('mavlink', device={device!r}, world={world!r})\n"
    )
    listeners = [GroundStation(port, 255 - number) for number, port in enumerate(ports)]
    sim = morse.load(scene, sockets=True)
    for one in listeners:
        one.sim = sim
    return listeners
