"""What differs between the rows and the episodes of a task, drawn from distributions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.reports.hints import nearest

if TYPE_CHECKING:
    from morse.gym.task import Task
    from morse.gym.values import Infos
    from morse.many.parameters import Distribution

AGENT = "{agent}"
#: parameters that the batch varies, and those of a pose
_VARIED, _POSE = ("mass", "friction", "light", "color", "texture"), ("x", "y", "z", "yaw")


def arguments_of(task: Task, row: int) -> Infos:
    """Return the arguments of the scene of a row, which depend on its number in the whole vector alone."""
    rng = np.random.default_rng([row, 1])
    return {name: distribution.draw(rng) for name, distribution in task.arguments.items()}


def scenes_of(task: Task, first: int, count: int) -> Any:
    """Return the scenes for the rows from ``first`` on: rows use a list of scenes in turn."""
    scene = task.scene
    if not task.arguments:
        if not isinstance(scene, (list, tuple)):
            return scene
        start = first % len(scene)
        return [*scene[start:], *scene[:start]]
    scenes = scene if isinstance(scene, (list, tuple)) else [scene]
    rows = range(first, first + count)
    return [partial(scenes[row % len(scenes)], **arguments_of(task, row)) for row in rows]


def draw(task: Task, row: int, rng: np.random.Generator) -> dict[str, object]:
    """Draw the parameters of an episode of a row, and apply them.

    Returns:
        The values by name: ``scene.boxes``, ``robot.mass``.

    Raises:
        KeyError: there is no such parameter.
    """
    values = {f"scene.{name}": value for name, value in arguments_of(task, task.first_row + row).items()}
    for name, parameters in task.vary.items():
        for what in parameters:
            if what not in (*_VARIED, *_POSE):
                known = ", ".join((*_VARIED, *_POSE))
                raise KeyError(f"vary: '{name}' has '{what}'{nearest(what, [*_VARIED, *_POSE])}; expected {known}")
        numbers: Infos = {what: _drawn(what, one, rng) for what, one in parameters.items()}
        if varied := {what: number for what, number in numbers.items() if what in _VARIED}:
            task.many.vary(name, rows=[row], **varied)
        if pose := {what: number for what, number in numbers.items() if what in _POSE}:
            task.many.place([row], name, [_pose(task.many, row, name, pose)])
        values |= {f"{name}.{what}": number for what, number in numbers.items()}
    return values


def _drawn(what: str, distribution: Distribution, rng: np.random.Generator) -> Any:
    if what == "color":
        return [float(distribution.draw(rng)) for _ in range(3)]
    return str(distribution.draw(rng)) if what == "texture" else float(distribution.draw(rng))


def _pose(many: Any, row: int, name: str, pose: dict[str, float]) -> list[float]:
    """x, y, z, roll, pitch, yaw: the drawn ones, and the present others."""
    simulation = many[row]
    full = name.replace(AGENT, many.agents[row]) if AGENT in name else name
    objects = simulation.context.world.objects_by_name
    if full not in objects:
        raise KeyError(f"there is no object '{full}'{nearest(full, list(objects))}")
    obj = objects[full]
    x, y, z = obj.worldPosition
    roll, pitch, yaw = obj.worldOrientation.to_euler()
    present = {"x": x, "y": y, "z": z, "roll": roll, "pitch": pitch, "yaw": yaw}
    return [float(number) for number in (present | pose).values()]
