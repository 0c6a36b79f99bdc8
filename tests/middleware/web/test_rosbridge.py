"""rosbridge with its own client in another process, and with malicious clients."""

import base64
import io
import json
import math
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from peers import need, talk
from PIL import Image
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

import morse
from morse.core.clients.budgets import CLIENT_BYTES
from morse.core.exceptions import MorseError
from morse.middleware.rosbridge.datastream import RosbridgeHub
from morse.middleware.web.client import WebClient
from morse.middleware.web.hub import hub_of
from morse.middleware.web.topics import WebInlet
from tests.kit.scenes import Load
from tests.kit.waiting import wait_until

pytestmark = pytest.mark.long

SCENE = """
from morse.builder import *
robot = ATRV()
motion = MotionVW(); robot.append(motion)
{components}
robot.add_default_interface("rosbridge")
env = Environment("{world}")
env.configure_stream_manager("rosbridge", port={port}{options})
"""
SENSORS = """
waypoint = Waypoint(); robot.append(waypoint)
odometry = Odometry(); robot.append(odometry)
scan = Hokuyo(); scan.translate(x=0.3, z=0.6); robot.append(scan)
camera = VideoCamera(); camera.properties(cam_width=32, cam_height=24); camera.frequency(10)
camera.translate(x=0.3, z=1.0); robot.append(camera)
"""
LIMIT = 60.0
"""Wall-clock seconds in which a message has to arrive."""


@pytest.fixture
def start(load: Load) -> Load:
    def start(
        components: str = "", options: str = "", world: str = "empty", port: int = 0, extra: str = "",
        **arguments: Any,
    ) -> tuple[Any, int]:  # fmt: skip
        text = SCENE.format(components=components, options=options, world=world, port=port) + extra
        sim = load(text, sockets=True, **arguments)
        return sim, hub_of(sim.context, RosbridgeHub).server.port

    return start


def opened(address: str, **options: Any) -> ClientConnection:
    # with room for all messages: a client that has not read them all would wait ten seconds for the answer to its close
    return connect(address, proxy=None, **{"max_queue": None, **options}).__enter__()


