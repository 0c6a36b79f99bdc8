"""A task of reinforcement learning, written once for one simulation, many, and many processes."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

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
        """A function that builds a scene is no method, although it stands in a class."""
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
