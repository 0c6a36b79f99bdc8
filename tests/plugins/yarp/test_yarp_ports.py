"""Ports of YARP: how they are registered, connected, administered, commanded and abused."""

import asyncio
import json
import socket
import struct
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from yarp_names import Names
from yarp_wire import Line, Reader, exactly, number

from morse.core.exceptions import MorseError
from morse.plugins.yarp.bottle import decode, encode
from tests.kit.waiting import step_until

LIMIT = 100.0
#: the carrier tcp, and the name of a sender
BEGIN, NAME = b"YA\xe4\x1e\0\0RP", struct.pack("<i", 3) + b"/a\0"
POSE, MOTION = "/morse/robot/pose/out", "/morse/robot/motion/in"
BOTH = """
pose = Pose(); robot.append(pose)
motion = MotionXYW(); robot.append(motion)
robot.add_default_interface("yarp")
"""


def meanwhile(sim: Any, work: Callable[[], Any]) -> Any:
    """Step while another thread works; returns its result."""
    with ThreadPoolExecutor(1) as pool:
        future = pool.submit(work)
        step_until(sim, future.done)
        return future.result()


@pytest.fixture
def reader(names: Names) -> Iterator[Reader]:
    made = Reader()
    names.known["/reader"] = made.address
    yield made
    made.close()


def connect(names: Names, source: str, target: str) -> str:
    line = Line(names.known[source], "CONNACK", "admin")
    assert line.welcome == "Welcome admin"
    line.say("a", f'[add] "{target}"')
    answer, acknowledged = line.hear(), line.hear()
    assert acknowledged == "<ACK>"
    line.close()
    return answer


@pytest.mark.parametrize("carrier", ["tcp", "fast_tcp"])
def test_a_port_that_is_connected_gets_the_fields_in_their_order(
    load: Callable[..., Any], names: Names, reader: Reader, carrier: str
) -> None:
    sim = load(names.port, BOTH)
    reader.acknowledges = carrier == "tcp"
    step_until(sim, lambda: POSE in names.known)

    def work() -> tuple[str, bytes, str, list[Any], list[Any]]:
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(connect, names, POSE, f"{carrier}://reader")
            begin, name = reader.accept()
            return future.result(), begin, name, decode(reader.read()), decode(reader.read())

    answer, begin, name, first, second = meanwhile(sim, work)
    assert answer.startswith('0 "Added connection')
    # the numbers of the documentation, with acknowledgements and without
    assert begin == (b"YA\xe4\x1e\0\0RP" if carrier == "tcp" else b"YA\x64\x1e\0\0RP")
    assert name == POSE
    assert first[1:] == pytest.approx([1.0, 2.0, 0.5, 0.0, 0.0, 0.0])
    assert second[0] - first[0] == pytest.approx(1 / 60)


def test_a_port_is_administered(load: Callable[..., Any], names: Names, reader: Reader) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: POSE in names.known)

    def work() -> list[str]:
        line = Line(names.known[POSE], "CONNACK", "admin")

        def ask(*words: str) -> str:
            line.say(*words)
            answer = line.hear()
            assert line.hear() == "<ACK>"
            return answer

        said = [ask("a", "[ver]"), ask("a", '[list] [out] "/reader"'), ask("a", '[add] "udp://reader"')]
        said += [ask("a", '[add] "tcp://nobody"'), ask("a", "[what]"), ask("nonsense")]
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(ask, "/reader")
            reader.accept()
            said.append(future.result())
        said += [ask("a", "[list] [out]"), ask("a", '[list] [out] "/reader"'), ask("a", '[del] "/reader"')]
        return [*said, ask("a", "[list] [out]")]

    said = meanwhile(sim, work)
    assert said[0] == "[ver] 1 2 3"
    assert said[1] == ""
    assert "carrier udp" in said[2]
    assert "tcp and fast_tcp" in said[2]
    assert "Do not know how to connect to /nobody" in said[3]
    assert said[4].startswith("[fail]")
    assert said[5] == "Port command not understood."
    assert said[6] == f"Added connection from {POSE} to /reader"
    assert said[7] == '"/reader"'
    assert said[8] == f'(from "{POSE}") (to "/reader") (carrier tcp)'
    assert said[9].startswith("0 ")
    assert said[10] == ""


