"""A robot with components in a small world, without network and wall clock."""

from __future__ import annotations

import math
from pathlib import Path  # noqa: TC003

import morse


class Rig:
    """The simulation of a scene script; components are reached by name."""

    def __init__(self, script: str, folder: Path) -> None:
        path = folder / "scene.py"
        path.write_text("from morse.builder import *\n" + script)
        self.simulation = morse.load(path)
        self.context = self.simulation.context
        self.world, self.clock = self.context.world, self.context.clock

    def __getitem__(self, name: str):
        return self.context.component(name)

    def run(self, seconds: float) -> None:
        self.simulation.step(round(seconds * self.clock.frequency))

    def hold(self, keys=(), axes=(), robot=None) -> None:
        """The input of the live view from now on."""
        self.simulation.set_controls(frozenset(keys), tuple(axes), robot)

    def command(self, name: str, **data) -> None:
        """Publish a command, like a client."""
        self[name].local_data.update(data)


def yaw_of(data) -> float:
    return math.remainder(data["yaw"], 2 * math.pi)
