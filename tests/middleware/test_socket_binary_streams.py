"""The port for binary streams: what clients ask for, what they get, and what they may not do."""

import json
import logging
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from morse.middleware.socket_datastream import SocketDatastreamManager, SocketPublisher
from socket_bench import Bench, Peer

from morse.middleware.socket import frames as binary_frames
from pymorse import frames
from tests.kit.waiting import wait_until


class Reader(Peer):
    """A raw client of binary streams."""

    def ask(self, *requests: str) -> None:
        self.send("".join(f"{request}\n" for request in requests).encode())

    def frames(self) -> list[tuple[int, Any]]:
        """Kind and contents of the whole frames that have arrived so far."""
        self.lines()
        found, offset, received = [], 0, bytes(self.received)
        while (head := frames.read_head(received, offset)) and offset + head.size <= len(received):
            found.append((head.kind, frames.decode(received[offset : offset + head.size])))
            offset += head.size
        return found

    def notices(self) -> list[Any]:
        return [contents for kind, contents in self.frames() if kind == frames.NOTICE]

    def messages(self) -> list[Any]:
        return [contents for kind, contents in self.frames() if kind != frames.NOTICE]


def binary_port(bench: Bench) -> int:
    _, (_, port) = bench.requests.on_incoming_request("simulation", "get_binary_port", [])
    return int(port)


@pytest.fixture
def reader(bench: Bench) -> Iterator[Reader]:
    made = Reader(binary_port(bench))
    yield made
    made.close()


def subscribe(reader: Reader, *requests: str) -> None:
    before = len(reader.notices())
    reader.ask(*(f"subscribe {request}" for request in requests))
    wait_until(lambda: len(reader.notices()) == before + len(requests))


def test_a_subscriber_gets_every_message_with_arrays_as_they_are(bench: Bench, reader: Reader) -> None:
    scan = bench.sensor("robot1.scan", port=0)
    scan.local_data["ranges"] = np.array([1.0, np.inf, 2.5])
    subscribe(reader, "robot1.scan")
    for _ in range(3):
        bench.tick()
    wait_until(lambda: len(reader.messages()) == 3)
    assert [message["timestamp"] for message in reader.messages()] == [0.0, 1 / 60, 2 / 60]
    ranges = reader.messages()[0]["ranges"]
    assert ranges.dtype == np.float64
    assert ranges.tolist() == [1.0, np.inf, 2.5]


def test_the_streams_of_several_sensors_share_a_connection(bench: Bench, reader: Reader) -> None:
    for name in ("robot1.a", "robot1.b", "robot1.c"):
        bench.sensor(name, port=0).local_data["name"] = name
    subscribe(reader, "robot1.a", "robot1.c")
    bench.tick()
    wait_until(lambda: len(reader.messages()) == 2)
    assert [message["name"] for message in reader.messages()] == ["robot1.a", "robot1.c"]


def test_clients_of_lines_and_of_frames_get_the_same_data(bench: Bench, reader: Reader) -> None:
    bench.sensor(port=0)
    client = bench.connect("robot1.pose")
    subscribe(reader, "robot1.pose")
    bench.tick()
    wait_until(lambda: client.lines() and reader.messages())
    assert client.lines() == [b'{"timestamp": 0.0, "temperature": 20.5}']
    assert reader.messages() == [{"timestamp": 0.0, "temperature": 20.5}]
    client.close()