def test_bottles_command_an_actuator(load: Callable[..., Any], names: Names) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: MOTION in names.known)
    data = sim.context.components["robot.motion"].local_data
    assert list(data) == ["x", "y", "w"]
    line = Line(names.known[MOTION])
    line.say("d", "0.5 -1")
    step_until(sim, lambda: data["y"] == -1.0)
    assert (data["x"], data["w"]) == (0.5, 0.0)
    with socket.create_connection(names.known[MOTION], timeout=LIMIT) as binary:
        # the header, and a message, of the documentation
        binary.sendall(b"YA\xe4\x1e\0\0RP" + struct.pack("<i", 5) + b"/cmd\0")
        assert exactly(binary, 8) == number(names.known[MOTION][1])
        bottle = encode([0.0, 0.0, 0.25])
        index = bytes((2, 1)) + b"\xff" * 8 + struct.pack("<3i", 8, len(bottle), 0)
        binary.sendall(number(10) + index + b"\0\0\0\0~D\0\1" + bottle)
        assert exactly(binary, 8) == number(0)
        step_until(sim, lambda: data["w"] == 0.25)
        assert data["x"] == 0.0
        # who sends "d" waits for a reply, which comes before the acknowledgement
        binary.sendall(number(10) + index + b"\0\0\0\0~d\0\1" + bottle)
        assert decode(exactly(binary, 8)) == []
        assert exactly(binary, 8) == number(0)
    line.close()


def test_a_wrong_bottle_is_refused_as_a_whole(
    load: Callable[..., Any], names: Names, caplog: pytest.LogCaptureFixture
) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: MOTION in names.known)
    data = sim.context.components["robot.motion"].local_data
    line = Line(names.known[MOTION])
    for wrong in ("0.5 fast", "nan 1", "1 2 3 4", "(1 2) 3", "1 (2"):
        line.say("d", wrong)
    line.say("d", "0.125")
    step_until(sim, lambda: data["x"] == 0.125)
    assert data["y"] == 0.0
    for text in ("it has 4 values, expected at most 3: x, y, w", "a bracket is not closed", "'y' is 'fast'"):
        assert text in caplog.text
    line.close()


@pytest.mark.parametrize(
    "data",
    [
        b"GET / HTTP/1.1\r\n\r\n",
        b"CONNECT 127.0.0.1:4000 HTTP/1.1\r\n\r\n",
        b"YA\x61\x1e\0\0RP",
        BEGIN + struct.pack("<i", 2**31 - 1),
        BEGIN + NAME + number(11),
        BEGIN + NAME + number(10) + b"\1\1" + b"\xff" * 8 + b"\xff\xff\xff\x7f" * 2,
        BEGIN + NAME + number(10) + b"\1\0" + b"\xff" * 8 + b"\x08\0\0\0" + b"12345678",
        b"CONNECT x\r\na\r\n" + b"(" * 5000 + b"\r\n",
        b"CONNECT x\r\na\r\n\xff\xfe\r\n",
        b"CONNECT " + b"x" * (2 << 20),
    ],
)  # fmt: skip
def test_a_client_with_another_protocol_is_disconnected(load: Callable[..., Any], names: Names, data: bytes) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: MOTION in names.known)
    with socket.create_connection(names.known[MOTION], timeout=LIMIT) as stranger:
        try:
            stranger.sendall(data)
            while stranger.recv(1000):
                pass
        except ConnectionError:
            pass  # closed while more was sent
    # the port still serves others
    line = Line(names.known[MOTION])
    line.say("d", "0.5")
    step_until(sim, lambda: sim.context.components["robot.motion"].local_data["x"] == 0.5)
    line.close()


def test_a_client_that_rests_when_the_simulation_ends_is_no_fault(
    load: Callable[..., Any], names: Names, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def rest(_sender: object) -> None:
        resting.set()
        await asyncio.sleep(LIMIT)

    resting = threading.Event()
    monkeypatch.setattr("morse.core.clients.budgets.Sender.rest", rest)
    with load(names.port, BOTH) as sim:
        step_until(sim, lambda: MOTION in names.known)
        host, port = names.known[MOTION]
        client = socket.create_connection((host, port), timeout=LIMIT)
        client.sendall(b"CONNECT /a\nd\n0 0 0\n")
        assert resting.wait(LIMIT)
    client.close()
    assert "Exception in callback" not in caplog.text


def test_the_ports_are_on_this_machine_only(load: Callable[..., Any], names: Names) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: {POSE, MOTION} <= names.known.keys())
    assert {host for name, (host, _) in names.known.items() if name.startswith("/morse")} == {"127.0.0.1"}
    with socket.socket() as other:
        # another address of the loopback network: a port on all interfaces would answer
        assert other.connect_ex(("127.0.0.2", names.known[POSE][1])) != 0


