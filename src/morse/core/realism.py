"""Delay and noise of real sensors."""

from __future__ import annotations

import copy
import math
from collections import deque
from copy import deepcopy
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from morse.core.declarations import fields_of_component
from morse.core.guard import modify
from morse.core.streams.extent import check_fields
from morse.core.streams.functions import publish
from morse.core.streams.local_data import LocalData
from morse.core.units import conversion
from morse.mathutils.portable import norm

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.core.sensor import Sensor
    from morse.core.values import Fields, Value
    from morse.scene.component import NoiseModel, RealismModel


_WIDE = 16


class GeneratorState(TypedDict):
    """What determines all future numbers of a generator."""

    state: bytes
    increment: bytes
    half_used: int
    half: int


class NoiseState(TypedDict):
    """What determines the future errors of a `Noise`."""

    random: GeneratorState
    bias: NDArray[np.float64] | float


class RealismState(TypedDict):
    """What determines the future data of a `Realism`."""

    truth: Fields
    last: float | None
    waiting: list[list[Any]]
    noises: dict[str, NoiseState]


def generator_state(generator: np.random.Generator) -> GeneratorState:
    """Return the state that determines all future numbers of a generator from `Context.random`."""
    state = generator.bit_generator.state
    return {
        # most formats cannot carry integers of 128 bits
        "state": state["state"]["state"].to_bytes(_WIDE, "little"),
        "increment": state["state"]["inc"].to_bytes(_WIDE, "little"),
        "half_used": int(state["has_uint32"]),
        "half": int(state["uinteger"]),
    }


def set_generator_state(generator: np.random.Generator, state: GeneratorState) -> None:
    """Restore a state that `generator_state` returned."""
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {
            "state": int.from_bytes(state["state"], "little"),
            "inc": int.from_bytes(state["increment"], "little"),
        },
        "has_uint32": state["half_used"],
        "uinteger": state["half"],
    }


