"""Episodes of a task in the rows of a batch, and what differs between the rows and the episodes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from gymnasium import spaces
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

from morse.core.reports.quoting import nearest
from morse.gym.task import Data, Read, Task, Touch, actions_of, check_task, outcome
from morse.simulation.handles.component_handles import handle_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.gym.task import Command
    from morse.gym.values import Arrays, Infos, Observation
    from morse.many.parameters import Distribution


def space_of(read: Read, declared: Mapping[str, DataField], values: NDArray[np.generic]) -> spaces.Box:
    """Return the space of data: uint8 for pictures, else float32 within the declared ranges.

    Args:
        declared: the declared data of the component.
        values: (N, ...) the present data.

    Raises:
        TypeError: the data are not numbers.
    """
    if values.dtype.kind not in "biuf":
        raise TypeError(f"{', '.join(read.fields)} of {read.component} is not made of numbers: it cannot be observed")
    shape = values.shape[1:] or (1,)
    if values.dtype == np.uint8:
        return spaces.Box(0, 255, shape, np.uint8)
    low, high = np.full(shape, -np.inf, np.float32), np.full(shape, np.inf, np.float32)
    if len(read.fields) == 1:
        limits(declared.get(read.fields[0]), low, high, ...)
    elif shape == (len(read.fields),):
        for index, name in enumerate(read.fields):
            limits(declared.get(name), low, high, index)
    return spaces.Box(low, high, dtype=np.float32)


def limits(field: Any, low: np.ndarray, high: np.ndarray, index: Any) -> None:
    """Set the range of a declared field."""
    if field is None:
        return
    if field.low is not None and "-inf" not in field.allow:
        low[index] = field.low
    if field.high is not None and "inf" not in field.allow:
        high[index] = field.high
    if field.angle:
        low[index], high[index] = np.float32(-np.pi), np.float32(np.pi)


def action_space(commands: Sequence[Command]) -> spaces.Box:
    """Return the space of the actions: the numbers of all commands, side by side."""
    low, high = np.array([limits for command in commands for limits in command.ranges.values()], np.float32).T
    return spaces.Box(low, high, dtype=np.float32)


def fitted(values: NDArray[np.generic], space: spaces.Space[Observation]) -> np.ndarray:
    """Return values of all rows in the type, the shape and the range of a space."""
    array = np.array(values, getattr(space, "dtype", None))
    shape = space.shape
    if shape is not None and array.shape[1:] != shape:
        array = array.reshape(len(array), *shape)
    if isinstance(space, spaces.Box) and array.dtype.kind == "f":
        np.clip(array, space.low, space.high, out=array)  # float32 may round beyond a limit
    return array


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
    simulation, full = many[row], many.name_in(row, name)
    objects = simulation.context.world.objects_by_name
    if full not in objects:
        raise KeyError(f"there is no object '{full}'{nearest(full, list(objects))}")
    obj = objects[full]
    x, y, z = obj.worldPosition
    roll, pitch, yaw = obj.worldOrientation.to_euler()
    present = {"x": x, "y": y, "z": z, "roll": roll, "pitch": pitch, "yaw": yaw}
    return [float(number) for number in (present | pose).values()]


#: name of an observation that is not a dictionary
_NAME = "observation"


class Episodes:
    """Runs a task in all rows.

    Attributes:
        many: the batch.
        observation_space, action_space: of one row.
        generators: a generator of random numbers for each row.

    Args:
        task: a task, or its class.
        load: loads the batch of a task.
        first_row: number of the first row in the whole vector.

    Raises:
        TypeError: the task lacks an attribute, or has one of a wrong type.
    """

    def __init__(self, task: Task | Callable[[], Task], load: Callable[[Task], Any], first_row: int = 0) -> None:
        self.task = task = task if isinstance(task, Task) or not callable(task) else task()
        check_task(task)
        task.first_row = first_row
        self.many = many = load(task)
        task.many = many
        self._rows = len(many)
        self.generators = [np.random.default_rng(first_row + row) for row in range(self._rows)]
        try:
            commands = task.commands
            self._drives = [many.command(command.component, *command.ranges) for command in commands]
            self.action_space = action_space(commands)
            self._actions = np.zeros((self._rows, *self.action_space.shape), np.float32)
            self._data: Arrays = {}
            task.values = Data()
            seen = task.observation
            several = isinstance(seen, Mapping)
            named: dict[str, object] = dict(seen) if isinstance(seen, Mapping) else {_NAME: seen}
            own = {name: self._bind(name, part) for name, part in {**task.data, **named}.items()}
            parts = {name: own[name] for name in named}
            self.observation_space: Any = spaces.Dict(parts) if several else parts[_NAME]
        except BaseException:
            many.close()
            raise
        self._age = np.zeros(self._rows, np.int64)
        self.drawn: list[Infos] = [{} for _ in range(self._rows)]
        self._now = Data()
        self._is_closed = False

    def _bind(self, name: str, part: Any) -> spaces.Space[Observation]:
        many = self.many
        if isinstance(part, Read):
            values = self._data[name] = many.read(part.component, *part.fields)
            return space_of(part, many.declarations(part.component), values)
        if isinstance(part, Touch):
            self._data[name] = many.contacts(part.robot)
            return spaces.Box(0.0, 1.0, (1,), np.float32)
        if isinstance(part, spaces.Space) and part.shape is not None:
            self.task.values[name] = np.zeros((self._rows, *part.shape), part.dtype)
            return part
        raise TypeError(f"'{name}' is a Read, a Touch or a space of Gymnasium with a shape, not {part!r:.80}")

    # -- episodes --------------------------------------------------------------------------

    @property
    def has_begun(self) -> bool:
        """Whether all rows have an episode, which may be over."""
        return bool(self._now)

    def begin(self, rows: Sequence[int], seeds: Sequence[int] | None = None) -> None:
        """Begin episodes in some rows.

        Args:
            seeds: seeds of the rows; None to go on with their generators.
        """
        if self._is_closed:
            raise ClosedEnvironmentError("this environment is closed: make it again")
        if not len(rows):
            return
        task, many = self.task, self.many
        if seeds is not None:
            for row, seed in zip(rows, seeds, strict=True):
                self.generators[row] = np.random.default_rng(seed)
        rngs = [self.generators[row] for row in rows]
        if seeds is not None or task.restarts or task.vary:
            many.restart(list(rows), [int(rng.integers(2**31)) for rng in rngs])
        for row, rng in zip(rows, rngs, strict=True):
            self.drawn[row] = draw(task, row, rng)
        task.start(list(rows), rngs)
        many.measure(list(rows))
        self._age[list(rows)] = 0
        self._actions[list(rows)] = 0.0
        self._now = self._look()

    def step(self, actions: np.ndarray) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], Arrays]:
        """Do an action in all rows.

        Returns:
            (N,) rewards, terminated, truncated, and arrays of infos by name.

        Raises:
            ValueError: the actions have another shape, or one is NaN; no time has passed then.
            TypeError, ValueError: the task has returned something else than rewards, ends and infos.
            ClosedEnvironmentError, ResetNeeded: the environment is closed, or no episode has begun.
        """
        task, space = self.task, self.action_space
        if self._is_closed:
            raise ClosedEnvironmentError("this environment is closed: make it again")
        if not self.has_begun:
            raise ResetNeeded("no episode has begun: call reset() before step()")
        self._actions = np.clip(actions_of(actions, self._actions.shape), space.low, space.high)
        first = 0
        for drive in self._drives:
            last = first + drive[0].size
            drive[:] = self._actions[:, first:last].reshape(drive.shape)
            first = last
        self.many.step(task.ticks, measure=True)
        self._age += 1
        before, self._now = self._now, self._look()
        rewards, terminated, infos = outcome(task, task.reward(before, self._now), self._rows)
        late = np.zeros(self._rows, bool) if task.limit is None else self._age >= task.limit
        return rewards, terminated, late & ~terminated, infos

    def _look(self) -> Data:
        data = Data((name, np.array(values)) for name, values in self._data.items())
        data.update((name, values.copy()) for name, values in self.task.values.items())
        data["action"] = self._actions
        return data

    def observations(self) -> Observation:
        """Return the observations of all rows, in the types of the space; they are not changed later."""
        seen, space = self.task.observe(self._now), self.observation_space
        if isinstance(space, spaces.Dict):
            return {name: fitted(seen[name], part) for name, part in space.spaces.items()}
        return fitted(seen, space)

    # -- pictures, the end -----------------------------------------------------------------

    def picture(self, row: int = 0) -> NDArray[np.uint8]:
        """Return (H, W, 3) the image of the camera of the task, or a view of the scene."""
        simulation = self.many[row]
        if self.task.camera:
            data = handle_of(simulation, self.task.camera).data
            image: NDArray[np.uint8] = np.ascontiguousarray(data["image"][..., :3])
            return image
        view: NDArray[np.uint8] = simulation.picture(320, 240)
        return view

    def close(self) -> None:
        """End the simulations; closing them again has no effect."""
        self._is_closed = True
        self.many.close()

    def __reduce__(self) -> NoReturn:
        raise TypeError(
            "an environment holds running simulations and cannot be copied or pickled: pass a function that makes it, "
            "such as lambda: gymnasium.make('morse/Reach-v0')"
        )
