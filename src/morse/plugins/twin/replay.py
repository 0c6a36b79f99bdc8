"""Drives a scene with recorded commands, and keeps what its sensors measure."""

from __future__ import annotations

import json
import logging
import math
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec
import numpy as np

import morse
from morse.core.classes.classpath import load_class
from morse.core.declarations import fields_of_component, properties
from morse.core.exceptions import MorseError
from morse.core.observer import Observer
from morse.physics import UnstableError
from morse.simulation.handles.component_handles import handle_of
from morse.system.workers import Server, Worker, WorkerPool, can_fork

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.core.interfaces import Component
    from morse.plugins.twin.parameters import Parameters
    from morse.scene import Scene
    from morse.simulation.handles.component_handles import ComponentHandle

    Floats = NDArray[np.float64]

#: words in the names of properties and classes of what makes measurements noisy
_NOISY = ("NoiseDensity", "BiasInstability", "RandomWalk", "Noise")
#: largest share of a tick that is taken for rounding
_ROUNDING = 1e-6


class ReplayError(MorseError):
    """The scene cannot be driven with these commands."""


class Samples(NamedTuple):
    """What a component has measured, or was commanded.

    Attributes:
        times: (N,) s.
        fields: by name, (N,) numbers or (N, K) lists of numbers.
    """

    times: Floats
    fields: dict[str, Floats]

    def until(self, end: float) -> Samples:
        """Those before a time, s."""
        count = int(np.searchsorted(self.times, end, side="right"))
        return Samples(self.times[:count], {name: values[:count] for name, values in self.fields.items()})


@dataclass(frozen=True)
class Probe:
    """What only a simulation of a scene knows.

    Attributes:
        frequency: ticks per simulated second.
        fields: the declared fields of each component.
        wheels: radius of the wheels and track of robots with two rows of driven wheels, m.
        rates: measurements per second of each component.
    """

    frequency: float
    fields: dict[str, dict[str, DataField]]
    wheels: dict[str, tuple[float, float]]
    rates: dict[str, float]


@contextmanager
def _silent() -> Iterator[None]:
    """A scene is loaded a hundred times: its warnings are of no use after the first time."""
    logger = logging.getLogger("morse")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def probe(scene: Scene) -> Probe:
    """Load a scene once.

    Raises:
        MorseError: the scene cannot be loaded.
    """
    with morse.load(scene, on_failure="raise") as simulation:
        components = simulation.context.components
        return Probe(
            float(simulation.clock.frequency),
            {name: dict(fields_of_component(one)) for name, one in components.items()},
            {
                name: (float(robot.wheel_radius), float(robot.track))
                for name, robot in simulation.context.robots.items()
                if hasattr(robot, "wheel_radius") and hasattr(robot, "track")
            },
            {name: float(one.frequency) for name, one in components.items()},
        )


def without_noise(scene: Scene) -> Scene:
    """A copy of a scene whose sensors measure without noise, delay and calibration, which a comparison applies."""
    scene = scene.copy()
    for one in scene.components:
        if one.kind != "sensor":
            continue
        one.options.pop("realism", None)
        left_out = ("Noise", "twin.calibration.Calibration")
        one.modifiers[:] = [
            modifier for modifier in one.modifiers if not any(name in modifier.classpath for name in left_out)
        ]
        for name in [*_noisy_properties(one.classpath), *one.node.properties]:
            if any(word in name for word in _NOISY):
                one.node.properties[name] = 0.0
    scene.alterations[:] = [one for one in scene.alterations if "Noise" not in one.name]
    return scene


def _noisy_properties(classpath: str) -> list[str]:
    return [one.name for one in properties(load_class(classpath)).values() if isinstance(one.default, float)]


