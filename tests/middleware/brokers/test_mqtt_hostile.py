"""Brokers that send something else than MQTT, packets without end, or messages that they never complete."""

import socket
import struct
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import morse
from morse.builder import ATRV, Environment, MotionVW

pytest.importorskip("paho.mqtt")

WELCOME = b"\x20\x02\x00\x00"
TOPIC = b"morse/robot/motion/set"


def message(payload: bytes, number: int) -> bytes:
    """A message with QoS 2."""
    body = struct.pack(">H", len(TOPIC)) + TOPIC + struct.pack(">H", number) + payload
    return b"\x34" + bytes([len(body) % 128 | 128, len(body) // 128]) + body


class Broker(threading.Thread):
    """Says the same to everybody, and then nothing."""

    def __init__(self, said: bytes) -> None:
        super().__init__()
        self._said = said
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self._ending = False

    def run(self) -> None:
        while not self._ending:
            connection, _ = self._listener.accept()
            with connection:
                try:
                    connection.recv(4096)
                    connection.sendall(self._said)
                    while not self._ending and connection.recv(4096):
                        pass
                except ConnectionError:
                    pass

    def end(self) -> None:
        self._ending = True
        socket.create_connection(("127.0.0.1", self.port), timeout=60.0).close()
        self.join(60.0)
        # the simulation has closed its connection, else this thread still reads it
        assert not self.is_alive()
        self._listener.close()


@pytest.fixture
def simulation_with() -> Iterator[Callable[[bytes], Any]]:
    """Call it with what the broker says."""
    ends: list[Callable[[], object]] = []

    def start(said: bytes) -> Any:
        broker = Broker(said)
        broker.start()

        def scene() -> None:
            robot, motion = ATRV("robot"), MotionVW("motion")
            motion.add_stream("mqtt")
            robot.append(motion)
            env = Environment("empty", fastmode=True)
            env.configure_stream_manager("mqtt", port=broker.port)

        simulation = morse.load(scene, sockets=True)
        ends.extend((broker.end, simulation.close))
        return simulation

    yield start
    for end in reversed(ends):
        end()


@pytest.mark.parametrize(
    ("said", "line"),
    [
        (b"HTTP/1.1 400 Bad Request\r\n".ljust(200), "does not answer as a broker"),
        (WELCOME + b"\x30\xff\xff\xff\x7f", "a packet of 268435455 bytes, 4194304 are allowed"),
        (WELCOME + b"".join(message(b"{}", n) for n in range(1, 70)), "does not complete its messages with QoS 2"),
        (WELCOME + b"\x30\x04\x00\x02\xff\xfe", "a packet cannot be read ('utf-8' codec can't decode"),
        (b"\x20\x02\x00\x05", "refuses the connection: Not authorized"),
    ],
    ids=["not a broker", "huge packet", "incomplete messages", "a topic that is not text", "refusal"],
)
def test_a_hostile_broker_is_left_and_named_once(
    simulation_with: Callable[[bytes], Any], said: bytes, line: str, caplog: pytest.LogCaptureFixture
) -> None:
    simulation = simulation_with(said)
    ended = threading.Event()
    limit = threading.Timer(60.0, ended.set)
    limit.start()
    while line not in caplog.text and not ended.is_set():
        simulation.step()
    limit.cancel()
    (only,) = [text for text in caplog.messages if text.startswith("mqtt: ") and "is expected" not in text
               and "connected to" not in text]  # fmt: skip
    assert line in only
