"""What sensors have measured in a log and in a simulation, sample by sample; clocks; errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.plugins.twin.parameters import Correction
    from morse.plugins.twin.replay import Probe, Samples

    Floats = NDArray[np.float64]

#: names of items of vectors
_AXES = ("x", "y", "z", "w")
#: standard deviation divided by the median of absolute values, of a normal distribution
_NORMAL = 1.4826
#: smallest noise, relative to the spread of the values, below which rounding matters
_LEAST = 1e-4
#: rate at which clocks are compared, Hz, and largest offset that is searched, s
_RATE, _FARTHEST = 50.0, 5.0
#: longest delay of a sensor or a command that is no offset of a clock if it is fitted, s
LONGEST_DELAY = 1.0
#: coefficient of correlation, and its gain, from which an offset is believed
_SURE, _BETTER = 0.5, 0.02


class Channel(NamedTuple):
    """One number that a sensor measures.

    Attributes:
        sensor, field: names.
        item: index in the field; -1 for a number.
        is_angle: whether it wraps around.
        unit: of the number.
    """

    sensor: str
    field: str
    item: int
    is_angle: bool
    unit: str

    @property
    def name(self) -> str:
        """``robot.imu.angular_velocity.z``."""
        end = "" if self.item < 0 else f".{_AXES[self.item] if self.item < len(_AXES) else self.item}"
        return f"{self.sensor}.{self.field}{end}"


@dataclass
class Clock:
    """How the time stamps of a sensor differ from those of the commands.

    Attributes:
        delay: how much later measurements are in the log than in the simulation, s.
        drift: change of the delay, s/s.
        correlation: of the signals after the shift, 0 to 1; 0 if the sensor shows too little motion.
        is_applied: whether times were corrected by delay and drift.
    """

    delay: float = 0.0
    drift: float = 0.0
    correlation: float = 0.0
    is_applied: bool = False


@dataclass
class Comparison:
    """The measurements of a log, to be compared with those of simulations.

    Attributes:
        measured: by sensor.
        channels: all numbers that are compared.
        clocks: by sensor.
    """

    measured: dict[str, Samples]
    channels: list[Channel]
    clocks: dict[str, Clock] = field(default_factory=dict)

    @classmethod
    def of(cls, measured: Mapping[str, Samples], probe: Probe) -> Comparison:
        """Compare these measurements."""
        channels = []
        for sensor, samples in measured.items():
            for name, values in samples.fields.items():
                declared = probe.fields[sensor].get(name)
                is_angle = declared is not None and declared.angle
                unit = declared.unit if declared is not None else ""
                # items that were not measured are NaN
                items = [-1] if values.ndim == 1 else np.flatnonzero(~np.isnan(values).all(axis=0)).tolist()
                channels += [Channel(sensor, name, item, is_angle, unit) for item in items]
        return cls(dict(measured), channels, {sensor: Clock() for sensor in measured})

    def times(self, sensor: str) -> Floats:
        """The times of the measurements of a sensor by the clock of the commands, s."""
        times, clock = self.measured[sensor].times, self.clocks[sensor]
        return times - clock.delay - clock.drift * times if clock.is_applied else times

    def values(self, channel: Channel) -> Floats:
        """What was measured, (N,)."""
        return _item(self.measured[channel.sensor].fields[channel.field], channel.item)

    def errors(
        self, traces: Mapping[str, Samples], corrections: Mapping[str, Sequence[tuple[Correction, float]]]
    ) -> list[Floats]:
        """Measured minus simulated, (N,) for each channel; NaN where the simulation has no value."""
        return [self.values_minus(channel, traces, corrections.get(channel.sensor, ())) for channel in self.channels]

    def values_minus(
        self, channel: Channel, traces: Mapping[str, Samples], corrections: Sequence[tuple[Correction, float]]
    ) -> Floats:
        """The errors of a channel."""
        difference = self.values(channel) - self.simulated(channel, traces, corrections)
        return _wrapped(difference) if channel.is_angle else difference

    def simulated(
        self, channel: Channel, traces: Mapping[str, Samples], corrections: Sequence[tuple[Correction, float]]
    ) -> Floats:
        """What the simulated sensor measures at the times of the log, (N,)."""
        times = self.times(channel.sensor)
        gain, bias, delay = 1.0, 0.0, 0.0
        for correction, value in corrections:
            if correction.what == "delay":
                delay = value
            elif (correction.field, correction.item) == (channel.field, channel.item):
                gain, bias = (value, bias) if correction.what == "gain" else (gain, value)
        times = times - delay
        trace = traces.get(channel.sensor)
        if trace is None or len(trace.times) < 2:
            return np.full(len(times), math.nan)
        values = _item(trace.fields[channel.field], channel.item)
        if channel.is_angle:
            values = np.unwrap(values)
        period = trace.times[1] - trace.times[0]
        # before its first measurement, a sensor at rest measures the same
        result = np.interp(times, trace.times, values, left=math.nan, right=math.nan)
        early = (times < trace.times[0]) & (times > trace.times[0] - 2.0 * period - max(delay, 0.0))
        result[early] = values[0]
        return gain * result + bias


def _item(values: Floats, item: int) -> Floats:
    return values if item < 0 else values[:, item]


def _wrapped(angle: Floats) -> Floats:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def noise_of(values: Floats) -> float:
    """The standard deviation of the white noise of a signal, from its second differences; robust.

    A smooth signal has small second differences; those of white noise have the variance 6 times its own.
    """
    if len(values) < 8:
        return float(np.std(values)) or 1.0
    second = np.diff(values, 2)
    noise = _NORMAL * float(np.median(np.abs(second))) / math.sqrt(6.0)
    return max(noise, _LEAST * float(np.std(values)), 1e-9)


def persistence(errors: Floats) -> float:
    """Number of successive samples that share an error: 1 for white noise, more for what the model does not explain.

    It is 1 plus twice the sum of the autocorrelations up to the first one that is not positive (Geyer 1992).
    """
    finite = errors[np.isfinite(errors)]
    count = len(finite)
    if count < 8:
        return 1.0
    finite = finite - finite.mean()
    size = 1 << (2 * count - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(finite, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[:count]
    if correlation[0] <= 0.0:
        return 1.0
    correlation = correlation / correlation[0]
    # pairs of lags: their sums are positive for a reversible chain, and noise ends them
    pairs = correlation[1 : count - 1 : 2] + correlation[2:count:2][: len(correlation[1 : count - 1 : 2])]
    above = pairs > 3.0 / math.sqrt(count)
    last = int(np.argmin(above)) if not above.all() else len(pairs)
    return float(min(max(1.0 + 2.0 * pairs[:last].sum(), 1.0), count / 4.0))


# -- clocks ----------------------------------------------------------------------------------


def align(
    comparison: Comparison,
    traces: Mapping[str, Samples],
    least: float = 0.25,
    fitted: Collection[str] = (),
) -> None:
    """Estimate the delay and drift of the clock of each sensor by correlation with the simulation.

    Args:
        least: delays from which times are corrected, s; less may be the dynamics of the robot, which a fit finds.
        fitted: sensors whose delay a fit finds, up to `LONGEST_DELAY`.
    """
    for sensor, clock in comparison.clocks.items():
        whole = _best_shift(comparison, traces, sensor, 0.0, 1.0)
        if whole is None:
            continue
        clock.delay, clock.correlation = whole
        parts = [_best_shift(comparison, traces, sensor, third / 3.0, (third + 1) / 3.0) for third in range(3)]
        times = comparison.measured[sensor].times
        span = float(times[-1] - times[0]) * 2.0 / 3.0
        known = [part[0] for part in parts if part is not None and part[1] > _SURE]
        if len(known) == 3 and span > 0.0:
            change = known[2] - known[0]
            sample = max(1.0 / _RATE, float(times[-1] - times[0]) / (len(times) - 1))
            # less than a sample is not seen; what does not grow evenly is no drift but the motion
            is_even = abs(known[1] - 0.5 * (known[0] + known[2])) < 0.25 * abs(change)
            clock.drift = change / span if abs(change) > 2.0 * sample and is_even else 0.0
        is_fitted = sensor in fitted and 0.0 <= clock.delay < LONGEST_DELAY
        if clock.drift or (abs(clock.delay) >= least and not is_fitted):
            middle = 0.5 * float(times[-1] + times[0])
            # a fitted delay is not that of the clock
            clock.delay = (0.0 if is_fitted else clock.delay) - clock.drift * middle
            clock.is_applied = True


def shifts(comparison: Comparison, traces: Mapping[str, Samples]) -> dict[str, float]:
    """How much later than in the simulation each sensor measures, s; without those whose clock was corrected."""
    found = {}
    for sensor, clock in comparison.clocks.items():
        best = None if clock.is_applied else _best_shift(comparison, traces, sensor, 0.0, 1.0, better=0.0)
        if best is not None:
            found[sensor] = best[0]
    return found


def _best_shift(
    comparison: Comparison,
    traces: Mapping[str, Samples],
    sensor: str,
    begin: float,
    end: float,
    better: float = _BETTER,
) -> tuple[float, float] | None:
    """The shift with the highest correlation, s, and this correlation; None if nothing moves, or none is clear."""
    trace = traces.get(sensor)
    times = comparison.measured[sensor].times
    if trace is None or len(trace.times) < 16 or len(times) < 16:
        return None
    rate = min(_RATE, (len(times) - 1) / max(float(times[-1] - times[0]), 1e-9))
    first = float(times[0]) + begin * float(times[-1] - times[0])
    last = float(times[0]) + end * float(times[-1] - times[0])
    grid = np.arange(first, last, 1.0 / rate)
    if not 16 <= len(grid) <= 1_000_000:
        return None
    most = int(min(_FARTHEST * rate, len(grid) / 3))
    total = np.zeros(2 * most + 1)
    weights = 0.0
    for channel in comparison.channels:
        if channel.sensor != sensor:
            continue
        seen = comparison.values(channel)
        made = _item(trace.fields[channel.field], channel.item)
        if channel.is_angle:
            seen, made = np.unwrap(seen), np.unwrap(made)
        if float(np.std(made)) < noise_of(seen):
            continue
        one, other = (_moving(np.interp(grid, at, values), rate) for at, values in ((times, seen), (trace.times, made)))
        if one is None or other is None:
            continue
        size = 1 << (2 * len(grid)).bit_length()
        product = np.fft.irfft(np.fft.rfft(one, size) * np.conj(np.fft.rfft(other, size)), size)
        total += np.concatenate((product[-most:], product[: most + 1])) / len(grid) if most else product[:1] / len(grid)
        weights += 1.0
    if not weights:
        return None
    total /= weights
    best = int(np.argmax(total))
    if total[best] < _SURE or total[best] < total[most] + better:
        return (0.0, float(total[most])) if total[most] > 0.0 else None
    shift = best - most + _peak(total, best)
    return shift / rate, float(min(total[best], 1.0))


def _moving(values: Floats, rate: float) -> Floats | None:
    """The changes of a signal, smoothed over 0.1 s and normalised; None if it hardly changes."""
    width = max(1, round(0.1 * rate))
    smooth = np.convolve(values, np.ones(width) / width, "same")
    changes = np.gradient(smooth)
    changes[: width + 1] = changes[len(changes) - width - 1 :] = 0.0
    changes = changes - changes.mean()
    size = float(np.std(changes))
    return changes / size if size > 1e-9 * (1.0 + float(np.max(np.abs(values)))) else None


def _peak(values: Floats, index: int) -> float:
    """Where the parabola through a maximum and its neighbours is highest, relative to it."""
    if not 0 < index < len(values) - 1:
        return 0.0
    before, here, after = values[index - 1 : index + 2]
    bend = before - 2.0 * here + after
    return float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5)) if bend < 0.0 else 0.0
