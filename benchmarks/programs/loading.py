"""Creates simulations for measurements, exactly as ``morse run`` does."""

from __future__ import annotations

import gc
import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

import morse
from benchmarks import work

if TYPE_CHECKING:
    from morse.core.object import Object
    from morse.simulation.simulation import Simulation

SCENES = Path(__file__).parents[1] / "scenes"


def prepare(scene: str, *, view: bool = False, cameras_on: int = 0, **arguments: object) -> Simulation:
    """A simulation that is ready to tick.

    Args:
        scene: name of a file of `benchmarks.scenes`.
        view: with the live view.
        cameras_on: number of processes that render the images.
        arguments: arguments of the scene.
    """
    logging.disable(logging.WARNING)
    simulation = morse.load(
        SCENES / f"{scene}.py",
        arguments=[f"{name}={value}" for name, value in arguments.items()],
        sockets=True,
        cameras_on=cameras_on,
        view="web" if view else None,
    )
    # as in `morse run`: objects that exist now are never collected
    gc.collect()
    gc.freeze()
    return simulation


def command_all(simulation: Simulation) -> None:
    """Send every actuator the command of the work."""
    for component in simulation.loaded.actuators:
        component.local_data.update(v=work.SPEED, w=work.RATE)


def sensors_with(simulation: Simulation, field: str) -> list[Object]:
    """The sensors with a data field."""
    return [sensor for sensor in simulation.loaded.sensors if field in sensor.local_data]


def poses(simulation: Simulation) -> list[work.Pose]:
    """x, y, yaw of every robot, from its pose sensor."""
    return [_planar(sensor.local_data) for sensor in sensors_with(simulation, "yaw")]


def _planar(data: dict[str, Any]) -> work.Pose:
    return data["x"], data["y"], data["yaw"]
