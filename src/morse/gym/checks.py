"""Checks of a task, of what its functions return, and of actions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.reports.hints import nearest
from morse.core.values import Fields
from morse.gym.task import Command, Task
from morse.gym.values import columns_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.gym.values import Arrays


class Data(Fields):
    """Arrays by name; a name that is not there is named with the nearest one."""

    def __missing__(self, name: object) -> object:
        raise KeyError(f"the task has no data '{name}'{nearest(str(name), list(self))}")


def check_task(task: Task) -> None:
    """Check the attributes that are needed before the scene is loaded.

    Raises:
        TypeError: an attribute is missing, or has a wrong type.
        ValueError: ``ticks`` or ``limit`` is less than 1.
    """
    kind = type(task).__name__
    if not isinstance(task, Task):
        mend = "; gymnasium.make_vec knows tasks by their names" if isinstance(task, str) else ""
        raise TypeError(f"a task is a morse.gym.Task, not {task!r:.80}{mend}")
    for name in ("scene", "action", "observation"):
        if getattr(task, name, None) is None:
            raise TypeError(f"{kind} has no attribute '{name}'; see morse.gym.Task")
    actions = task.action if isinstance(task.action, list | tuple) and task.action else [task.action]
    for action in actions:
        if not isinstance(action, Command):
            raise TypeError(f"action is a morse.gym.Command or a list of them, not {action!r:.80}")
    for name, number in {"ticks": task.ticks, "limit": 1 if task.limit is None else task.limit}.items():
        if isinstance(number, bool) or not hasattr(number, "__index__"):
            raise TypeError(f"'{name}' of {kind} is an integer, not {number!r:.80}")
        if number < 1:
            raise ValueError(f"'{name}' of {kind} is at least 1, not {number}")


def actions_of(actions: object, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Return actions as an array of a shape.

    Raises:
        ValueError: they are not numbers, have another shape, or contain NaN.
    """
    try:
        array = np.asarray(actions, np.float32)
    except (TypeError, ValueError):
        raise ValueError(f"actions are an array of numbers of the shape {shape}, not {actions!r:.80}") from None
    if array.shape != shape:
        raise ValueError(f"actions have the shape {array.shape}, expected {shape}")
    if np.isnan(array).any():
        *rows, _ = np.argwhere(np.isnan(array))[0].tolist()
        where = f"action of row {rows[0]}" if rows else "action"
        raise ValueError(f"the {where} is {array[tuple(rows)].tolist()}: it contains NaN")
    return array


def outcome(task: Task, values: object, rows: int) -> tuple[NDArray[np.float64], NDArray[np.bool_], Arrays]:
    """Return what the method ``reward`` of a task has returned, as arrays (N,) and infos (N, ...) by name.

    Raises:
        TypeError: it is no triple of numbers, booleans and a dictionary.
        ValueError: an array or an info has another length, or a reward is NaN.
    """
    name = f"{type(task).__name__}.reward"
    form = "rewards (N,), whether the episodes are over (N,), and a dictionary of infos"
    if not isinstance(values, tuple) or len(values) != 3 or not isinstance(values[2], dict):
        raise TypeError(f"{name} returns {form}, not {values!r:.80}")
    arrays = []
    for what, value, kind in (("rewards", values[0], np.float64), ("ends of episodes", values[1], np.bool_)):
        array = np.asarray(value)
        if array.shape not in ((), (rows,)):
            raise ValueError(f"{name} has returned {what} of the shape {array.shape}, expected ({rows},)")
        arrays.append(np.broadcast_to(array.astype(kind), (rows,)).copy())
    if np.isnan(arrays[0]).any():
        raise ValueError(f"{name} has returned NaN for row {task.first_row + int(np.isnan(arrays[0]).argmax())}")
    return arrays[0], arrays[1], columns_of(values[2], rows, name)
