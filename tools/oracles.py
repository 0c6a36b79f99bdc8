"""The bits that a change keeps: state hashes of all demos and recipes, and the bytes of all topics.

`python -m tools oracles` writes ``tests/oracles.json``; ``tests/verification/test_oracles.py`` compares it with a run.
A commit that changes the file says which entry has changed and why.

The bits depend on the processor's and the operating system's floating-point functions, on MuJoCo and on numpy:
the file contains them as `machine`, and only an equal machine compares.
"""

from __future__ import annotations

import hashlib
import json
import math
import platform
import re
import struct
import sys
import tempfile
from contextlib import ExitStack, chdir
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

import mujoco

import morse
from morse.middleware.registry import installed
from morse.rosmsgs.topics.backend import Backend, Publisher, Subscription

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ROOT = Path(__file__).parents[1]
FILE = ROOT / "tests" / "oracles.json"
#: when the states are hashed, and how long topics are listened to, ticks
TICKS, LISTENED = (1, 20, 90), 60
_DEMOS = ROOT / "src" / "morse" / "data" / "examples"
_RECIPE = re.compile(r"^## (.*?)\n.*?```python\n(.*?)```", re.DOTALL | re.MULTILINE)
_TOPICS_SCENE = """
from morse.builder import *

robot = ATRV()
robot.translate(1.0, 2.0, 0.0)
motion = MotionVW()
robot.append(motion)
keep = Keyboard()
robot.append(keep)
for name in ("Pose", "Odometry", "IMU", "GPS", "Gyroscope", "Accelerometer", "Velocity", "Battery", "Clock", "Compass",
             "Infrared", "Sick", "Velodyne", "VideoCamera", "DepthCamera", "SemanticCamera", "Barometer", "Airspeed",
             "Magnetometer", "Proximity", "Thermometer", "Attitude", "RadarAltimeter", "Collision"):
    if name in globals():
        sensor = globals()[name]()
        sensor.name = name.lower()
        if "cam_width" in dir(sensor) or "Camera" in name:
            sensor.properties(cam_width=32, cam_height=24)
        if name == "Velodyne":
            sensor.properties(rotation=0.3)
        robot.append(sensor)
        sensor.add_interface({interface!r})
motion.add_interface({interface!r})
env = Environment("indoors-1/boxes")
if {interface!r} == "mavlink":
    env.configure_stream_manager("mavlink", world="enu")
env.properties(longitude=1.43, latitude=43.6, altitude=150.0)
"""


#: bodies that fall on each other, with all solvers of contacts
_FALL = """<mujoco><option cone="elliptic" integrator="implicitfast"/><worldbody><geom type="plane" size="9 9 1"/>
<body pos="0 0 1"><freejoint/><geom type="box" size=".1 .2 .3" euler="10 20 30"/></body>
<body pos=".1 0 2"><freejoint/><geom type="capsule" size=".1 .3" euler="40 5 0"/></body>
<body pos="0 .1 3"><freejoint/><geom type="ellipsoid" size=".1 .2 .15"/></body></worldbody></mujoco>"""


def machine() -> str:
    """What the bits depend on besides the code: system, processor, versions.

    The processor is known by what its mathematical functions and the physics engine compute: both choose instructions.
    """
    functions: tuple[Callable[[float], float], ...] = (math.sin, math.cos, math.tan, math.exp, math.atan, math.asinh)
    digest = hashlib.sha256()
    for number in range(4000):
        x = math.ldexp(math.sin(1.0 + number), number % 7 - 3)
        digest.update(struct.pack(f"{len(functions)}d", *(function(x) for function in functions)))
    model = mujoco.MjModel.from_xml_string(_FALL)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=400)
    digest.update(data.qpos.tobytes())
    versions = " ".join(f"{name} {metadata.version(name)}" for name in ("mujoco-core", "numpy"))
    return f"{platform.system()} {platform.machine()} {versions} processor {digest.hexdigest()[:16]}"


def scenes() -> dict[str, str]:
    """The texts of all demos and of those recipes that are scenes, by name."""
    found = {f"demo {path.parent.name}": path.read_text(encoding="utf-8") for path in _DEMOS.glob("*/scene.py")}
    page = (ROOT / "docs" / "recipes.md").read_text(encoding="utf-8")
    for name, text in _RECIPE.findall(page):
        if re.search(r"^(\w+ = )?Environment\(", text, re.MULTILINE):
            found[f"recipe {name}"] = text
    return dict(sorted(found.items()))