class Noise:
    """The sequence of measurement errors of one field of one sensor.

    Args:
        random: generator of all random numbers.
        field: the declaration of the field, or None; values are kept within its range.
    """

    def __init__(self, model: NoiseModel, random: np.random.Generator, field: DataField | None = None) -> None:
        self.model = model
        self._field = field
        self._random = random
        self._bias: NDArray[np.float64] | float = 0.0
        self._step = 0.0

    def pass_time(self, seconds: float) -> None:
        """Advance the errors by the time between two measurements, s."""
        self._step = math.sqrt(seconds) * self.model.bias_walk

    def errors(self, truth: NDArray[np.float64], *, common: bool = False) -> NDArray[np.float64]:
        """Return the true values with errors, same shape.

        Args:
            common: all values share one bias, like the beams of one scanner.
        """
        model, value = self.model, truth
        if model.bias_walk > 0.0:
            shape = () if common else self._shape_of_bias(truth)
            if np.shape(self._bias) not in ((), shape):
                self._bias = 0.0  # the number of values has changed
            self._bias = self._bias + self._random.normal(0.0, 1.0, shape) * self._step
            value = value + self._bias
        if model.gaussian > 0.0:
            value = value + self._random.normal(0.0, model.gaussian, truth.shape)
        if model.quantization > 0.0:
            value = np.round(value / model.quantization) * model.quantization
        return value

    def _shape_of_bias(self, truth: NDArray[np.float64]) -> tuple[int, ...]:
        """One bias for each value, but a common one for the pixels of an image and the points of a cloud."""
        shape = None if self._field is None else self._field.shape
        if shape is None or len(shape) < 2 or None not in shape:
            return truth.shape
        free = len(shape) - shape[::-1].index(None)
        return truth.shape[free:]

    def possible(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the nearest values that the field can contain.

        Angles are wrapped to (-pi, pi], or (-180, 180] degrees; quaternions have the length 1; numbers are clipped to
        low..high.
        """
        field = self._field
        if field is None:
            return values
        if field.angle:
            turn = 2.0 * math.pi * conversion("rad", field.unit)[0]
            # the remainder is in [0, turn), so that the result is in (-turn/2, turn/2]
            values = turn / 2.0 - np.mod(turn / 2.0 - values, turn)
        if field.quaternion:
            length = float(norm(values))
            values = values / length if length > 0.0 else np.array([1.0, 0.0, 0.0, 0.0])
        if field.low is not None or field.high is not None:
            in_range = np.clip(values, field.low, field.high)
            values = np.where(np.isfinite(values), in_range, values)
        return values

    def get_state(self) -> NoiseState:
        """Return the state that determines the future errors, as plain data."""
        return {"random": generator_state(self._random), "bias": copy.copy(self._bias)}

    def set_state(self, state: NoiseState) -> None:
        """Restore a state that `get_state` returned."""
        set_generator_state(self._random, state["random"])
        self._bias = copy.copy(state["bias"])

    def lost(self, count: int = 1) -> NDArray[np.bool_]:
        """Return (N,) booleans: which values are lost."""
        if self.model.dropout == 0.0:
            return np.zeros(count, dtype=bool)
        return self._random.random(count) < self.model.dropout


def measured(value: Value, noise: Noise) -> Value:
    """Return a number, vector or list of numbers with errors, of the same type."""
    truth = np.array(value, dtype=np.float64)
    if truth.size == 0:
        return value
    result = noise.possible(noise.errors(truth))
    if isinstance(value, np.ndarray):
        return (np.rint(result) if value.dtype.kind in "iu" else result).astype(value.dtype)
    if isinstance(value, (int, float, list)):
        return result.tolist()
    return type(value)(result.tolist())


class Realism:
    """The measurement of a sensor that is not ideal: measure, noise, report, modifiers, delay.

    The errors are added to the published data, never to the internal data of the sensor: a sensor that integrates its
    measurements does not integrate the noise.

    Attributes:
        sensor: the sensor.
        phase: time of the first measurement after the start, s.
        start: time of the first measurement, s.
        delay: time from a measurement until its data are published, s.
    """

    def __init__(self, sensor: Sensor, model: RealismModel) -> None:
        self.sensor = sensor
        self.phase, self.delay = model.phase, model.delay
        self.start = sensor.clock.time + model.phase
        random = sensor.context.random
        fields: dict[str, NoiseModel] = {}
        for name, noise in model.noise.items():
            noisy = [name] if name else sensor.noisy_fields()
            if not noisy:
                text = f"{sensor.name()}: noise() without a field has no effect, {sensor.noise_mend}"
                sensor.context.complaints.warn(text, text)
            fields.update(dict.fromkeys(noisy, noise))
        declarations = fields_of_component(sensor)
        self._noises = {
            name: Noise(noise, random(f"{sensor.name()}/noise/{name}"), declarations.get(name))
            for name, noise in fields.items()
            if name in sensor.local_data
        }
        values = sensor.local_data if self.delay else self._noises
        self._truth = {name: copied(sensor.local_data[name]) for name in values}
        self._last: float | None = None
        self._waiting: deque[tuple[float, Fields]] = deque()

    def changes(self) -> dict[str, dict[str, float]]:
        """Return the noise of each field like `AbstractModifier.changes`; an error of rounding is uniform."""
        models = {name: noise.model for name, noise in self._noises.items()}
        return {
            name: {"stddev": math.hypot(model.gaussian, model.quantization / math.sqrt(12.0)), "walk": model.bias_walk}
            for name, model in models.items()
        }

    def act(self) -> None:
        """Do one measurement like `Sensor.action`, with errors and delay."""
        sensor = self.sensor
        data = sensor.local_data
        measurement = copied(data) if self.delay else dict(data)
        data.update(self._truth)
        sensor.sensor_setup()
        sensor.default_action()
        if sensor._is_checked:
            check_fields(sensor)
        self._truth = {name: copied(data[name]) for name in (data if self.delay else self._noises)}
        if not self._change(measurement, sensor.clock.time):
            return
        if not self.delay:
            self._publish()
            return
        self._waiting.append((sensor.clock.time + self.delay, copied(data)))
        data.clear()
        data.update(measurement)

    def _change(self, measurement: Fields, time: float) -> bool:
        """Add noise to a measurement, complete its fields, and apply the modifiers; False if one of these has failed.

        Args:
            measurement: the previous values of the fields with noise.
            time: time of the measurement, s.
        """
        sensor = self.sensor
        dt = 0.0 if self._last is None else time - self._last
        self._last = time
        for name, noise in self._noises.items():
            noise.pass_time(dt)
            sensor.add_noise(name, noise, measurement[name])
        if sensor._reports:
            sensor.report()
        if sensor._is_checked:
            check_fields(sensor)
        return modify(sensor, sensor.output_modifiers)

    def release(self) -> None:
        """Publish the measurements whose delay has passed; called every tick."""
        now = self.sensor.clock.time + 1e-9
        while self._waiting and self._waiting[0][0] <= now:
            data = self.sensor.local_data
            data.clear()
            data.update(self._waiting.popleft()[1])
            self._publish()

    def get_state(self) -> RealismState:
        """Return the state that determines the future data, as plain data."""
        return {
            "truth": copied(self._truth),
            "last": self._last,
            "waiting": [[time, copied(data)] for time, data in self._waiting],
            "noises": {name: noise.get_state() for name, noise in self._noises.items()},
        }

    def set_state(self, state: RealismState) -> None:
        """Restore a state that `get_state` returned."""
        self._truth = copied(state["truth"])
        self._last = state["last"]
        self._waiting = deque((time, copied(data)) for time, data in state["waiting"])
        for name, noise in self._noises.items():
            noise.set_state(state["noises"][name])

    def _publish(self) -> None:
        publish(self.sensor, self.sensor.output_functions)


def copied(value: object) -> Value:
    """Return a copy that shares no mutable objects with the original."""
    if isinstance(value, (float, int, str, bytes, bool)) or value is None:
        return value
    if type(value) is list:
        return [item if type(item) is float else copied(item) for item in value]
    if type(value) is dict or type(value) is LocalData:
        return {key: copied(item) for key, item in value.items()}
    return deepcopy(value)


def phase_of(component: object) -> float:
    """Return the time of the first action of a component after the start, s."""
    realism = getattr(component, "realism", None)
    return realism.phase if isinstance(realism, Realism) else 0.0
