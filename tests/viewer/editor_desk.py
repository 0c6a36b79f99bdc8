"""A page that asks the editor of a scene."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any

from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from view_pages import Client

    from morse.simulation.simulation import Simulation

SCENE = """from morse.builder import *

# my robot
robot = ATRV()
robot.translate(1.0, 2.0)  # by the door

env = Environment("empty")
"""
MODELS = [
    {"kind": "Morsy", "name": "Morsy", "group": "robots"},
    {"kind": "VideoCamera", "name": "VideoCamera", "group": "sensors"},
    *({"kind": kind, "name": kind, "group": "solids"} for kind in ("Cube", "Spot", "Camera")),
    {"kind": "MotionVW", "name": "MotionVW", "group": "actuators"},
    {"kind": "IMU", "name": "IMU", "group": "sensors"},
    {"kind": "props/crates#small_crate", "name": "small crate", "group": "crates"},
]


class Desk:
    """A page that asks the editor, and the simulation that answers between its ticks."""

    def __init__(self, simulation: Simulation, client: Client) -> None:
        self.simulation = simulation
        self._client = client
        self._requests = 0

    def ask(self, kind: str, **fields: Any) -> dict[str, Any]:
        """The answer to a request."""
        self._requests += 1
        self._client.send(kind, request=self._requests, **fields)
        return self._wait("answer", request=self._requests)

    def do(self, kind: str, **fields: Any) -> Any:
        """The value of the answer to a request that has to succeed."""
        answer = self.ask(kind, **fields)
        assert answer["ok"], answer
        return answer["value"]

    def models(self) -> list[dict[str, str]]:
        """The models that can be added."""
        self._client.send("list_models")
        models: list[dict[str, str]] = self._wait("models")["models"]
        return models

    def names(self) -> set[str]:
        """The root objects of the scene."""
        return {root.name for root in self.simulation.scene.roots}

    def unsaved(self, count: int) -> None:
        """Wait until the page knows this number of changes that are not saved."""
        self._wait("scene_changes", count=count)

    def _wait(self, message_type: str, **fields: Any) -> dict[str, Any]:
        def arrived() -> dict[str, Any] | None:
            self.simulation.step(1)
            with contextlib.suppress(TimeoutError):
                self._client.receive(timeout=0.01)
            fits = (m for m in self._client.messages if m["type"] == message_type and fields.items() <= m.items())
            return next(fits, None)

        message: dict[str, Any] = wait_until(arrived, message_type)
        self._client.messages.remove(message)
        return message
