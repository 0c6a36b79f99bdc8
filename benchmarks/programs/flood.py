"""One client that sends as much as it can to one port, until it is killed: ``flood ATTACK {"web": 9090, ...}``."""

from __future__ import annotations

import json
import socket
import struct
import sys
import time
from itertools import count
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

_MASK = b"\0\0\0\0"


def hog(_: dict[str, Any]) -> None:
    """Use a processor, and send nothing: what any program may do."""
    for _ in count():
        pass


# WebSockets -----------------------------------------------------------------------------------


def _websocket(numbers: dict[str, Any], protocol: str = "") -> socket.socket:
    sock = socket.create_connection(("127.0.0.1", numbers["web"]))
    lines = ["GET /ws HTTP/1.1", f"Host: 127.0.0.1:{numbers['web']}", "Upgrade: websocket", "Connection: Upgrade"]
    lines += ["Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Version: 13"]
    lines += [f"Sec-WebSocket-Protocol: {protocol}"] if protocol else []
    sock.sendall("\r\n".join([*lines, "", ""]).encode())
    if b"101" not in sock.recv(4096):
        raise RuntimeError("the server does not open a WebSocket")
    return sock


def _frame(opcode: int, data: bytes) -> bytes:
    if len(data) < 126:
        return bytes([0x80 | opcode, 0x80 | len(data)]) + _MASK + data
    return bytes([0x80 | opcode, 0xFF]) + len(data).to_bytes(8, "big") + _MASK + data


def _send_forever(sock: socket.socket, data: bytes) -> None:
    """Send, and read what comes back without looking at it."""
    sock.setblocking(False)
    rest = b""
    while True:
        try:
            rest = rest or data
            rest = rest[sock.send(rest) :]
        except BlockingIOError:
            time.sleep(0.001)
        try:
            while sock.recv(1 << 16):
                pass
        except BlockingIOError:
            pass


def _pings(protocol: str = "") -> Callable[[dict[str, Any]], None]:
    return lambda numbers: _send_forever(_websocket(numbers, protocol), _frame(9, b"") * 10_000)


def _subscriptions(numbers: dict[str, Any]) -> None:
    frames = (_frame(1, json.dumps({"op": "subscribe", "topic": f"/t{n}", "id": "x" * 500}).encode()) for n in count())
    sock = _websocket(numbers)
    for frame in frames:
        sock.sendall(frame)


def _large_json(numbers: dict[str, Any]) -> None:
    message = b'{"op":"call_service","service":"/x","args":[' + b"[]," * 300_000 + b"0]}"
    _send_forever(_websocket(numbers), _frame(1, message))


def _files(numbers: dict[str, Any]) -> None:
    request = (
        f"GET /worlds/1.json HTTP/1.1\r\nHost: 127.0.0.1:{numbers['web']}\r\nAccept-Encoding: gzip\r\n\r\n".encode()
    )
    while True:
        with socket.create_connection(("127.0.0.1", numbers["web"])) as sock:
            sock.sendall(request)
            while sock.recv(1 << 16):
                pass


# lines ----------------------------------------------------------------------------------------


def _lines(port: str, line: bytes) -> Callable[[dict[str, Any]], None]:
    return lambda numbers: _send_forever(socket.create_connection(("127.0.0.1", numbers[port])), line * 1000)


# YARP -----------------------------------------------------------------------------------------


def _bottle(values: int) -> bytes:
    return struct.pack("<ii", 256, values) + struct.pack("<ii", 1, 7) * values


def _yarp(port: str, command: bytes, values: int) -> Callable[[dict[str, Any]], None]:
    def run(numbers: dict[str, Any]) -> None:
        data = _bottle(values)
        lead = b"\0\0\0\0~" + command + b"\0\1"
        index = bytes((2, 1)) + b"\xff" * 8 + struct.pack("<iii", len(lead), len(data), 0)
        message = b"YA" + struct.pack("<i", 10) + b"RP" + index + lead + data
        while True:
            sock = socket.create_connection(("127.0.0.1", numbers[port]))
            sock.sendall(b"YA" + struct.pack("<i", 7777 + 3) + b"RP" + struct.pack("<i", 6) + b"/flood"[:6])
            try:
                _send_forever(sock, message)
            except OSError:  # closed: again
                time.sleep(0.01)

    return run


def _yarp_text(numbers: dict[str, Any]) -> None:
    while True:
        sock = socket.create_connection(("127.0.0.1", numbers["in"]))
        sock.sendall(b"CONNECT /flood\r\n")
        try:
            _send_forever(sock, b"d\n" + b"(1) " * 200_000 + b"\n")
        except OSError:
            time.sleep(0.01)


# ROS 2 ----------------------------------------------------------------------------------------