def replay(
    scene: Scene, commands: Mapping[str, Samples], sensors: Mapping[str, Sequence[str]], duration: float
) -> dict[str, Samples]:
    """Simulate a scene with commands.

    Args:
        scene: plain data.
        commands: of actuators, by time since the start; each holds until the next one.
        sensors: the fields of sensors that are wanted.
        duration: simulated time, s.

    Returns:
        What the sensors have measured, until they stopped measuring finite numbers.

    Raises:
        ReplayError: a command is refused, a part fails, or there is no such sensor.
    """
    with _silent(), morse.load(scene, on_failure="raise") as simulation:
        frequency = float(simulation.clock.frequency)
        ticks = max(1, math.ceil(duration * frequency - _ROUNDING))
        try:
            orders = [(handle_of(simulation, name), _orders(one, frequency, ticks)) for name, one in commands.items()]
            keeper = _Keeper({simulation.context.components[name]: fields for name, fields in sensors.items()})
        except (LookupError, AttributeError, TypeError) as error:
            raise ReplayError(f"the scene cannot be driven by the log: {error}") from None
        simulation.observers.append(keeper)
        last = 0
        try:
            for tick in sorted({ticks, *(tick for _, table in orders for tick in table)}):
                if tick > last:
                    simulation.step(tick - last)
                    last = tick
                for handle, table in orders:
                    if tick in table:
                        _publish(handle, table[tick], tick / frequency)
        except UnstableError as error:
            raise ReplayError(f"the simulation cannot follow the commands of the log: {error}") from None
        for failure in simulation.failures:
            if failure.kind == "fallen":
                raise ReplayError(
                    f"{failure}: the world of the scene is too small for the commands of the log, or they do not fit"
                )
        return {one.name(): _samples(rows, sensors[one.name()]) for one, rows in keeper.kept.items()}


def _publish(handle: ComponentHandle, command: dict[str, Any], time: float) -> None:
    try:
        handle.publish(command)
    except MorseError as error:
        raise ReplayError(f"a command at {time:.3f} s is refused: {error}") from None


class _Keeper(Observer):
    """Keeps fields of sensors at each of their measurements."""

    def __init__(self, sensors: Mapping[Component, Sequence[str]]) -> None:
        self.kept: dict[Component, list[list[Any]]] = {one: [] for one in sensors}
        self._sensors = [(one, tuple(fields), self.kept[one]) for one, fields in sensors.items()]
        self._last = [math.nan] * len(self._sensors)

    def after_tick(self) -> None:
        """Keep what was measured in this tick."""
        for number, (one, fields, rows) in enumerate(self._sensors):
            data = one.local_data
            time = data["timestamp"]
            if time != self._last[number]:
                self._last[number] = time
                row = [time]
                for field in fields:
                    value = data[field]
                    row.append(
                        value if type(value) is float else [*value] if hasattr(value, "__len__") else float(value)
                    )
                rows.append(row)


def _samples(rows: list[list[Any]], fields: Sequence[str]) -> Samples:
    if not rows:
        return Samples(np.empty(0), {field: np.empty(0) for field in fields})
    columns = list(zip(*rows, strict=True))
    return Samples(
        np.array(columns[0], float),
        {field: np.array(column, float) for field, column in zip(fields, columns[1:], strict=True)},
    )


def _orders(one: Samples, frequency: float, ticks: int) -> dict[int, dict[str, Any]]:
    """The commands of ticks: the mean of what holds during the tick, whatever the rate of the log is."""
    starts = one.times * frequency
    rounded = np.round(starts)
    starts = np.where(np.abs(starts - rounded) < 1e-3, rounded, starts)
    table: dict[int, dict[str, Any]] = {}
    numbers = {name: np.asarray(values, float) for name, values in one.fields.items()}
    for tick in sorted({int(edge) for edge in np.floor(starts)} | {int(edge) for edge in np.ceil(starts)}):
        if not 0 <= tick < ticks:
            continue
        first = int(np.searchsorted(starts, tick, side="right")) - 1
        last = int(np.searchsorted(starts, tick + 1, side="left"))
        if last <= 0:
            continue
        first = max(first, 0)
        edges = np.clip([*starts[first:last], tick + 1], tick, tick + 1)
        shares = np.diff(edges)
        if shares.sum() <= 0.0:
            continue
        shares = shares / shares.sum()
        table[tick] = {name: _mean(shares, values[first:last]) for name, values in numbers.items()}
    return table


