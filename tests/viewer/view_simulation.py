"""A replacement for a simulation, with a moving world and answers for a page."""

from __future__ import annotations

import math
import threading
import time
from typing import Any

import numpy as np

from morse.viewer.description import (
    ArgumentDescription,
    ComponentDescription,
    FieldDescription,
    PropertyDescription,
    ServiceDescription,
)
from morse.viewer.page_messages import (
    Activate,
    CallService,
    CancelService,
    Pause,
    Play,
    Reset,
    SetProperty,
    SetSpeed,
    Step,
    Teleport,
)
from morse.viewer.server import ViewServer
from morse.viewer.snapshot import MovingNode, Snapshot
from morse.viewer.view_messages import (
    Activity,
    Answer,
    Contacts,
    Picture,
    PropertyValue,
    Rays,
    Tree,
    Values,
)
from tests.kit.waiting import wait_until

TICK = 1.0 / 60.0


def scan(pose: np.ndarray) -> np.ndarray:
    """(61, 7) rays in a fan from a robot; every second one has a hit."""
    heading = 2 * math.atan2(pose[6], pose[3])
    rays = np.zeros((61, 7), dtype="<f4")
    rays[:, :3] = pose[:3] + np.array([0.0, 0.0, 0.55])
    angles = heading + np.linspace(-math.pi / 2, math.pi / 2, 61)
    reach = 3.0 + np.sin(np.arange(61) * 0.7)
    rays[:, 3] = rays[:, 0] + reach * np.cos(angles)
    rays[:, 4] = rays[:, 1] + reach * np.sin(angles)
    rays[:, 5] = rays[:, 2]
    rays[:, 6] = np.arange(61) % 2
    return rays


def gradient(tick: int) -> bytes:
    """A 64x48 image, RGBA: red grows to the right, green downward, blue with time."""
    picture = np.zeros((48, 64, 4), np.uint8)
    picture[..., 0] = np.arange(64)[None, :] * 4
    picture[..., 1] = np.arange(48)[:, None] * 5
    picture[..., 2] = tick % 256
    picture[..., 3] = 255
    return picture.tobytes()