def _ros2(size: int) -> Callable[[dict[str, Any]], None]:
    def run(numbers: dict[str, Any]) -> None:
        from morse.middleware.ros2.backends.cyclone import CycloneBackend
        from morse.rosmsgs.table import Qos

        backend = CycloneBackend({"domain_id": numbers["domain"], "interface": ""})
        publisher = backend.publisher("/robot/motion", "geometry_msgs/msg/Twist", Qos(1))
        data = backend.encode("geometry_msgs/msg/Twist", {}) + bytes(size)
        while True:
            if not publisher.publish(data):
                time.sleep(0.0005)

    return run


def _ros2_topics(numbers: dict[str, Any]) -> None:
    from morse.middleware.ros2.backends.cyclone import CycloneBackend
    from morse.rosmsgs.table import Qos

    backend = CycloneBackend({"domain_id": numbers["domain"], "interface": ""})
    publishers = [backend.publisher(f"/foreign{n}", "std_msgs/msg/String", Qos(1)) for n in range(1500)]
    time.sleep(1000.0)
    publishers.clear()


# others ---------------------------------------------------------------------------------------


def _packets(data: bytes) -> Callable[[dict[str, Any]], None]:
    def run(numbers: dict[str, Any]) -> None:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        while True:
            sock.sendto(data, ("127.0.0.1", numbers["own"]))

    return run


def _mavlink_commands(numbers: dict[str, Any]) -> None:
    from pymavlink.dialects.v20 import common

    message = common.MAVLink(None).command_long_encode(0, 0, 400, 0, *[0.0] * 7)
    _packets(message.pack(common.MAVLink(None)) * 30)(numbers)


def _served(numbers: dict[str, Any], greeting: bytes) -> socket.socket:
    """The connection of the simulation to this program, which plays its server; several of them share the port."""
    listener = socket.socket()
    for option in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
        listener.setsockopt(socket.SOL_SOCKET, option, 1)
    listener.bind(("127.0.0.1", numbers["own"]))
    listener.listen()
    sock = listener.accept()[0]
    sock.recv(1 << 16)
    sock.sendall(greeting)
    return sock


def _mqtt(packet: bytes) -> Callable[[dict[str, Any]], None]:
    return lambda numbers: _send_forever(_served(numbers, b"\x20\x02\0\0"), packet * 1000)


def _mqtt_message(topic: bytes, text: bytes) -> bytes:
    return bytes((0x30, 2 + len(topic) + len(text), 0, len(topic))) + topic + text


def _multinode(numbers: dict[str, Any]) -> None:
    robots = {f"stranger{number}": [[1.5, 2.5, 0.5], [0.0, 0.0, 0.1]] for number in range(9900)}
    answer = json.dumps(robots).encode() + b"\n"
    sock = _served(numbers, answer)
    while sock.recv(1 << 16):
        sock.sendall(answer)


ATTACKS: dict[str, tuple[str, Callable[[dict[str, Any]], None]]] = {
    "pings to the live view": ("view", _pings()),
    "files of the live view": ("view", _files),
    "pings to rosbridge": ("rosbridge", _pings()),
    "pings to Foxglove": ("foxglove", _pings("foxglove.websocket.v1")),
    "subscriptions of rosbridge": ("rosbridge", _subscriptions),
    "nested JSON to rosbridge": ("rosbridge", _large_json),
    "requests of services": ("socket", _lines("services", b"1 simulation list_robots\n")),
    "commands on a socket": ("socket", _lines("motion", b'{"v": 0.1, "w": 0.1}\n')),
    "large bottles of YARP": ("yarp", _yarp("in", b"D", 120_000)),
    "bottles of YARP": ("yarp", _yarp("in", b"D", 10_000)),
    "text of YARP": ("yarp", _yarp_text),
    "administration of YARP": ("yarp", _yarp("out", b"a", 400)),
    "Twist of ROS 2": ("ros2", _ros2(0)),
    "8 MB of ROS 2": ("ros2", _ros2(8 << 20)),
    "1500 topics of ROS 2": ("ros2", _ros2_topics),
    "messages of MQTT": ("mqtt", _mqtt(_mqtt_message(b"morse/robot/motion/set", b'{"v": 0.1, "w": 0.1}'))),
    "heartbeats of MQTT": ("mqtt", _mqtt(b"\xd0\0")),
    "robots of a multi-node server": ("multinode", _multinode),
    "messages of MAVLink": ("mavlink", _packets(bytes([0xFD, 9, 0, 0, 0, 1, 1, 84, 0, 0]) * 140)),
    "beginnings of MAVLink": ("mavlink", _packets(b"\xfe" * 1400)),
    "commands of MAVLink": ("mavlink", _mavlink_commands),
}
"""The middleware of the simulation, and the program, by the name of each case."""


def main() -> None:
    """Attack until killed."""
    name, numbers = sys.argv[1], json.loads(sys.argv[2])
    print("begins", flush=True)
    (hog if name == "hog" else ATTACKS[name][1])(numbers)


if __name__ == "__main__":
    main()
