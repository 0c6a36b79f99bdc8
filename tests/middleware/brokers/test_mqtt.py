"""MQTT with a real Mosquitto, which is stopped and restarted, and clients in another process."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import morse
from morse.core.exceptions import MorseError
from tests.kit.programs import talk
from tests.kit.scenes import Load
from tests.kit.waiting import step_until

HERE = Path(__file__).parent
DOCS = HERE.parents[2] / "docs"
MOSQUITTO = shutil.which("mosquitto", path=f"{os.environ.get('PATH', '')}:/usr/sbin:/usr/local/sbin")
LIMIT = 60.0
SCENE = """
from morse.builder import *
robot = ATRV()
motion = MotionVW(); robot.append(motion)
pose = Pose(); robot.append(pose)
{components}
robot.add_default_interface("mqtt")
env = Environment("{world}")
env.configure_stream_manager("mqtt", port={port}{options})
"""
SENSORS = """
scan = Hokuyo(); scan.translate(x=0.3, z=0.6); robot.append(scan)
camera = VideoCamera(); camera.properties(cam_width=32, cam_height=24); camera.frequency(10)
camera.translate(x=0.3, z=1.0); robot.append(camera)
"""


class Mosquitto:
    """A broker on a port that is free at the start."""

    def __init__(self, folder: Path) -> None:
        if MOSQUITTO is None:
            (pytest.fail if os.environ.get("CI") else pytest.skip)("there is no mosquitto: sudo apt install mosquitto")
        with socket.create_server(("127.0.0.1", 0)) as probe:
            self.port = probe.getsockname()[1]
        self._config = folder / "mosquitto.conf"
        self._config.write_text(f"listener {self.port} 127.0.0.1\nallow_anonymous true\n")
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        command = [str(MOSQUITTO), "-c", str(self._config)]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
                return
            except OSError:
                time.sleep(0.02)
        raise AssertionError("mosquitto does not listen")

    def stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.wait()


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[Mosquitto]:
    made = Mosquitto(tmp_path)
    yield made
    made.stop()


@pytest.fixture(autouse=True)
def _needs_paho() -> None:
    if find_spec("paho") is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("there is no paho-mqtt: pip install paho-mqtt")


@pytest.fixture
def start(load: Load) -> Load:
    def start(port: int, components: str = "", world: str = "empty", options: str = "") -> Any:
        return load(SCENE.format(port=port, components=components, world=world, options=options), sockets=True)

    return start


def broker_of(sim: Any) -> Any:
    return sim.context.stream_managers["morse.middleware.mqtt.datastream.MqttDatastreamManager"].broker


@pytest.mark.peer("mosquitto")
def test_a_client_drives_and_looks(broker: Mosquitto, start: Callable[..., Any]) -> None:
    broker.start()
    sim = start(broker.port, SENSORS, "sandbox")
    seen = json.loads(talk([sys.executable, str(HERE / "mqtt_peer.py"), str(broker.port)], sim.step))
    assert seen["status"] == "online"
    pose = seen["morse/robot/pose"]
    assert list(pose) == ["timestamp", "x", "y", "z", "yaw", "pitch", "roll"]
    # at 0.5 m/s; the simulation went on until the client had ended, which takes long on a busy machine
    now = sim.robot.pose.get()
    assert now["x"] - pose["x"] == pytest.approx(0.5 * (now["timestamp"] - pose["timestamp"]), abs=0.05)
    camera = seen["morse/robot/camera"]
    assert (camera["width"], camera["height"], camera["encoding"]) == (32, 24, "rgba8")
    assert "image" not in camera
    assert seen["image"] == 4 * 32 * 24
    scan = seen["morse/robot/scan"]
    # as on the socket: a ray without a hit has the range of the scanner, 30 m
    assert all(0.0 < distance <= 30.0 for distance in scan["range_list"])


@pytest.mark.peer("mosquitto")
def test_a_simulation_without_its_broker(broker: Mosquitto, start: Callable[..., Any]) -> None:
    sim = start(broker.port)  # without a broker
    sim.step(30)
    assert not broker_of(sim).connected
    for _ in range(2):
        broker.start()
        step_until(sim, lambda: broker_of(sim).connected)
        command_arrives(sim, broker.port)
        broker.stop()
        step_until(sim, lambda: not broker_of(sim).connected)
    sim.step(30)


def command_arrives(sim: Any, port: int) -> None:
    client = paho_client(port)
    motion = sim.context.components["robot.motion"]
    motion.local_data["w"] = 0.0

    def told() -> bool:
        client.publish("morse/robot/motion/set", '{"w": 0.25}')
        return bool(motion.local_data["w"] == 0.25)

    step_until(sim, told)
    client.disconnect()
    client.loop_stop()


def paho_client(port: int) -> Any:
    from paho.mqtt.client import Client
    from paho.mqtt.enums import CallbackAPIVersion

    client = Client(CallbackAPIVersion.VERSION2)
    client.connect("127.0.0.1", port)
    client.loop_start()
    return client


def test_commands_that_do_not_fit_change_nothing(
    broker: Mosquitto, start: Callable[..., Any], caplog: pytest.LogCaptureFixture
) -> None:
    broker.start()
    sim = start(broker.port)
    step_until(sim, lambda: broker_of(sim).connected)
    motion = sim.context.components["robot.motion"]
    client = paho_client(broker.port)
    bad = [b"", b"\xff\xfe", b"[" * 100_000, b"3", b'{"v": "fast"}', b'{"v": NaN}', b'{"v": 1e400}', b"x" * (2 << 20)]
    for message in bad:
        client.publish("morse/robot/motion/set", message, qos=1)
    client.publish("morse/robot/motion/set", b'{"w": 0.5}', qos=1)  # the connection preserves the order

    def arrived() -> bool:
        assert motion.local_data["v"] == 0.0
        return bool(motion.local_data["w"] == 0.5)

    step_until(sim, arrived)
    assert "robot.motion" not in sim.context.failed
    assert "robot.motion: this message cannot be read" in caplog.text
    assert "'v' is 'fast'" in caplog.text
    assert "2097152 bytes are more than 1048576" in caplog.text
    client.disconnect()
    client.loop_stop()


@pytest.mark.peer("mosquitto")
def test_a_second_simulation_on_the_same_topics_is_told(
    broker: Mosquitto, start: Callable[..., Any], caplog: pytest.LogCaptureFixture
) -> None:
    broker.start()
    for prefix in ("lab", "hall"):
        sim = start(broker.port, options=f", prefix='{prefix}'")
        step_until(sim, lambda sim=sim: broker_of(sim).connected)  # type: ignore[misc]
        watcher = paho_client(broker.port)
        heard: list[bytes] = []
        watcher.on_message = lambda client, data, message, heard=heard: heard.append(message.payload)
        watcher.subscribe(f"{prefix}/status", 1)
        step_until(sim, lambda heard=heard: b"online" in heard)  # type: ignore[misc]
        watcher.disconnect()
        watcher.loop_stop()
    assert "another simulation" not in caplog.text
    second = start(broker.port, options=", prefix='lab'")
    step_until(second, lambda: "another simulation" in caplog.text)
    assert "prefix 'lab'" in caplog.text


@pytest.mark.peer("mosquitto")
def test_the_end_is_told(broker: Mosquitto, start: Callable[..., Any]) -> None:
    broker.start()
    sim = start(broker.port, options=", prefix='lab'")
    step_until(sim, lambda: broker_of(sim).connected)
    heard: list[tuple[str, bytes]] = []
    client = paho_client(broker.port)
    client.on_message = lambda client, userdata, message: heard.append((message.topic, message.payload))
    client.subscribe("lab/status", 1)
    step_until(sim, lambda: ("lab/status", b"online") in heard)
    sim.close()
    end = time.monotonic() + LIMIT
    while ("lab/status", b"offline") not in heard and time.monotonic() < end:
        time.sleep(0.01)
    assert heard[-1] == ("lab/status", b"offline")
    client.disconnect()
    client.loop_stop()


@pytest.mark.parametrize(
    ("components", "options", "said"),
    [
        ("", ", prot=1", "did you mean 'port'"),
        ("pose.add_stream('mqtt', topic='a/#')", "", "expected a name without"),
        ("pose.add_stream('mqtt', topic='')", "", "expected a name without"),
        ("pose.add_stream('mqtt', qos=3)", "", "qos"),
        ("pose.add_stream('mqtt', topic='t'); two = Pose(); robot.append(two); two.add_stream('mqtt', topic='t')", "",
         "the topic t is that of robot.pose"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(start: Callable[..., Any], components: str, options: str, said: str) -> None:
    with pytest.raises(MorseError, match=said):
        start(1, components, options=options)


def test_without_the_extra_the_line_that_installs_it_is_said(
    start: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "paho.mqtt", None)
    with pytest.raises(MorseError, match=r'pip install "paho-mqtt>=2,<3"'):
        start(1)


def test_the_example_of_the_documentation(broker: Mosquitto, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    broker.start()
    page = (DOCS / "mqtt.md").read_text(encoding="utf-8")
    scene, program = (block.partition("```")[0] for block in page.split("```python\n")[1:3])
    (tmp_path / "default.py").write_text(scene + f'env.configure_stream_manager("mqtt", port={broker.port})\n')
    (tmp_path / "client.py").write_text(program.replace("1883", str(broker.port)))
    with morse.load(tmp_path / "default.py", sockets=True) as sim:
        assert "x is 0.5 m" in talk([sys.executable, str(tmp_path / "client.py")], sim.step)
