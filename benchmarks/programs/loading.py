"""Makes simulations to be measured, exactly as ``morse run`` does."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmarks import work
from morse.assets.collision import resolve_shapes
from morse.builder.script import load_scene
from morse.simulation.options import RunOptions
from morse.simulation.simulation import Simulation
from morse.simulation.viewing import open_view

if TYPE_CHECKING:
    from morse.core.object import Object

SCENES = Path(__file__).parents[1] / "scenes"


def prepare(scene: str, *, view: bool = False, **arguments: object) -> Simulation:
    """A simulation that is ready to tick.

    Args:
        scene: name of a file of `benchmarks.scenes`.
        view: with the live view.
        arguments: of the scene.
    """
    logging.disable(logging.WARNING)
    options = RunOptions(
        str(SCENES / f"{scene}.py"),
        arguments=[f"{name}={value}" for name, value in arguments.items()],
        view="web" if view else "none",
        view_port=0,
        open_browser=False,
    )
    described = load_scene(options)
    resolve_shapes(described)
    simulation = Simulation(described, options)
    simulation.load()
    simulation.view = open_view(simulation)
    if simulation.view is not None:
        simulation.view.announce()
    return simulation


def command_all(simulation: Simulation) -> None:
    """Give every actuator the command of the work."""
    for component in simulation.loaded.actuators:
        component.local_data.update(v=work.SPEED, w=work.RATE)


def sensors_with(simulation: Simulation, field: str) -> list[Object]:
    """The sensors whose data have a field."""
    return [sensor for sensor in simulation.loaded.sensors if field in sensor.local_data]


def poses(simulation: Simulation) -> list[work.Pose]:
    """x, y, yaw of every robot, as its pose sensor says."""
    return [_planar(sensor.local_data) for sensor in sensors_with(simulation, "yaw")]


def _planar(data: dict[str, Any]) -> work.Pose:
    return data["x"], data["y"], data["yaw"]