def test_ports_are_registered_when_a_name_server_comes_and_removed_at_the_end(
    load: Callable[..., Any], names: Names, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("morse.plugins.yarp.ports._RETRY", 0.02)
    monkeypatch.setattr("morse.plugins.yarp.ports._CHECK", 0.02)
    monkeypatch.setattr("morse.plugins.yarp.ports._FAREWELL", 60.0)
    port = names.port
    names.close()
    sim = load(port, BOTH)
    step_until(sim, lambda: "there is no name server" in caplog.text)
    came = Names(port)
    step_until(sim, lambda: {POSE, MOTION} <= came.known.keys())
    # a name server that is started again knows nothing
    came.known.clear()
    step_until(sim, lambda: {POSE, MOTION} <= came.known.keys())
    sim.close()
    assert not came.known
    came.close()


def test_the_port_of_another_program_is_not_taken_away(
    load: Callable[..., Any],
    names: Names,
    reader: Reader,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    monkeypatch.setattr("morse.plugins.yarp.ports._CHECK", 0.02)
    names.known[POSE] = reader.address
    sim = load(names.port, BOTH)
    step_until(sim, lambda: f"{POSE} is the port of another program" in caplog.text and MOTION in names.known)
    assert names.known[POSE] == reader.address
    # it ends without saying so
    reader.close()
    step_until(sim, lambda: names.known[POSE] != reader.address)


def test_the_ports_of_a_deleted_robot_are_closed(load: Callable[..., Any], names: Names) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: {POSE, MOTION} <= names.known.keys())
    sim.delete("robot")
    step_until(sim, lambda: not names.known.keys() & {POSE, MOTION})


def test_a_name_server_that_does_not_answer_holds_nobody_up(
    load: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("morse.plugins.yarp.ports._FAREWELL", 0.05)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        sim = load(silent.getsockname()[1], BOTH)
        client, _ = silent.accept()
        sim.step(30)
        sim.delete("robot")
        sim.step(30)
        assert sim.ticks == 60
        # nothing has come that ends the request of the simulation
        sim.close()
        client.close()


def test_a_reader_that_stops_reading_loses_messages_and_holds_nobody_up(
    load: Callable[..., Any], names: Names, reader: Reader, caplog: pytest.LogCaptureFixture
) -> None:
    sim = load(names.port, BOTH)
    step_until(sim, lambda: POSE in names.known)

    def work() -> None:
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(connect, names, POSE, "/reader")
            reader.accept()
            future.result()

    meanwhile(sim, work)
    # nothing is acknowledged
    step_until(sim, lambda: f"/reader is too slow for {POSE}" in caplog.text)
    assert sim.ticks >= 64
    reader.close()
    port = sim.context.stream_managers["morse.middleware.yarp_datastream.YarpDatastreamManager"].streams["robot.pose"][
        0
    ]
    step_until(sim, lambda: not port.port.outputs)


def test_two_components_cannot_have_one_port(
    load: Callable[..., Any], names: Names, caplog: pytest.LogCaptureFixture
) -> None:
    wrong = "a = Pose(); a.add_stream('yarp', port='/lab/x'); robot.append(a)\n"
    with pytest.raises(MorseError, match=r"the port /lab/x is that of robot\.a; set port='\.\.\.' for one of them"):
        load(names.port, wrong + wrong.replace("a =", "b =").replace("a.", "b.").replace("(a)", "(b)"))
    with pytest.raises(MorseError, match="the port is 'lab', expected a name such as '/lab/pose'"):
        load(names.port, "a = Pose(); a.add_stream('yarp', port='lab'); robot.append(a)\n")
    assert "AttributeError" not in caplog.text, "a stream that has not begun is ended"


def test_json_texts_are_carried_both_ways(load: Callable[..., Any], names: Names, reader: Reader) -> None:
    sim = load(names.port, BOTH.replace('"yarp"', '"yarp_json"'))
    step_until(sim, lambda: {POSE, MOTION} <= names.known.keys())
    line = Line(names.known[MOTION])
    line.say("d", r'"{\"w\": 0.5}"')
    step_until(sim, lambda: sim.context.components["robot.motion"].local_data["w"] == 0.5)
    line.close()

    def work() -> list[Any]:
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(connect, names, POSE, "/reader")
            reader.accept()
            future.result()
            return decode(reader.read())

    (text,) = meanwhile(sim, work)
    assert list(json.loads(text)) == ["timestamp", "x", "y", "z", "yaw", "pitch", "roll"]


def test_a_bottle_becomes_a_dictionary_where_the_field_is_one(load: Callable[..., Any], names: Names) -> None:
    sim = load(names.port, "light = Light(); robot.append(light)\nrobot.add_default_interface('yarp')\n")
    step_until(sim, lambda: "/morse/robot/light/in" in names.known)
    data = sim.context.components["robot.light"].local_data
    line = Line(names.known["/morse/robot/light/in"])
    for word, wanted in (("0", False), ("true", True), ("false", False), ("1", True)):
        line.say("d", word)
        step_until(sim, lambda wanted=wanted: data["emit"] is wanted)
    line.close()
