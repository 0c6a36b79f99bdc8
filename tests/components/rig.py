"""A robot with components in a small world, ticked by hand, without network and wall clock."""

from __future__ import annotations

import math
from pathlib import Path  # noqa: TC003

from morse.assets.collision import resolve_shapes
from morse.builder.script import load_scene
from morse.core import context as contexts
from morse.core.clock import Clock
from morse.core.context import Context
from morse.core.request_manager import MorseServices
from morse.physics import World
from morse.simulation.loader import load_components
from morse.simulation.options import RunOptions


class Rig:
    """The components of a scene script; they are reached by name."""

    def __init__(self, script: str, folder: Path) -> None:
        path = folder / "scene.py"
        path.write_text("from morse.builder import *\n" + script)
        scene = load_scene(RunOptions(str(path)))
        resolve_shapes(scene)
        for declaration in scene.components:
            declaration.streams.clear()
            declaration.managers.clear()
        settings = scene.settings
        self.context = Context(
            scene=scene,
            clock=Clock(settings.frequency, settings.time_strategy),
            world=World(scene),
            services=MorseServices(),
            network=None,
            seed=settings.seed,
        )
        contexts.set_current(self.context)
        self.loaded = load_components(self.context)
        self.world, self.clock = self.context.world, self.context.clock

    def __getitem__(self, name: str):
        return self.context.components.get(name) or self.context.robots[name]

    def tick(self) -> None:
        for component in [*self.loaded.robots, *self.loaded.actuators]:
            component.action()
        self.world.step()
        self.clock.advance()
        for component in [*self.loaded.robots, *self.loaded.sensors]:
            component.action()

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * self.clock.frequency)):
            self.tick()

    def command(self, name: str, **data) -> None:
        """What a client publishes."""
        self[name].local_data.update(data)


def yaw_of(data) -> float:
    return math.remainder(data["yaw"], 2 * math.pi)