def test_nothing_is_encoded_for_frames_while_nobody_subscribes(
    bench: Bench, reader: Reader, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.sensor("robot1.other", port=0)
    bench.sensor(port=0)
    subscribe(reader, "robot1.other")
    encoded = []
    send = SocketDatastreamManager.send
    monkeypatch.setattr(
        SocketDatastreamManager,
        "send",
        lambda self, stream, payload: (encoded.append(stream.component_name), send(self, stream, payload))[1],
    )
    bench.tick()
    assert encoded == ["robot1.other"]


def test_of_a_latest_subscription_one_message_is_sent_for_each_request(bench: Bench, reader: Reader) -> None:
    bench.sensor(port=0)
    subscribe(reader, "robot1.pose latest")
    channel = bench.streams._binary.channels["robot1.pose"]
    for _ in range(5):
        bench.tick()
    wait_until(reader.messages)
    reader.ask("next robot1.pose")
    wait_until(lambda: channel.ready)
    for _ in range(5):
        bench.tick()
    wait_until(lambda: len(reader.messages()) == 2)
    first, second = (message["timestamp"] for message in reader.messages())
    assert first <= 4 / 60 < second


def test_nothing_is_sent_after_unsubscribing(bench: Bench, reader: Reader) -> None:
    bench.sensor(port=0)
    subscribe(reader, "robot1.pose")
    server = bench.streams._servers["robot1.pose"]
    assert server.readers
    reader.ask("unsubscribe robot1.pose")
    wait_until(lambda: not server.readers)
    bench.tick()
    assert not bench.streams._frame_parcels
    assert reader.messages() == []


def test_a_client_that_leaves_is_forgotten(bench: Bench) -> None:
    bench.sensor(port=0)
    bench.sensor("robot1.other", port=0)
    leaving = Reader(binary_port(bench))
    subscribe(leaving, "robot1.pose", "robot1.other latest")
    leaving.close()
    wait_until(lambda: not any(server.readers for server in bench.streams._servers.values()))
    bench.tick()
    assert bench.streams._binary.connected == 0


def test_the_end_of_a_component_is_told(bench: Bench, reader: Reader) -> None:
    sensor = bench.sensor(port=0)
    subscribe(reader, "robot1.pose")
    bench.streams.disconnect(sensor)
    bench.components.remove(sensor)
    wait_until(lambda: reader.notices()[-1] == {"closed": "robot1.pose"})
    again = bench.sensor(port=0)
    subscribe(reader, "robot1.pose")
    again.local_data["temperature"] = 5.0
    bench.tick()
    wait_until(reader.messages)
    assert reader.messages()[-1]["temperature"] == 5.0


class Verse(SocketPublisher):
    """Writes its own lines."""

    def encode(self) -> str:
        return '{"verse": 1}'


def test_lines_that_a_publisher_writes_itself_are_carried(bench: Bench, reader: Reader) -> None:
    bench.sensor("robot1.poet", port=0)
    stream = bench.streams.streams["robot1.poet"][0]
    stream.__class__ = Verse
    stream.initialize()
    subscribe(reader, "robot1.poet")
    bench.tick()
    wait_until(reader.messages)
    assert reader.frames()[-1] == (frames.LINE, {"verse": 1})


def test_a_name_that_does_not_exist_is_answered_with_the_nearest_one(bench: Bench, reader: Reader) -> None:
    bench.sensor(port=0)
    reader.ask("subscribe robot1.pos")
    (notice,) = wait_until(reader.notices)
    assert notice["subject"] == "robot1.pos"
    assert "robot1.pose" in notice["error"]


def test_an_actuator_has_no_binary_stream(bench: Bench, reader: Reader) -> None:
    bench.actuator(port=0)
    reader.ask("subscribe robot1.motion")
    (notice,) = wait_until(reader.notices)
    assert "no stream" in notice["error"]


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.binary(max_size=40) | st.sampled_from([b"next x", b"subscribe", b"unsubscribe robot1.pose extra"])))
def test_requests_that_are_none_hurt_nobody(bench: Bench, requests: list[bytes]) -> None:
    if not bench.components:
        bench.sensor(port=0)
    reader = Reader(binary_port(bench))
    try:
        # not the greeting of another protocol, which ends the connection
        reader.send(b"?\n" + b"\n".join(request.replace(b"\n", b"") for request in requests) + b"\n")
        reader.ask("subscribe robot1.pose")
        wait_until(lambda: {"subscribed", "stream"} <= set((reader.notices() or [{}])[-1]))
        bench.tick()
        wait_until(reader.messages)
    finally:
        reader.close()


