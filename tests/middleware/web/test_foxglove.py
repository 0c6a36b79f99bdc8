"""Foxglove with a client of its published protocol in another process, and with malicious clients."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from peers import need, talk
from websockets.exceptions import InvalidHandshake
from websockets.sync.client import connect

import morse
from morse.middleware.foxglove.datastream import FoxgloveHub
from morse.middleware.web.hub import hub_of
from tests.kit.scenes import Load

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

SCENE = """
from morse.builder import *
robot = ATRV()
motion = MotionVW(); robot.append(motion)
{components}
robot.add_default_interface("foxglove")
env = Environment("empty")
env.configure_stream_manager("foxglove", port=0{options})
"""
SENSORS = """
waypoint = Waypoint(); robot.append(waypoint)
odometry = Odometry(); robot.append(odometry)
scan = Hokuyo(); scan.translate(x=0.3, z=0.6); robot.append(scan)
"""
LIMIT = 60.0
"""Wall-clock seconds in which a message has to arrive."""
PROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"]


@pytest.fixture
def start(load: Load) -> Load:
    def start(components: str = "", options: str = "") -> tuple[Any, int]:
        sim = load(SCENE.format(components=components, options=options), sockets=True)
        return sim, hub_of(sim.context, FoxgloveHub).server.port

    return start


def opened(port: int, *protocols: str, **options: Any) -> ClientConnection:
    # with room for all messages: a client that has not read them all would wait ten seconds for the answer to its close
    options = {"subprotocols": protocols or PROTOCOLS, "proxy": None, "max_queue": None, **options}
    return connect(f"ws://127.0.0.1:{port}", **options).__enter__()


def until(sim: Any, client: ClientConnection, wanted: Callable[[Any], bool]) -> Any:
    """Step until a message fulfils a condition."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        sim.step()
        while True:
            try:
                frame = client.recv(timeout=0.002)
            except TimeoutError:
                break
            message = json.loads(frame) if isinstance(frame, str) else frame
            if wanted(message):
                return message
    raise AssertionError("no such message")


def op(name: str) -> Callable[[Any], bool]:
    return lambda message: isinstance(message, dict) and message["op"] == name


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_client_that_knows_the_written_protocol(start: Callable[..., tuple[Any, int]], protocol: str) -> None:
    need("rosbags")
    sim, port = start(SENSORS)
    seen = talk("foxglove_peer.py", sim.step, port, protocol)
    assert seen["subprotocol"] == protocol
    assert seen["channels"]["/robot/odometry"] == ["cdr", "nav_msgs/msg/Odometry", "ros2msg"]
    assert {"/clock", "/tf", "/tf_static", "/robot/scan"} <= seen["channels"].keys()
    # commanded first as JSON, then, twice as fast, as CDR
    assert seen["speed"] == pytest.approx(0.5, abs=0.02)
    assert seen["child"] == "robot/base_link"
    # the time of a message is that of its measurement, in simulated time
    assert seen["stamps"][0] == seen["stamps"][1]
    assert 0 < seen["time"] <= sim.clock.stamp()
    first, last, step, count = seen["/robot/scan"]
    assert count == round((last - first) / step) + 1
    assert {"robot/odom", "robot/scan"} <= set(seen["/tf_static"])
    (described,) = [one for one in seen["services"] if one["name"] == "/robot/motion/set_speed"]
    assert json.loads(described["request"]["schema"])["required"] == ["v", "w"]
    assert seen["calls"]["1"] == {"result": "Arrived"}
    assert "no argument somewhere" in seen["calls"]["2"]
    # on its way already: how far depends on when the client asks
    assert -0.01 < seen["calls"]["3"]["x"] < seen["way"] + 0.3
    assert "others" not in seen, "nothing was refused"


def test_a_client_of_another_protocol_is_turned_away(start: Callable[..., tuple[Any, int]]) -> None:
    _, port = start()
    for protocols in (("chat",), ()):
        with pytest.raises(InvalidHandshake):
            connect(f"ws://127.0.0.1:{port}", subprotocols=protocols or None, proxy=None).__enter__()  # type: ignore[arg-type]


