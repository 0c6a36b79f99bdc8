"""Delay and noise of real sensors."""

from __future__ import annotations

import math
from collections import deque
from copy import deepcopy
from typing import TYPE_CHECKING

from morse.core.declarations import fields_of_component
from morse.core.guard import modify, publish
from morse.core.noise import Noise
from morse.core.streams.extent import check_fields
from morse.core.streams.local_data import LocalData

if TYPE_CHECKING:
    from morse.core.interfaces import Component
    from morse.core.sensor import Sensor
    from morse.core.values import Fields, StateData, Value
    from morse.scene.realism import NoiseModel, RealismModel


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

    def get_state(self) -> StateData:
        """Return the state that determines the future data, as plain data."""
        return {
            "truth": copied(self._truth),
            "last": self._last,
            "waiting": [[time, copied(data)] for time, data in self._waiting],
            "noises": {name: noise.get_state() for name, noise in self._noises.items()},
        }

    def set_state(self, state: StateData) -> None:
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


def phase_of(component: Component) -> float:
    """Return the time of the first action of a component after the start, s."""
    realism = getattr(component, "realism", None)
    return realism.phase if isinstance(realism, Realism) else 0.0