def state_hashes(name: str) -> list[str]:
    """The hashes of the states of a demo or recipe after `TICKS`."""
    text = scenes()[name]
    demo = _DEMOS / name.removeprefix("demo ") / "scene.py"
    hashes, tick = [], 0
    with tempfile.TemporaryDirectory() as folder:
        path = demo if demo.is_file() else Path(folder) / "scene.py"
        if path is not demo:
            path.write_text(text, encoding="utf-8")
        with morse.load(path, seed=1) as sim:
            for end in TICKS:
                sim.step(end - tick)
                tick = end
                hashes.append(sim.state_hash()[:16])
    return hashes


class _Memory(Backend):
    """Hashes what is published, instead of sending it."""

    name = opens = "memory"

    def __init__(self, note: Callable[[str, bytes], None]) -> None:
        self._note = note

    def publisher(self, topic: str, type_name: str, qos: Any) -> Publisher:
        return _Heard(lambda data: self._note(f"{topic} {type_name}", data))

    def subscription(self, topic: str, type_name: str, qos: Any) -> Subscription:
        return _Silent()

    def close(self) -> None:
        pass

    def flush(self) -> None:
        pass


class _Heard(Publisher):
    def __init__(self, note: Callable[[bytes], None]) -> None:
        self._note = note

    def publish(self, data: bytes) -> bool:
        self._note(bytes(data))
        return True

    def wanted(self) -> bool:
        return True

    def close(self) -> None:
        pass


class _Silent(Subscription):
    def take(self) -> list[bytes]:
        return []

    def close(self) -> None:
        pass


def middlewares() -> list[str]:
    """The middlewares of MORSE with streams, but ROS 1, which needs an installation even to form messages."""
    return sorted(name for name, entry in installed().items() if entry.default_publisher is not None and name != "ros")


class _Bytes:
    """The number of messages of each topic, and a hash of all of their bytes."""

    def __init__(self) -> None:
        self._topics: dict[str, tuple[list[int], Any]] = {}

    def note(self, topic: str, data: object) -> None:
        if topic.startswith("/rosout"):  # depends on the ports of the machine
            return
        count, digest = self._topics.setdefault(topic, ([0], hashlib.sha256()))
        count[0] += 1
        if not topic.startswith("/diagnostics"):  # the processor time of ticks
            digest.update(data if isinstance(data, bytes) else repr(data).encode())
        digest.update(b"\0")

    def table(self) -> dict[str, str]:
        return {
            topic: f"{count[0]} {digest.hexdigest()[:16]}" for topic, (count, digest) in sorted(self._topics.items())
        }


def topic_hashes(name: str) -> dict[str, str]:
    """The number of messages and the hash of the bytes of each topic that one middleware sends in `LISTENED` ticks.

    Nothing is sent: what the middleware would pass to its connection is hashed, as if each topic had a reader.
    """
    heard = _Bytes()
    path = installed()[name].stream_manager
    assert path is not None
    module, _, attribute = path.rpartition(".")
    manager = getattr(import_module(module), attribute)
    with tempfile.TemporaryDirectory() as folder, chdir(folder), ExitStack() as patches:
        for target, method, function in _replacements(name, manager, heard.note):
            patches.enter_context(patch.object(target, method, function))
        script = Path(folder) / "scene.py"
        script.write_text(_TOPICS_SCENE.format(interface=name), encoding="utf-8")
        with morse.load(script, seed=1, sockets=True, on_failure="raise") as sim:
            sim.step(LISTENED)
    return heard.table()


def _replacements(name: str, manager: type, note: Callable[[str, object], None]) -> Iterator[tuple[Any, str, Any]]:
    """The methods between a middleware's form of messages and its connection: class, name, replacement."""
    from morse.wire.encoding import to_json

    def send(self: object, stream: Any, payload: Any) -> None:
        note(stream.component_name, to_json(payload) if isinstance(payload, dict) else payload)

    package = sys.modules[manager.__module__].__package__ or ""
    if hasattr(manager, "_make_backend"):
        yield manager, "_make_backend", lambda self: _Memory(note)
    elif name == "mavlink":
        links = import_module(f"{package}.links")
        for link in links.Link.__subclasses__():
            yield link, "send", lambda self, data: note(self.device, data)
    else:
        yield manager, "wanted", lambda *_: True
        if name == "moos":
            database = import_module(f"{package}.database").Database
            yield database, "publish", lambda self, variable, value: note(variable, value)
        else:
            yield manager, "send", send


def measured() -> dict[str, Any]:
    """All oracles of this machine."""
    return {
        "machine": machine(),
        "states": {name: state_hashes(name) for name in scenes()},
        "topics": {name: topic_hashes(name) for name in middlewares()},
    }


def main() -> int:
    """Write `FILE`."""
    FILE.write_text(json.dumps(measured(), indent=1) + "\n", encoding="utf-8")
    return 0
