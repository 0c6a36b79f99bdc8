"""Tasks as environments that ``gymnasium.make`` and ``gymnasium.make_vec`` know by name."""

from __future__ import annotations

import inspect
import logging
from functools import partial
from typing import TYPE_CHECKING, Any

import gymnasium

from morse.core.classes.plugins import PluginError, entry_points, load
from morse.gym.env import TaskEnv
from morse.gym.vector import vector
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.gym.task import Task


def register(name: str, task: type[Task] | str, **options: object) -> None:
    """Register a task: ``gymnasium.make(name)``, ``gymnasium.make_vec(name, num_envs=64, workers=8)``.

    Args:
        name: such as ``my_lab/Reach-v0``.
        task: the class, or ``module:class``.
        options: further arguments of `gymnasium.register`.

    Other arguments of `gymnasium.make` are arguments of the class: ``gymnasium.make("morse/Reach-v0", layouts=[7])``.
    """
    gymnasium.register(
        name,
        entry_point=partial(_make, TaskEnv, task),
        vector_entry_point=partial(_make, vector, task),
        **options,
    )


def _make(create: Callable[..., object], task: type[Task] | str, **options: object) -> Any:
    kind: Any = task
    if isinstance(task, str):
        from importlib import import_module

        module, _, name = task.partition(":")
        kind = getattr(import_module(module), name)
    own = {name: value for name, value in options.items() if name not in inspect.signature(create).parameters}
    return create(partial(kind, **own) if own else kind, **{name: options[name] for name in options.keys() - own})


#: the tasks of MORSE
TASKS = {
    "morse/Reach-v0": "morse.gym.reach:Reach",
    "morse/ReachDepth-v0": "morse.gym.reach:ReachDepth",
    "morse/Walk-v0": "morse.gym.walk:Walk",
}


logger = logging.getLogger(__name__)


def register_all() -> None:
    """Register the tasks of MORSE, and of packages with an entry point ``morse.tasks``: a dictionary as `TASKS`.

    Gymnasium knows them when `morse.gym` is imported.
    """
    found = dict(TASKS)
    for point in entry_points("morse.tasks"):
        try:
            # a name that exists keeps its task
            found = {**load(point, _checked), **found}
        except PluginError as error:  # a broken package must not prevent loading the others
            logger.warning("the tasks of %s are left out: %s", point.value, error, extra=OF_MACHINE)
    for name, task in found.items():
        register(name, task)


def _checked(entry: object) -> dict[str, str]:
    if not isinstance(entry, dict):
        raise TypeError(f"expected a dictionary of names and 'module:class', got {type(entry).__name__}")
    for name, task in entry.items():
        if not isinstance(name, str) or not isinstance(task, str) or ":" not in task:
            raise TypeError(
                f"expected a name such as 'my_lab/Park-v0' and 'module:class', got {name!r:.80}: {task!r:.80}"
            )
    return entry
