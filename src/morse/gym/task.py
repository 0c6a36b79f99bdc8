"""A task of reinforcement learning, written once for one simulation, many, and many processes; and its checks."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from morse.core.reports.quoting import nearest
from morse.core.values import Fields
from morse.gym.values import columns_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.gym.values import Arrays, Observation
    from morse.many.parameters import Distribution


class Command:
    """What an action commands: data fields of an actuator.

    Args:
        component: full name of an actuator.
        ranges: ``field=(low, high)``; the actions are numbers in these ranges.
    """

    def __init__(self, component: str, **ranges: tuple[float, float]) -> None:
        if not ranges:
            raise TypeError(f"Command('{component}') needs its fields: v=(0.0, 1.0)")
        self.component, self.ranges = component, ranges
        for name, limits in ranges.items():
            low, high = limits
            if not -np.inf < low < high < np.inf:
                raise ValueError(f"the range of '{name}' of {component} is two finite numbers, not {limits!r}")


class Read:
    """Data fields of a component; see `morse.many.batch.Batch.read`."""

    def __init__(self, component: str, *fields: str) -> None:
        self.component, self.fields = component, fields


class Touch:
    """Whether a robot has touched anything but the floor in the step: 0 or 1."""

    def __init__(self, robot: str) -> None:
        self.robot = robot


class Task:
    """A task; subclass it.

    All functions see arrays with one row for each simulation, N rows. ``self.many`` is the `morse.many.Batch`.

    Attributes:
        scene: a scene as for `morse.load`, or a list of scenes for the rows in turn.
        ticks: number of ticks of an action.
        limit: number of actions after which an episode is truncated; None for no limit.
        action: what the actions command; a list of `Command` for several actuators, whose numbers stand side by side.
        observation: what the agent sees: a `Read`, a `Touch`, a space of Gymnasium, or a dictionary of these. The
            values of a space are ``self.values[name]`` (``self.values["observation"]`` without a dictionary), which the
            task sets; or `observe` returns them.
        data: further data that the functions need: name to `Read` or `Touch`.
        arguments: arguments of the function ``scene`` and their distributions, which are drawn once for each row.
        vary: name of a robot, an object or a lamp to parameters and their distributions, which each episode draws:
            ``{"robot": {"mass": uniform(8.0, 12.0)}}``. Parameters are those of `morse.many.batch.Batch.vary`, and the
            pose: x, y, z, yaw, m and rad. Three numbers are drawn for a colour.
        restarts: whether each episode restarts the simulation; else it continues from where `start` places things,
            which is faster.
        camera: full name of a colour camera whose image `render` returns; empty for a view of the scene.
        values: name to an array (N, ...) that the task sets.
        first_row: number of the first row; not 0 in a process that has a part of the rows.
    """

    scene: Any = None
    ticks: ClassVar[int] = 6
    limit: ClassVar[int | None] = None
    action: ClassVar[Command | Sequence[Command]]
    observation: ClassVar[object]
    data: ClassVar[Mapping[str, Read | Touch]] = {}
    arguments: ClassVar[Mapping[str, Distribution]] = {}
    vary: ClassVar[Mapping[str, Mapping[str, Distribution]]] = {}
    restarts: ClassVar[bool] = True
    camera: ClassVar[str] = ""

    first_row = 0
    many: Any
    values: Arrays

    def __init_subclass__(cls, **kwargs: object) -> None:
        """A function that builds a scene is not a method, although it stands in a class."""
        super().__init_subclass__(**kwargs)
        scene = vars(cls).get("scene")
        if inspect.isfunction(scene) and all(
            parameter.default is not parameter.empty for parameter in inspect.signature(scene).parameters.values()
        ):
            cls.scene = staticmethod(scene)

    def start(self, rows: Sequence[int], rngs: Sequence[np.random.Generator]) -> None:
        """Begin episodes: place robots, choose goals. The sensors measure afterwards.

        Args:
            rows: (M,) numbers of the rows.
            rngs: (M,) a generator for each of them, which is determined by the seed of the row.
        """

    @property
    def commands(self) -> list[Command]:
        """What the actions command, as a list."""
        return [self.action] if isinstance(self.action, Command) else list(self.action)

    def observe(self, data: Arrays) -> Observation:
        """Return the observations of all rows; by default the data that ``observation`` names.

        Args:
            data: name to (N, ...): all of ``observation`` and ``data``, and ``action``, the last actions.
        """
        if isinstance(self.observation, Mapping):
            return {name: data[name] for name in self.observation}
        return data["observation"]

    def reward(self, before: Arrays, now: Arrays) -> tuple[np.ndarray, np.ndarray, Arrays]:
        """Return (N,) rewards, (N,) whether the episodes are over, and (N,) arrays of infos by name.

        Args:
            before, now: the data before and after the action; see `observe`.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method reward(before, now)")


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
        TypeError: it is not a triple of numbers, booleans and a dictionary.
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