def test_only_pages_that_the_script_names(start: Callable[..., tuple[Any, int]]) -> None:
    _, port = start(options=", origins=['https://app.foxglove.dev']")
    opened(port, origin="https://app.foxglove.dev").close()
    with pytest.raises(InvalidHandshake):
        opened(port, origin="https://app.foxglove.dev.evil.example")


BAD: list[tuple[str | bytes, str]] = [
    ("[" * 100_000, "not JSON"),
    ("[1, 2]", "is not supported"),
    ('{"op":"subscrib"}', "did you mean 'subscribe'"),
    ('{"op":"subscribe"}', "expected a list"),
    ('{"op":"subscribe","subscriptions":[{"id":1,"channelId":999}]}', "no channel 999"),
    ('{"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]}', "from 0 to"),
    ('{"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":1}]}', "subscribed already"),
    ('{"op":"unsubscribe","subscriptionIds":[5]}', "no subscription 5"),
    ('{"op":"advertise","channels":[{"id":1,"topic":"/robot/cmd_val"}]}', "did you mean '/robot/cmd_vel'"),
    ('{"op":"advertise","channels":[{"id":1,"topic":"/robot/cmd_vel","encoding":"protobuf"}]}', "none of cdr, json"),
    ('{"op":"advertise","channels":[{"id":1,"topic":"/robot/cmd_vel","encoding":"cdr","schemaName":"a/B"}]}', "type"),
    ('{"op":"getParameters"}', "expected a list of texts"),
    ('{"op":"getParameters","parameterNames":[],"id":5}', "expected a text"),
    ('{"op":"setParameters","parameters":[1]}', "expected a list of objects"),
    ('{"op":"setParameters","parameters":[{"name":"robot.motion.ControlTyp","value":1}]}', "robot.motion.ControlType"),
    ('{"op":"setParameters","parameters":[{"name":"robot.motion.ControlType"}]}', "cannot be removed"),
    ('{"op":"setParameters","parameters":[{"name":"robot.motion.ControlType","value":[[]]}]}', "ControlType"),
    ('{"op":"setParameters","parameters":[{"name":{},"value":1}]}', "there is no parameter"),
    ('{"op":"subscribeParameterUpdates","parameterNames":{}}', "expected a list of texts"),
    ('{"op":"unsubscribeConnectionGraph"}', "is not subscribed"),
    ('{"op":"fetchAsset","uri":5,"requestId":1}', "expected a text"),
    ('{"op":"fetchAsset","uri":"file:///etc/passwd"}', "'requestId' is"),
    (b"", "not a message of a client"),
    (b"\1\0", "not a message of a client"),
    (struct.pack("<BI", 1, 77), "was not advertised"),
    (struct.pack("<BIII", 2, 1, 1, 2**31), "not a message of a client"),
    (b"\x09abc", "opcode 9"),
]


@pytest.mark.parametrize(("frame", "answer"), BAD, ids=[answer for _, answer in BAD])
def test_what_is_wrong_is_answered(start: Callable[..., tuple[Any, int]], frame: str | bytes, answer: str) -> None:
    sim, port = start()
    client = opened(port)
    client.send(frame)
    status = until(sim, client, op("status"))
    assert (status["level"], answer in status["message"]) == (2, True), status
    client.send(struct.pack("<BIII", 2, 4_000_000, 1, 4) + b"json{}")
    assert "no service" in until(sim, client, op("serviceCallFailure"))["message"]
    client.close()