@pytest.mark.parametrize("hello", [b"GET / HTTP/1.1\r\n\r\nsubscribe robot1.pose\n", b"\x16\x03\x01\x02\x00\x01"])
def test_browsers_are_turned_away(bench: Bench, reader: Reader, hello: bytes) -> None:
    bench.sensor(port=0)
    reader.send(hello)
    wait_until(reader.has_ended)
    assert reader.received == b""


def test_a_frame_sent_to_a_port_of_lines_hurts_nobody(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    motion = bench.actuator(port=0)
    bench.sensor(port=0)
    frame = frames.HEAD.pack(b"MF", 1, 1, 1, 0, 0)
    peers = [bench.connect("robot1.motion"), bench.connect("robot1.pose"), bench.connect()]
    for peer in peers:
        peer.send(frame + b"\n")
    peers[0].send(b'{"v": 1.0}\n')
    bench.tick_until(lambda: motion.local_data["v"] == 1.0)
    assert "cannot be read" in caplog.text
    # the frame is answered as well, at any time
    bench.tick_until(peers[2].lines)
    assert b"SUCCESS 3" in bench.call(peers[2], b"1 robot1.motion add [1, 2]\n")
    bench.tick_until(peers[1].lines)
    for peer in peers:
        peer.close()


def test_a_client_that_never_reads_gets_the_latest_of_each_stream(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    names = ("robot1.a", "robot1.b")
    for name in names:
        bench.sensor(name, port=0).local_data["image"] = np.zeros(200_000, "u1")
    deaf = Reader(binary_port(bench))
    subscribe(deaf, *names)
    (client,) = bench.streams._binary.clients
    bench.tick_until(lambda: len(client._waiting) == 2)
    for _ in range(5):
        bench.tick()
    wait_until(lambda: "reads too slowly" in caplog.text)
    assert caplog.text.count("reads too slowly") == 1
    last = bench.context.clock.tick
    for component in bench.components:
        component.local_data["image"] = np.array([last], "i4")
    bench.tick()

    def latest() -> bool:
        newest = [message["image"][-1] for message in deaf.messages() if message["image"].dtype == np.int32]
        return newest == [last, last]

    wait_until(latest)
    deaf.close()


def test_a_client_that_asks_without_reading_is_disconnected(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.WARNING)
    monkeypatch.setattr(binary_frames, "MAX_NOTICES", 1000)
    bench.sensor(port=0)
    deaf = Reader(binary_port(bench))
    wait_until(lambda: bench.streams._binary.connected == 1)
    (client,) = bench.streams._binary.clients
    client.transport.high_water = 1000
    deaf.socket.settimeout(60.0)
    with pytest.raises(ConnectionError):
        deaf.socket.sendall(b"subscribe robot1.pose\n" * 1_000_000)
    wait_until(lambda: bench.streams._binary.connected == 0)
    assert "makes requests without reading" in caplog.text
    deaf.close()


def test_a_client_that_only_sends_wrong_requests_is_disconnected(
    bench: Bench, reader: Reader, caplog: pytest.LogCaptureFixture
) -> None:
    bench.sensor(port=0)
    reader.ask("subscribe robot1.pose " + "x " * 5000)
    wait_until(lambda: "at most 4096 bytes" in json.dumps(reader.notices()))
    reader.send(b"subscribe nothing.at.all\n" * 1000)
    wait_until(lambda: bench.streams._binary.connected == 0)
    assert "has sent 1000 wrong requests: disconnected" in caplog.text


def test_messages_count_for_clients_that_step(bench: Bench, reader: Reader) -> None:
    bench.sensor(port=0)
    subscribe(reader, "robot1.pose")
    for _ in range(3):
        bench.tick()
    wait_until(lambda: len(reader.messages()) == 3)
    host, port = reader.socket.getsockname()

    async def sent() -> dict[str, int]:
        return bench.streams.sent()

    counted = bench.context.network.call(sent())
    assert counted == {f"{host}:{port} {binary_port(bench)}": 3}
