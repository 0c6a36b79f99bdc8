"""Tasks as environments that ``gymnasium.make`` and ``gymnasium.make_vec`` know by name."""

from __future__ import annotations

import inspect
from functools import partial
from typing import TYPE_CHECKING, Any

import gymnasium

from morse.gym.env import TaskEnv
from morse.gym.vector import vector

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


def register_all() -> None:
    """Register the tasks of MORSE: Gymnasium knows them when `morse.gym` is imported."""
    for name, task in TASKS.items():
        register(name, task)
