"""What a fit has found out about a component: gains, offsets, lags and delays."""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from morse.core.declarations import Option
from morse.core.exceptions import MorseError
from morse.core.modifier import AbstractModifier
from morse.core.reports.quoting import nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.object import Object
    from morse.core.values import Options, Value

#: longest lag and delay of a command, s
_LONGEST = 10.0
#: largest number of commands that wait
_MOST_WAITING = 10_000
#: s; and the smallest share of a tick: rounding of times is less
_LONG_AGO, _LEAST = -1e9, 1e-9


class CalibrationError(MorseError):
    """The component has no such field, or the robot no such wheels."""


class Calibration(AbstractModifier):
    """Changes fields of a sensor or an actuator as the real one does: ``gain * value + bias``.

    Options: ``gain`` and ``bias``, dictionaries from fields to numbers, or to lists of numbers for lists. Of actuators,
    in addition: ``delay``, s; ``lag``, the time constant of a first-order low-pass filter, s; ``wheel_radius`` and
    ``track``, m, those of the real robot, whose software computes the speeds of its wheels with those of the model. The
    command of a tick is the mean of the delayed commands over the tick, so that a delay need not be a number of ticks.
    """

    _names = ("Calibration",)
    _components = ("Sensor", "Actuator")

    options: ClassVar[Mapping[str, Option]] = MappingProxyType(
        {
            "gain": Option(dict, {}, "Field to its factor"),
            "bias": Option(dict, {}, "Field to what is added"),
            "delay": Option(float, 0.0, "Delay of a command", unit="s", low=0.0, high=_LONGEST),
            "lag": Option(float, 0.0, "Time constant of a command", unit="s", low=0.0, high=_LONGEST),
            "wheel_radius": Option(float, 0.0, "Of the real robot; 0 for that of the model", unit="m", low=0.0),
            "track": Option(float, 0.0, "Of the real robot; 0 for that of the model", unit="m", low=0.0),
        }
    )
    not_state: ClassVar[tuple[str, ...]] = (*AbstractModifier.not_state, "each_tick", "_gains", "_biases")

    def __init__(self, component_instance: Object, kwargs: Options) -> None:
        super().__init__(component_instance, kwargs)
        self._gains = {name: self._numbers("gain", name, value) for name, value in self._table("gain").items()}
        self._biases = {name: self._numbers("bias", name, value) for name, value in self._table("bias").items()}
        self._delay, self._lag = float(self.parameter("delay", default=0.0)), float(self.parameter("lag", default=0.0))
        self._add_wheels(
            float(self.parameter("wheel_radius", default=0.0)), float(self.parameter("track", default=0.0))
        )
        self.each_tick = bool(self._delay or self._lag)  # type: ignore[misc]
        if self.each_tick and not hasattr(component_instance, "take_input"):
            name = component_instance.name()
            raise CalibrationError(f"{name} is no actuator: for a sensor write delay(seconds), without a lag")
        fields = self.data if self.each_tick else {}
        self.commanded = {name: value for name, value in fields.items() if _is_numeric(value)}
        #: times, s, and the commands from these times on; the first one is that before all others
        self._times = [_LONG_AGO]
        self._waiting = [self._values()]
        self._output = self._values()

    def _values(self) -> dict[str, list[float]]:
        return {name: np.atleast_1d(np.asarray(self.data[name], float)).tolist() for name in self.commanded}

    def _table(self, option: str) -> dict[str, object]:
        table = self.parameter(option, default={})
        for name in table:
            if name not in self.data:
                raise CalibrationError(
                    f"{self.component_instance.name()} has no field '{name}' for its {option}"
                    f"{nearest(str(name), list(self.data))}"
                )
        return dict(table)

    def _numbers(self, option: str, name: str, value: object) -> np.ndarray | float:
        shape = np.shape(self.data[name]) if _is_numeric(self.data[name]) else None
        try:
            numbers = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            numbers = np.array(math.nan)
        if shape is None or numbers.shape not in ((), shape) or not np.isfinite(numbers).all():
            raise CalibrationError(
                f"the {option} of '{name}' of {self.component_instance.name()} is {value!r:.80}, expected a number"
                + (f" or {shape[0]} numbers" if shape else "")
                + ("; the field is no number" if shape is None else "")
            )
        return numbers if numbers.shape else float(numbers)

    def _add_wheels(self, radius: float, track: float) -> None:
        if not radius and not track:
            return
        robot = self.component_instance.robot_parent
        own_radius, own_track = getattr(robot, "wheel_radius", 0.0), getattr(robot, "track", 0.0)
        if not own_radius or not own_track or not {"v", "w"} <= set(self.data):
            raise CalibrationError(
                f"{self.component_instance.name()} does not drive a robot with two rows of wheels by v and w: it has "
                "neither a wheel_radius nor a track"
            )
        forward = radius / own_radius if radius else 1.0
        turning = forward * (own_track / track if track else 1.0)
        for name, factor in (("v", forward), ("w", turning)):
            self._gains[name] = self._gains.get(name, 1.0) * factor

    def modify(self) -> None:
        """Change the fields."""
        if self.each_tick:
            self._let_time_pass()
        for name in {**self._gains, **self._biases}:
            value = self.data[name]
            if not _is_numeric(value):
                continue
            self._put(name, self._gains.get(name, 1.0) * np.asarray(value, float) + self._biases.get(name, 0.0))

    def _put(self, name: str, numbers: np.ndarray) -> None:
        value: Value = self.data[name]
        if isinstance(value, np.ndarray):
            self.data[name] = numbers.astype(value.dtype)
        elif isinstance(value, (list, tuple)):
            self.data[name] = type(value)(numbers.tolist())
        elif isinstance(value, (int, float)):
            self.data[name] = float(numbers)
        else:  # a vector
            copy = value.copy()
            copy[:] = numbers.tolist()
            self.data[name] = copy

    # -- time --------------------------------------------------------------------------------

    def _let_time_pass(self) -> None:
        """Replace the commanded values by those that have an effect now."""
        component = self.component_instance
        clock = component.context.clock
        now, period = clock.time, 1.0 / component.frequency
        values = self._values()
        if values != self._waiting[-1]:
            self._times.append(now)
            self._waiting.append(values)
        begin = now - self._delay
        # commands that are over
        while len(self._times) > 1 and self._times[1] <= begin:
            del self._times[0], self._waiting[0]
        del self._times[:-_MOST_WAITING], self._waiting[:-_MOST_WAITING]
        share = 1.0 if not self._lag else -math.expm1(-period / self._lag)
        shares = self._shares(begin, period)
        for name in self.commanded:
            goals = sum(part * np.asarray(self._waiting[number][name]) for number, part in shares.items())
            before = np.asarray(self._output[name])
            after = before + share * (goals - before)
            self._output[name] = after.tolist()
            self._put(name, after.reshape(np.shape(self.data[name])))

    def _shares(self, begin: float, period: float) -> dict[int, float]:
        """The commands that have an effect in the tick after ``begin``, and the share of each in the time."""
        shares = {}
        starts = [-math.inf, *self._times[1:]]
        for number, (start, end) in enumerate(zip(starts, [*self._times[1:], math.inf], strict=True)):
            share = (min(end, begin + period) - max(start, begin)) / period
            if share > _LEAST:
                shares[number] = min(share, 1.0)
        total = sum(shares.values())
        return {number: share / total for number, share in shares.items()}


def _is_numeric(value: Value) -> bool:
    """Whether a value is a number or a vector of numbers, but neither a truth value nor a picture."""
    if isinstance(value, (bool, str, bytes, dict)) or value is None:
        return False
    if isinstance(value, np.ndarray):
        return value.ndim == 1 and value.dtype.kind == "f"
    if isinstance(value, (int, float)):
        return True
    try:
        return bool(len(value)) and all(type(part) in (int, float) for part in value)
    except TypeError:
        return False