def _mean(shares: Floats, values: Floats) -> Any:
    """The weighted mean of commands, as numbers of Python: what commands consist of."""
    total = shares[0] * values[0]
    for share, value in zip(shares[1:], values[1:], strict=True):
        total = total + share * value
    return total.tolist()


# -- in several processes --------------------------------------------------------------------


class Simulating(Server):
    """Simulates a scene with values of its parameters.

    Args:
        commands: one or more sets of commands, each as for `replay`.
    """

    def __init__(
        self,
        parameters: Parameters,
        commands: Sequence[Mapping[str, Samples]],
        sensors: Mapping[str, Sequence[str]],
    ) -> None:
        self._parameters, self._commands, self._sensors = parameters, commands, sensors

    def traces(self, values: Mapping[str, float], duration: float, which: int = 0) -> dict[str, Samples]:
        """See `replay`."""
        commands = {name: one.until(duration) for name, one in self._commands[which].items()}
        return replay(self._parameters.scene_of(values), commands, self._sensors, duration)

    def answer(self, question: bytes) -> bytes:
        """The measurements for values, a duration and a set of commands, as bytes."""
        values, duration, which = json.loads(question)
        try:
            traces = self.traces(values, duration, which)
        except Exception as error:
            return b"!" + str(error).encode("utf-8", "replace")
        content = {
            name: [
                one.times.tobytes(),
                {field: [list(array.shape), array.tobytes()] for field, array in one.fields.items()},
            ]
            for name, one in traces.items()
        }
        return b"=" + msgspec.msgpack.encode(content)


def _read(answer: bytes) -> dict[str, Samples]:
    if answer[:1] == b"!":
        raise ReplayError(answer[1:].decode("utf-8", "replace"))
    return {
        name: Samples(
            np.frombuffer(times),
            {field: np.frombuffer(array).reshape(shape) for field, (shape, array) in fields.items()},
        )
        for name, (times, fields) in msgspec.msgpack.decode(answer[1:]).items()
    }


class Simulations:
    """Many simulations of a scene with other values, in several processes.

    Args:
        commands: one or more sets of commands, each as for `replay`.
        workers: number of processes; 0 for this one.

    Attributes:
        count: number of simulations so far.
        seconds: simulated time so far, s.
        which: number of the set of commands that is simulated.
    """

    def __init__(
        self,
        parameters: Parameters,
        commands: Sequence[Mapping[str, Samples]],
        sensors: Mapping[str, Sequence[str]],
        workers: int,
    ) -> None:
        self.count, self.seconds, self.which = 0, 0.0, 0
        self._here = Simulating(parameters, commands, sensors)
        self._pool: WorkerPool[Worker] | None = None
        if workers > 1 and can_fork():
            self._pool = WorkerPool(
                workers,
                lambda: Worker.copy(Simulating, parameters, commands, sensors),
                attempts=2,
                what="a process that simulates",
            )

    def each(self, points: Sequence[Mapping[str, float]], duration: float) -> list[dict[str, Samples]]:
        """The measurements for the values of each point.

        Raises:
            ReplayError: a simulation has failed.
        """
        self.count += len(points)
        self.seconds += len(points) * duration
        pool = self._pool
        if pool is None or len(points) == 1:
            return [self._here.traces(values, duration, self.which) for values in points]
        questions = [json.dumps([dict(values), duration, self.which]).encode() for values in points]
        futures = [pool.submit(partial(Worker.ask, question=question)) for question in questions]
        return [_read(future.result()) for future in futures]

    def __enter__(self) -> Simulations:
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.close()