class CircleDriver:
    """Replaces the simulation: robots drive in circles, or are driven by the arrow keys of the page."""

    def __init__(self, server: ViewServer, moving: list[MovingNode]) -> None:
        self.server = server
        self.moving = moving
        self.events: list[object] = []
        self.keys: list[frozenset[str]] = []
        self.tick = 0
        self._ticking = threading.Lock()
        self._set_out()
        self._again = threading.Event()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def _set_out(self) -> None:
        self.x, self.time = 0.0, 0.0
        self.running, self.steps, self.speed = True, 0, 1.0
        #: simulated time in a tick, 1 being the usual one
        self.pace = 1.0
        #: whether components have values
        self.measures = True
        #: whether pages are told what happens
        self.shown = True

    def __enter__(self) -> CircleDriver:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join(60)

    @property
    def time(self) -> float:
        """Simulated time, s; may be set while the simulation runs."""
        return self._time

    @time.setter
    def time(self, value: float) -> None:
        with self._ticking:
            self._time = value

    def begin(self) -> None:
        """Go back to the beginning, as if no page had done anything; ticks are numbered on."""
        self._again.set()
        wait_until(lambda: not self._again.is_set(), "a new beginning")
        self.server.send(self.tree())

    def poses(self) -> np.ndarray:
        """Robots on circles around the origin, with rotating heads."""
        poses = np.zeros((len(self.moving), 7), dtype=np.float32)
        poses[:, 3] = 1.0
        for i in range(len(self.moving) // 2):
            angle = self.time * 0.4 + i * 2.1
            heading = angle + math.pi / 2
            radius = 2.0 + i
            poses[2 * i] = (
                radius * math.cos(angle) + self.x, radius * math.sin(angle), 0.25,
                math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2),
            )  # fmt: skip
            poses[2 * i + 1] = (0.2, 0, 0.4, math.cos(self.time), 0, 0, math.sin(self.time))
        return poses

    def _handle(self, event: object) -> None:
        match event:
            case SetProperty() if isinstance(event.value, str):
                self.server.send(
                    Answer(event.request, ok=False, error=f"{event.name} is a number, given '{event.value}'")
                )
            case SetProperty():
                self.server.send(PropertyValue(event.component, event.name, event.value))
                self.server.send(Answer(event.request, ok=True, value=event.value))
            case CallService(service="add"):
                self.server.send(Answer(event.request, ok=True, value=sum(event.arguments)))
            case CallService(service="fail"):
                self.server.send(Answer(event.request, ok=False, error="it did not work: no power"))
            case CallService(service="goto"):
                self.pending = event.request
            case CancelService():
                self.server.send(Answer(event.request, ok=False, error="PREEMPTED"))
            case Activate():
                self.server.send(Activity(event.component, event.active))
                self.server.send(Answer(event.request, ok=True))
            case Teleport():
                self.server.send(Answer(event.request, ok=True))
            case Play():
                self.running = True
            case Pause():
                self.running = False
            case Step():
                self.steps += event.count
            case Reset():
                self.time, self.x = 0.0, 0.0
            case SetSpeed():
                self.speed = math.inf if event.factor is None else event.factor

    def _tell(self) -> None:
        """Values, rays and images for pages that show them."""
        wishes = self.server.wishes
        for name in wishes.values if self.measures else ():
            data: dict[str, Any] = {
                "x": math.cos(self.time),
                "near": {},
                "points": [[self.time, 0.0, 1.0]] * 20,
                "position": [self.time, 2.0, 3.0],
            }
            self.server.send(Values(name, self.time, {**data, "note": "fine", "ready": True, "image": None}))
        for name in sorted(wishes.overlays - {"contacts"}):
            robot = next((i for i, m in enumerate(self.moving) if m.node.name == name.partition(".")[0]), None)
            if robot is not None:
                self.server.send(Rays(component=name, payload=scan(self.poses()[robot]).tobytes()))
        if "contacts" in wishes.overlays:
            self.server.send(Contacts(payload=np.array([[0, 0, 0, 0, 0, 50]], "<f4").tobytes()))
        for name in wishes.images:
            self.server.send(
                Picture(camera=name, width=64, height=48, mime="image/x-rgba", payload=gradient(self.tick))
            )

    def tree(self) -> Tree:
        """Robots with a lidar that has data, properties and services."""
        components = []
        two = [ArgumentDescription("a"), ArgumentDescription("b", "float", "0.0")]
        for robot in [m.node.name for m in self.moving if m.frame == "world"]:
            services = [
                ServiceDescription("add", "Adds two numbers.", two),
                ServiceDescription("fail", "Always fails."),
                ServiceDescription("goto", "Takes long.", [], asynchronous=True),
            ]  # fmt: skip
            data = [
                FieldDescription("x", "float", "cosine of the time", "m"),
                FieldDescription("position", "vec3<float>", "where it is", "m"),
                FieldDescription("note", "string", "a remark"),
                FieldDescription("ready", "bool", "whether it is"),
                FieldDescription("near", "dict", "what is near"),
                FieldDescription("points", "list", "where rays end", "m"),
                FieldDescription("image", "buffer", "what it sees"),
            ]
            properties = [
                PropertyDescription("scan_window", "float", "width of the scan, degrees", 180.0),
                PropertyDescription("upside_down", "bool", "whether it hangs", False),
            ]
            components.append(
                ComponentDescription(robot, "robot", robot, "Rover", "A rover that runs in circles", 60.0)
            )
            components.append(
                ComponentDescription(
                    f"{robot}.lidar", "sensor", robot, "Lidar", "Measures distances", 10.0, "raw",
                    data=data, properties=properties, services=services, pictured=True,
                )
            )  # fmt: skip
        return Tree(components)

    def _run(self) -> None:
        due = time.monotonic()
        while not self._stop.is_set():
            again = self._again.is_set()
            if again:
                self._set_out()
                self.events.clear()
                self.keys.clear()
            for event in self.server.take_events():
                self.events.append(event)
                self._handle(event)
            keys = self.server.held_keys()
            if not self.keys or self.keys[-1] != keys:
                self.keys.append(keys)
            if again:
                self._again.clear()
            if self.running or self.steps:
                self.steps = max(0, self.steps - 1) if not self.running else 0
                with self._ticking:
                    self.tick, self._time = self.tick + 1, self._time + TICK * self.pace
                self.x += 0.05 * (("ArrowUp" in keys) - ("ArrowDown" in keys))
            if self.server.watched and self.shown:
                status = "running" if self.running else "paused"
                self._tell()
                self.server.publish(Snapshot(self.tick, self.time, 1, self.poses(), status, self.speed, 1.0))
            due = max(due + TICK, time.monotonic())
            self._stop.wait(max(0.0, due - time.monotonic()))