class Client:
    """A bare WebSocket."""

    def __init__(self, sim: Any, port: int, **options: Any) -> None:
        self.sim = sim
        self.socket = opened(f"ws://127.0.0.1:{port}", **options)

    def send(self, **operation: Any) -> None:
        self.socket.send(json.dumps(operation))

    def receive(self) -> str | bytes | None:
        """The next message; None if there is none."""
        try:
            return self.socket.recv(timeout=0.002)
        except TimeoutError:
            return None

    def until(self, **wanted: Any) -> dict[str, Any]:
        """Step until a message has these fields."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            self.sim.step()
            while (frame := self.receive()) is not None:
                message = json.loads(frame)
                if wanted.items() <= message.items():
                    return dict(message)
        raise AssertionError(f"no message with {wanted}")


@pytest.mark.peer("roslibpy")
def test_the_client_of_rosbridge_drives_looks_and_calls(start: Callable[..., tuple[Any, int]]) -> None:
    need("roslibpy")
    sim, port = start(SENSORS, world="sandbox")
    seen = talk("roslib_peer.py", sim.step, port)
    assert {"/robot/odometry", "/robot/scan", "/robot/cmd_vel", "/clock", "/tf", "/tf_static"} <= set(seen["topics"])
    assert seen["odom_type"] == "nav_msgs/msg/Odometry"
    assert "/robot/motion/set_speed" in seen["services"]
    # half a metre per second, as commanded: position, velocity and stamps are consistent
    moving = [m for m in seen["odometry"] if m["twist"]["twist"]["linear"]["x"] > 0.45]
    first, last = moving[0], moving[-1]
    seconds = time_of(last) - time_of(first)
    way = last["pose"]["pose"]["position"]["x"] - first["pose"]["pose"]["position"]["x"]
    assert way == pytest.approx(0.5 * seconds, rel=0.1)
    assert last["header"]["frame_id"] == "robot/odom"
    scan = seen["scan"]
    count = round((scan["angle_max"] - scan["angle_min"]) / scan["angle_increment"]) + 1
    assert len(scan["ranges"]) == count
    # infinity, for rays without a hit, has no JSON representation
    assert all(value is None or 0.0 < value <= scan["range_max"] for value in scan["ranges"])
    image = seen["image"]
    assert (image["width"], image["height"], image["encoding"]) == (32, 24, "rgba8")
    assert len(base64.b64decode(image["data"])) == image["step"] * image["height"] == 4 * 32 * 24
    # the static frames were sent before the client connected
    children = {one["child_frame_id"] for one in seen["tf_static"]["transforms"]}
    assert {"robot/odom", "robot/scan"} <= children
    assert seen["stopped"] == {"result": None}
    assert seen["arrived"] == {"result": "Arrived"}
    assert "no argument fast" in seen["refused"]
    arrived, cancelled, refused = seen["goals"]
    assert arrived == ["SUCCEEDED", {"result": "Arrived"}]
    assert cancelled[0] == "CANCELED"
    assert refused[0] == "ABORTED"
    assert "no argument far" in refused[1]["error"]


def time_of(message: dict[str, Any]) -> float:
    stamp = message["header"]["stamp"]
    return float(stamp["sec"] + stamp["nanosec"] * 1e-9)


def test_nothing_is_encoded_for_nobody(start: Callable[..., tuple[Any, int]], monkeypatch: pytest.MonkeyPatch) -> None:
    sim, port = start("pose = Pose(); robot.append(pose)")
    sim.step(5)  # now the static frames are kept for later subscribers
    monkeypatch.setattr("morse.middleware.rosbridge.forms.encode_json", lambda *_: pytest.fail("nobody listens"))
    sim.step(20)
    client = Client(sim, port)  # connected, but subscribed to nothing
    sim.step(20)
    client.socket.close()


def test_subscriptions_begin_and_end(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start("pose = Pose(); robot.append(pose)")
    client = Client(sim, port)
    client.send(op="subscribe", id="a", topic="/robot/pose")
    client.send(op="subscribe", id="b", topic="robot/pose", throttle_rate=10_000_000)
    message = client.until(op="publish", topic="/robot/pose")["msg"]
    assert message["pose"]["orientation"] == pytest.approx({"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}, abs=1e-3)
    client.send(op="unsubscribe", id="a", topic="/robot/pose")
    topic = hub_of(sim.context, RosbridgeHub).topics.offered["/robot/pose"]
    client.send(op="call_service", id="1", service="/rosapi/get_time")
    client.until(op="service_response", id="1")
    assert [wish.interval for wish in topic.readers.values()] == [10_000.0]
    client.send(op="unsubscribe", topic="/robot/pose")
    client.send(op="call_service", id="2", service="/rosapi/get_time")
    client.until(op="service_response", id="2")
    assert not topic.readers
    client.socket.close()


def test_a_compressed_subscription(start: Callable[..., tuple[Any, int]]) -> None:
    client = Client(*start("odometry = Odometry(); robot.append(odometry)"))
    client.send(op="subscribe", topic="/tf_static", compression="png")
    image = Image.open(io.BytesIO(base64.b64decode(client.until(op="png")["data"])))
    assert image.mode == "RGB"
    inner = json.loads(image.tobytes().decode())
    assert (inner["op"], inner["topic"]) == ("publish", "/tf_static")
    assert inner["msg"]["transforms"]
    client.send(op="subscribe", topic="/clock", compression="zip", id="x")
    assert "none of none, png" in client.until(op="status", id="x")["msg"]


def test_a_throttled_subscription_gets_one_message_in_its_time(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start("pose = Pose(); robot.append(pose)")
    client = Client(sim, port)
    client.send(op="subscribe", topic="/robot/pose", throttle_rate=1e9)
    client.until(op="publish", topic="/robot/pose")
    sim.step(60)
    client.send(op="call_service", id="end", service="/rosapi/get_time")
    seen = []
    while not seen or seen[-1].get("id") != "end":
        sim.step()
        seen.append(json.loads(client.socket.recv(timeout=60)))
    assert [message["op"] for message in seen] == ["service_response"]
    client.socket.close()


def test_services_of_all_kinds(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start("waypoint = Waypoint(); robot.append(waypoint)")
    client = Client(sim, port)

    def call(service: str, args: Any = None, number: Any = 1) -> dict[str, Any]:
        client.send(op="call_service", id=number, service=service, args=args)
        return client.until(op="service_response", id=number)

    assert call("/robot/motion/set_speed", [0.5, 0.0])["result"] is True
    assert sim.context.components["robot.motion"].local_data["v"] == 0.5
    assert call("robot/motion/set_speed", {"w": 0.1, "v": 0.0})["values"] == {"result": None}
    assert sim.context.components["robot.motion"].local_data["w"] == 0.1
    assert "wrong # of parameters" in call("/robot/motion/set_speed", [1.0])["values"]
    assert "'v' is missing" in call("/robot/motion/set_speed", {"w": 1.0})["values"]
    assert "a number" in call("/robot/motion/set_speed", ["fast", 0.0])["values"]
    assert "did you mean" in call("/robot/motion/set_sped", [])["values"]
    assert call("/robot/motion/set_speed", "fast")["result"] is False
    assert call("/rosapi/nothing")["result"] is False
    assert call("/rosapi/topic_type", {"topic": "/robot/cmd_vel"})["values"] == {"type": "geometry_msgs/msg/Twist"}
    # roslibpy reads the names of ROS 1, clients of ROS 2 those of ROS 2
    time = call("/rosapi/get_time")["values"]["time"]
    assert (time["secs"], time["nsecs"]) == (time["sec"], time["nanosec"])
    assert call("/rosapi/subscribers", {"topic": "/robot/cmd_vel"})["values"] == {"subscribers": ["/morse"]}
    assert call("/rosapi/publishers", {"topic": "/robot/cmd_vel"})["values"] == {"publishers": []}
    details = call("/rosapi/message_details", {"type": "geometry_msgs/Twist"})["values"]["typedefs"]
    assert [one["type"] for one in details] == ["geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3"]
    assert details[1]["fieldnames"] == ["x", "y", "z"]
    assert call("/rosapi/message_details", {"type": "no/Such"})["values"] == {"typedefs": []}
    assert "/robot/cmd_vel" in call("/rosapi/node_details", {"node": "/morse"})["values"]["subscribing"]
    assert call("/rosapi/service_node", {"service": "/robot/motion/stop"})["values"] == {"node": "/morse"}
    assert call("/rosapi/service_node", {"service": "/no"})["values"] == {"node": ""}
    assert call("/rosapi/get_param_names")["values"] == {"names": []}
    raw = call("/rosapi/topics_and_raw_types")["values"]
    assert "float64 x" in raw["typedefs_full_text"][raw["topics"].index("/robot/cmd_vel")]
    # an active call of goto; a second one preempts it
    client.send(op="call_service", id="far", service="/robot/waypoint/goto", args=[1e6, 0.0, 0.0])
    client.send(op="call_service", id="near", service="/robot/waypoint/goto", args=[0.0, 0.0, 0.0, 5.0])
    assert client.until(op="service_response", id="far")["values"].startswith("PREEMPTED")
    assert client.until(op="service_response", id="near")["values"] == {"result": "Arrived"}
    client.socket.close()


BAD = [
    ('{"op":"send_action_goal","id":"z"}', "needs 'action'"),
    ('{"op":"cancel_action_goal","id":"z"}', "needs 'action'"),
    ("[" * 100_000, "not an operation"),
    ("{}", "not an operation"),
    ('{"op":"subscribe"}', "needs 'topic'"),
    ('{"op":"subscribe","topic":' + json.dumps("x" * 300) + "}", "needs 'topic'"),
    ('{"op":"subscribe","topic":"/clock","type":"std_msgs/String"}', "has the type rosgraph_msgs/msg/Clock"),
    ('{"op":"advertise","topic":"/robot/cmd_vel","type":"std_msgs/String"}', "has the type geometry_msgs/msg/Twist"),
    ('{"op":"publish","topic":"/robot/cmd_vel"}', "needs 'msg'"),
    ('{"op":"subscibe","topic":"/clock"}', "did you mean 'subscribe'"),
    ('{"op":"call_service","id":4}', "needs 'service'"),
    ('{"op":"set_level","level":"loud"}', "one of none, error"),
    ("\x00\x01\x02", "not an operation"),
]


@pytest.mark.parametrize(("frame", "answer"), BAD, ids=[answer for _, answer in BAD])
def test_what_is_wrong_is_answered(start: Callable[..., tuple[Any, int]], frame: str, answer: str) -> None:
    sim, port = start()
    client = Client(sim, port)
    client.socket.send(frame)
    status = client.until(op="status", level="error")
    assert answer in status["msg"]
    client.send(op="call_service", id="alive", service="/rosapi/get_time")
    client.until(id="alive")
    client.socket.close()


def test_commands_that_do_not_fit_change_nothing(
    start: Callable[..., tuple[Any, int]], caplog: pytest.LogCaptureFixture
) -> None:
    sim, port = start()
    client = Client(sim, port)
    motion = sim.context.components["robot.motion"]
    bad: list[Any] = [
        {"linear": {"x": "fast"}}, {"linear": {"x": math.nan}}, {"linear": {"x": 10**400}}, {"lineer": {}}, [], None, 3,
        {"linear": [1, 0, 0]}, {"linear": {"x": True}}, {"linear": {"x": {"x": 1}}}, {"linear": {"x": math.inf}},
    ]  # fmt: skip
    for message in bad:
        client.send(op="publish", topic="/robot/cmd_vel", msg=message)
        client.send(op="call_service", id="then", service="/rosapi/get_time")
        client.until(id="then")
        assert (motion.local_data["v"], motion.local_data["w"]) == (0.0, 0.0), message
    assert "linear.x is 'fast', expected a number" in caplog.text
    client.send(op="publish", topic="/robot/cmd_vel", msg={"linear": {"x": 0.5}})
    client.send(op="call_service", id="at last", service="/rosapi/get_time")
    client.until(id="at last")
    sim.step()
    assert motion.local_data["v"] == 0.5
    client.socket.close()


@pytest.mark.parametrize("origin", ["https://evil.example", "http://localhost:8080", "null"])
def test_pages_of_others_are_turned_away(start: Callable[..., tuple[Any, int]], origin: str) -> None:
    sim, port = start()
    with pytest.raises(InvalidStatus) as caught:
        Client(sim, port, origin=origin)
    assert caught.value.response.status_code == 403


def test_pages_may_be_let_in(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(options=", origins=['http://localhost:8080']")
    Client(sim, port, origin="http://localhost:8080").socket.close()
    Client(sim, port, origin=f"http://127.0.0.1:{port}").socket.close()
    with pytest.raises(InvalidStatus):
        Client(sim, port, origin="http://localhost:8081")


def test_a_token_has_to_be_shown(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(options=", token='open sesame'")
    with pytest.raises(InvalidStatus):
        Client(sim, port)
    opened(f"ws://127.0.0.1:{port}/?token=open%20sesame").close()


def test_other_machines_need_a_token_that_is_made_up(
    start: Callable[..., tuple[Any, int]], caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("INFO")
    _, port = start(host="0.0.0.0")
    with pytest.raises(InvalidStatus):
        opened(f"ws://127.0.0.1:{port}")
    (token,) = [line.partition("?token=")[2] for line in caplog.messages if line.startswith("rosbridge: ws:")]
    assert len(token) > 20
    opened(f"ws://127.0.0.1:{port}/?token={token}").close()


def test_there_are_not_more_clients_than_allowed(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(options=", most_clients=2")
    clients = [Client(sim, port) for _ in range(2)]
    for number, client in enumerate(clients):  # both have arrived
        client.send(op="call_service", id=number, service="/rosapi/get_time")
        client.until(id=number)
    with pytest.raises(InvalidStatus) as caught:
        Client(sim, port)
    assert caught.value.response.status_code == 503
    for client in clients:
        client.socket.close()


def test_connections_that_send_nothing_do_not_keep_clients_out(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start(options=", most_clients=1")
    silent = [socket.create_connection(("127.0.0.1", port), timeout=60.0) for _ in range(70)]
    assert silent[0].recv(1) == b"", "the oldest one is closed"
    client = Client(sim, port)
    client.send(op="call_service", service="/rosapi/nodes", id="here")
    client.until(id="here")
    for one in (*silent, client.socket):
        one.close()


def test_only_the_latest_of_many_large_commands_wait() -> None:
    lost: list[str] = []
    topics = SimpleNamespace(complain_of_loss=lost.append)
    inlet = WebInlet(topics, "/topic")  # type: ignore[arg-type] # not closed here
    for number in range(32):
        inlet.put(bytes([number]) * 100_000)
    waiting = inlet.take()
    assert sum(map(len, waiting)) <= 1 << 20
    assert waiting[-1][0] == 31
    assert len(lost) == 32 - len(waiting)


def test_who_does_not_read_misses_messages_and_stops_nobody(start: Callable[..., tuple[Any, int]]) -> None:
    scan = "scan = Hokuyo(); scan.properties(scan_window=360, resolution=0.01); scan.frequency(60); robot.append(scan)"
    sim, port = start(scan)
    sleeper = opened(f"ws://127.0.0.1:{port}", max_queue=1, max_size=None)
    sleeper.send(json.dumps({"op": "subscribe", "topic": "/robot/scan"}))
    other = Client(sim, port)
    other.send(op="subscribe", topic="/clock")
    other.until(op="publish", topic="/clock")
    clients = hub_of(sim.context, RosbridgeHub).server.clients
    (slow,) = wait_until(lambda: [client for client in list(clients) if "/robot/scan" in client._wishes])
    assert isinstance(slow, WebClient)
    sim.step(60)  # each scan has 0.18 MB: without hits, all ranges are null
    other.until(op="publish", topic="/clock")
    # the last ten scans wait
    wait_until(lambda: 1 << 20 < CLIENT_BYTES - slow.memory.left < 2 << 20)
    sim.step(60)
    wait_until(lambda: 1 << 20 < CLIENT_BYTES - slow.memory.left < 2 << 20)
    other.until(op="publish", topic="/clock")
    other.socket.close()


def sent_and_received(socket: ClientConnection, message: str) -> None:
    socket.send(message)
    socket.recv(timeout=50)


def test_a_huge_message_ends_the_connection_alone(start: Callable[..., tuple[Any, int]]) -> None:
    sim, port = start()
    client = Client(sim, port)
    with pytest.raises(ConnectionClosed):
        sent_and_received(client.socket, "x" * (5 << 20))
    other = Client(sim, port)
    other.send(op="call_service", id=1, service="/rosapi/nodes")
    assert other.until(id=1)["values"] == {"nodes": ["/morse"]}
    other.socket.close()


def test_clients_change_nothing_of_what_is_simulated(start: Callable[..., tuple[Any, int]]) -> None:
    alone, _ = start("pose = Pose(); robot.append(pose)", seed=3)
    watched, port = start("pose = Pose(); robot.append(pose)", seed=3)
    client = Client(watched, port)
    client.send(op="subscribe", topic="/robot/pose")
    client.until(op="publish", topic="/robot/pose")
    alone.step(watched.clock.tick)
    assert alone.state_hash() == watched.state_hash()
    client.socket.close()


@pytest.mark.parametrize(("option", "said"), [
    (", origins=['localhost']", "expected addresses such as"),
    (", most_clients=0", "most_clients"),
    (", prot=1", "did you mean"),
])  # fmt: skip
def test_options_that_do_not_fit_are_refused(start: Callable[..., tuple[Any, int]], option: str, said: str) -> None:
    with pytest.raises(MorseError, match=said):
        start(options=option)


def test_a_port_that_is_taken_is_not_waited_for(
    start: Callable[..., tuple[Any, int]], caplog: pytest.LogCaptureFixture
) -> None:
    _, first = start()
    _, second = start(port=first)
    assert second != first


def test_step_by_step_the_data_come_before_the_answer(start: Callable[..., tuple[Any, int]]) -> None:
    more = "pose = Pose(); robot.append(pose)\npose.frequency(60)"
    sim, port = start(more, extra='env.add_service("rosbridge")\n')
    seen: list[list[int]] = []
    problems: list[BaseException] = []

    def client() -> None:
        try:
            with connect(f"ws://127.0.0.1:{port}", proxy=None) as socket:
                socket.send(json.dumps({"op": "call_service", "id": 0, "service": "/simulation/pause"}))
                while json.loads(socket.recv(timeout=50)).get("id") != 0:
                    pass
                socket.send(json.dumps({"op": "subscribe", "topic": "/robot/pose"}))
                for number in range(1, 31):
                    socket.send(json.dumps({"op": "call_service", "id": number, "service": "/simulation/step"}))
                    stamps = []
                    while (message := json.loads(socket.recv(timeout=50))).get("id") != number:
                        stamps.append(round(time_of(message["msg"]) * 60))
                    seen.append(stamps)
                socket.send(json.dumps({"op": "call_service", "id": 99, "service": "/simulation/quit"}))
        except BaseException as error:  # reported by the thread of the test
            problems.append(error)
            sim.stop()

    thread = threading.Thread(target=client)
    thread.start()
    sim.run(duration=600.0)
    thread.join(60.0)
    assert not problems, problems
    (first,) = seen[0]
    # one measurement per step, that of the tick
    assert seen == [[first + number] for number in range(30)]


@pytest.mark.peer("roslibpy")
def test_the_example_of_the_documentation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    need("roslibpy")
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    page = (Path(__file__).parents[3] / "docs" / "rosbridge.md").read_text(encoding="utf-8")
    scene, program = (block.partition("```")[0] for block in page.split("```python\n")[1:3])
    (tmp_path / "default.py").write_text(scene + 'env.configure_stream_manager("rosbridge", port=0)\n')
    with morse.load(tmp_path / "default.py", sockets=True) as sim:
        port = hub_of(sim.context, RosbridgeHub).server.port
        (tmp_path / "client.py").write_text(program.replace("9090", str(port)))
        assert "odometry 0.5 m" in talk(tmp_path / "client.py", sim.step)