def test_watched_parameters_are_told_once_for_each_change(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start()
    client = opened(port)
    name = "robot.motion.ControlType"
    client.send(json.dumps({"op": "subscribeParameterUpdates", "parameterNames": [name, name, "robot.ghost.Speed"]}))
    told = op("parameterValues")
    assert until(sim, client, told)["parameters"] == [{"name": name, "value": "Velocity"}]
    sim.rpc("robot.motion", "set_property", "ControlType", "Position")
    assert until(sim, client, told)["parameters"] == [{"name": name, "value": "Position"}]
    client.send(json.dumps({"op": "unsubscribeParameterUpdates", "parameterNames": [name]}))
    client.send(json.dumps({"op": "getParameters", "parameterNames": ["robot.ghost.Speed", "robot"], "id": "x"}))
    answer = until(sim, client, told)
    assert (answer["parameters"], answer["id"]) == ([], "x")
    client.close()


def test_files_are_not_read_for_strangers(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start()
    client = opened(port)
    uris = ["file:///etc/passwd", "package://a/../../etc/passwd", "", "\0", "/etc/passwd", "x" * 10_000]
    for number, uri in enumerate(uris):
        client.send(json.dumps({"op": "fetchAsset", "uri": uri, "requestId": number}))
    for number in range(len(uris)):
        frame = until(sim, client, lambda message: isinstance(message, bytes) and message[0] == 4)
        request, failed, length = struct.unpack_from("<IBI", frame, 1)
        assert (request, failed, len(frame)) == (number, 1, 10 + length)
    client.close()


def test_commands_that_do_not_fit_change_nothing(
    start: Callable[..., tuple[Any, int]], caplog: pytest.LogCaptureFixture
) -> None:
    sim, port = start()
    client = opened(port)
    channel = {"id": 1, "topic": "/robot/cmd_vel", "encoding": "cdr", "schemaName": "geometry_msgs/msg/Twist"}
    client.send(json.dumps({"op": "advertise", "channels": [channel]}))
    head = struct.pack("<BI", 1, 1)
    nan = b"\0\1\0\0" + struct.pack("<6d", *[float("nan")] * 6)
    for data in (b"", b"\0", b"\0\1\0\0", b"\0\1\0\0" + bytes(20), nan, b"\xff" * 60, b"{}}", b'{"linear":{"x":"a"}}'):
        client.send(head + data)
    client.send(struct.pack("<BIII", 2, 4_000_000, 1, 4) + b"json{}")
    until(sim, client, op("serviceCallFailure"))
    sim.step(2)
    data = sim.context.components["robot.motion"].local_data
    assert (data["v"], data["w"]) == (0.0, 0.0)
    assert "robot.motion" not in sim.context.failed
    assert "a message on /robot/cmd_vel is refused" in caplog.text
    client.close()


def test_topics_and_services_that_come_and_go_are_told(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start("odometry = Odometry(); robot.append(odometry)")
    client = opened(port)
    channels = until(sim, client, op("advertise"))["channels"]
    (number,) = [channel["id"] for channel in channels if channel["topic"] == "/robot/odometry"]
    services = until(sim, client, op("advertiseServices"))["services"]
    sim.delete("robot")
    mine = {one["id"] for one in services if one["name"].startswith("/robot/")}
    channels_gone: set[int] = set()
    services_gone: set[int] = set()

    def all_gone(message: Any) -> bool:
        if op("unadvertise")(message):
            channels_gone.update(message["channelIds"])
        if op("unadvertiseServices")(message):
            services_gone.update(message["serviceIds"])
        return number in channels_gone and services_gone == mine

    until(sim, client, all_gone)
    client.close()


def test_the_example_of_the_documentation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    page = (Path(__file__).parents[3] / "docs" / "foxglove.md").read_text(encoding="utf-8")
    scene, _, program = (block.partition("```")[0] for block in page.split("```python\n")[1:4])
    (tmp_path / "default.py").write_text(scene + 'env.configure_stream_manager("foxglove", port=0)\n')
    with morse.load(tmp_path / "default.py", sockets=True) as sim:
        port = hub_of(sim.context, FoxgloveHub).server.port
        (tmp_path / "client.py").write_text(program.replace("8766", str(port)))
        said = talk(tmp_path / "client.py", sim.step)
    assert "/robot/odometry nav_msgs/msg/Odometry" in said
    assert "of simulated time" in said
