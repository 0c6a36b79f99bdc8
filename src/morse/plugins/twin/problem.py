"""The problem of a fit: errors of simulations with values of parameters, their derivatives, and equations of steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.twin.comparison import Comparison, noise_of, persistence
from morse.plugins.twin.identifiability import UNKNOWN

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from numpy.typing import NDArray

    from morse.plugins.twin.parameters import Correction, Parameter
    from morse.plugins.twin.replay import Samples, Simulations

    Floats = NDArray[np.float64]
    Traces = dict[str, Samples]

#: first step of differences, relative to the scale of a parameter, and its range later on
_DIFFERENCE, FINEST, COARSEST = 1e-3, 3e-4, 1e-2
#: factor of errors beyond which they count less (Huber)
_OUTLIER = 4.0
#: errors, relative to the noise, with which a fit need not look elsewhere
EXPLAINED = 1.3


class Point(NamedTuple):
    """Values of parameters, and what follows from them.

    Attributes:
        values: (P,).
        traces: of the simulation.
        errors: of each channel.
        cost: sum of the squares of weighted errors.
    """

    values: Floats
    traces: Traces
    errors: list[Floats]
    cost: float


class Equations(NamedTuple):
    """The normal equations of a step.

    Attributes:
        matrix, side: (P, P), (P,) of the scaled parameters.
        information: without repeated errors.
        best: what the log tells where its errors are small.
    """

    matrix: Floats
    side: Floats
    information: Floats
    best: Floats


class Derivatives(NamedTuple):
    """How errors change with parameters.

    Attributes:
        columns: of the errors of each channel, (N, P) each, per scale of the parameters.
        at: (P,) the values with which they were computed by differences.
        moving: the parameters that had an effect there and need a simulation.
    """

    columns: list[Floats]
    at: Floats
    moving: list[int]


@dataclass
class Result:
    """What a fit has found.

    Attributes:
        parameters: those that were fitted.
        start, values, spreads: (P,) before, after, and the standard deviation of each; inf for what is not known.
        before, after: the points at the start and at the end.
        deviations: of the errors of each channel at the end.
        information: (P, P) of the scaled parameters: the inverse of their covariance.
        remarks: what the user should know.
        relations: in words, which combinations of parameters matter.
        simulations: number of simulations.
    """

    parameters: list[Parameter]
    start: Floats
    values: Floats
    spreads: Floats
    before: Point
    after: Point
    deviations: list[float]
    information: Floats
    remarks: list[str] = field(default_factory=list)
    relations: list[str] = field(default_factory=list)
    simulations: int = 0

    def is_known(self, number: int) -> bool:
        """Whether the log tells the value of a parameter."""
        return bool(self.spreads[number] < UNKNOWN * self.parameters[number].scale)


class Problem:
    """Errors of simulations with values of parameters, and how they change with them.

    Args:
        parameters: to be fitted.
        comparison: the measurements.
        simulations: simulate with values.
        duration: of the log, s.
        tell: called with a line about the progress.
        fixed: other parameters, whose corrections are applied.
        deviations: of the noise of each channel; None for what the measurements show.
    """

    def __init__(
        self,
        parameters: Sequence[Parameter],
        comparison: Comparison,
        simulations: Simulations,
        duration: float,
        tell: Callable[[str], object] = lambda line: None,
        fixed: Sequence[Parameter] = (),
        deviations: Sequence[float] | None = None,
    ) -> None:
        self._parameters, self._comparison = list(parameters), comparison
        self._simulations, self._duration, self._tell = simulations, duration, tell
        names = {one.name for one in parameters}
        self._fixed = [one for one in fixed if one.name not in names]
        self._moving = [number for number, one in enumerate(parameters) if one.correction is None]
        self._measuring = [number for number, one in enumerate(parameters) if one.correction is not None]
        self._scales = np.array([one.scale for one in parameters])
        self._lows = np.array([one.low for one in parameters])
        self._highs = np.array([one.high for one in parameters])
        self._finest, self._coarsest = FINEST * self._scales, COARSEST * self._scales
        self._differences = _DIFFERENCE * self._scales
        #: what errors are left at best
        self._noises = list(deviations or [noise_of(comparison.values(channel)) for channel in comparison.channels])
        self._deviations = list(self._noises)

    def _scene_values(self, values: Floats) -> dict[str, float]:
        return {self._parameters[number].name: float(values[number]) for number in self._moving}

    def _corrections(self, values: Floats) -> dict[str, list[tuple[Correction, float]]]:
        found: dict[str, list[tuple[Correction, float]]] = {}
        numbers = [*values, *(one.value for one in self._fixed)]
        for one, value in zip([*self._parameters, *self._fixed], numbers, strict=True):
            if one.correction is not None:
                found.setdefault(one.component, []).append((one.correction, float(value)))
        return found

    def _point(self, values: Floats, traces: Traces, horizon: float) -> Point:
        errors = self._comparison.errors(traces, self._corrections(values))
        errors = [self._within(number, error, horizon) for number, error in enumerate(errors)]
        return Point(values, traces, errors, self._cost(errors))

    def _cost(self, errors: list[Floats]) -> float:
        cost = 0.0
        for error, size in zip(errors, self._deviations, strict=True):
            finite = error[np.isfinite(error)] / size
            weights = _weights(finite)
            cost += float(np.sum(weights * (2.0 - weights) * finite**2))
        return cost

    def _within(self, number: int, error: Floats, horizon: float) -> Floats:
        times = self._comparison.times(self._comparison.channels[number].sensor)
        return np.where(times <= horizon, error, math.nan)

    def at(self, points: Sequence[Floats], horizon: float) -> list[Point]:
        """Simulate points."""
        traces = self._simulations.each([self._scene_values(values) for values in points], horizon)
        return [self._point(values, trace, horizon) for values, trace in zip(points, traces, strict=True)]

    def information_at(self, traces: Traces, only: Collection[int] | None = None) -> Floats:
        """What measurements like these tell about the scaled parameters, at the values that they have.

        Args:
            only: parameters; what is told about others is left out. None for all.
        """
        here = self._point(np.array([one.value for one in self._parameters]), traces, self._duration)
        self._differences = 0.1 * COARSEST * self._scales
        wanted = range(len(self._parameters)) if only is None else only
        columns = self._jacobian(here, self._duration, [number for number in self._moving if number in wanted])
        for column in columns:
            column[:, [number for number in self._measuring if number not in wanted]] = 0.0
        return self._equations(here, columns).information

    def _differentiated(self, here: Point, horizon: float) -> Derivatives:
        """The derivatives by differences between simulations."""
        columns = self._jacobian(here, horizon, self._moving)
        moving = [number for number in self._moving if any(column[:, number].any() for column in columns)]
        return Derivatives(columns, here.values, moving)

    def _updated(self, before: Derivatives, here: Point, there: Point, horizon: float) -> Derivatives:
        """The derivatives after a step without simulations: the smallest change that explains it (Broyden 1965)."""
        change = (there.values - here.values) / self._scales
        own = np.zeros(len(change))
        own[before.moving] = change[before.moving]
        length = float(own @ own)
        columns = self._jacobian(there, horizon, ())
        for channel, column in enumerate(columns):
            old = before.columns[channel]
            missing = self._change(channel, here, there) - old @ change
            missing[~np.isfinite(missing)] = 0.0
            column[:, self._moving] = old[:, self._moving]
            if length > 0.0:
                column += np.outer(missing, own / length)
        return before._replace(columns=columns)

    def _change(self, channel: int, here: Point, there: Point) -> Floats:
        """How the errors of a channel differ between points."""
        change = there.errors[channel] - here.errors[channel]
        if self._comparison.channels[channel].is_angle:
            change = (change + math.pi) % (2.0 * math.pi) - math.pi
        return change

    def _jacobian(self, here: Point, horizon: float, moving: Sequence[int]) -> list[Floats]:
        """The derivatives of the errors of each channel, (N, P) each, per scale of the parameters.

        Args:
            moving: the parameters that are varied of those that need a simulation; the derivatives of others are 0.
        """
        steps = np.where(here.values + self._differences <= self._highs, self._differences, -self._differences)
        points = []
        for number in moving:
            values = here.values.copy()
            values[number] += steps[number]
            points.append(values)
        moved: dict[int, Point] = dict(zip(moving, self.at(points, horizon), strict=True)) if points else {}
        for number in self._measuring:
            values = here.values.copy()
            values[number] += steps[number]
            moved[number] = self._point(values, here.traces, horizon)
        columns = []
        for channel in range(len(self._comparison.channels)):
            column = np.zeros((len(here.errors[channel]), len(self._parameters)))
            for number, point in moved.items():
                column[:, number] = self._change(channel, here, point) / steps[number] * self._scales[number]
            columns.append(column)
        return columns

    def _equations(self, here: Point, jacobian: list[Floats]) -> Equations:
        count = len(self._parameters)
        matrix, side = np.zeros((count, count)), np.zeros(count)
        information, best = np.zeros((count, count)), np.zeros((count, count))
        for error, column, size, noise in zip(here.errors, jacobian, self._deviations, self._noises, strict=True):
            is_finite = np.isfinite(error) & np.isfinite(column).all(axis=1)
            if not is_finite.any() or not math.isfinite(size):
                continue
            scaled, rows = error[is_finite] / size, column[is_finite] / size
            weights = _weights(scaled)
            part = rows.T @ (weights[:, None] * rows)
            matrix += part
            side -= rows.T @ (weights * scaled)
            information += part / persistence(scaled)
            # at the solution, errors are the noise: in between, as far as it is trusted from here
            best += part * size / max(min(noise, size), 0.01 * size)
        return Equations(matrix, side, information, best)

    def _weigh(self, here: Point) -> Point:
        """Let each channel count by the errors that are left of it."""
        sizes = [float(np.sqrt(np.nanmean(error**2))) if np.isfinite(error).any() else 0.0 for error in here.errors]
        self._deviations = [max(size, 0.5 * noise) for size, noise in zip(sizes, self._noises, strict=True)]
        return here._replace(cost=self._cost(here.errors))

    def _badness(self, here: Point) -> float:
        """The negative logarithm of the likelihood, with the deviations of errors that are most likely."""
        total = 0.0
        for error, noise in zip(here.errors, self._noises, strict=True):
            finite = error[np.isfinite(error)]
            if len(finite):
                total += len(finite) * math.log(max(float(np.sqrt(np.mean(finite**2))), 0.5 * noise))
        return total / max(count_of(here), 1)

    def _unexplained(self, here: Point, least: float = EXPLAINED) -> list[tuple[str, float]]:
        """The channels with errors that are no noise, and how many times the noise they are."""
        found = []
        for channel, error in zip(self._comparison.channels, here.errors, strict=True):
            finite = error[np.isfinite(error)]
            ratio = float(np.sqrt(np.mean(finite**2))) / noise_of(finite) if len(finite) else 0.0
            if ratio > least:
                found.append((channel.name, ratio))
        return found

    def _named(self, what: str) -> list[tuple[int, Parameter]]:
        return [(at, one) for at, one in enumerate(self._parameters) if one.name == f"{one.component}.{what}"]


def _weights(errors: Floats) -> Floats:
    size = np.abs(errors)
    return np.where(size <= _OUTLIER, 1.0, _OUTLIER / np.maximum(size, 1e-300))


def count_of(point: Point) -> int:
    """The number of errors that can be compared."""
    return int(sum(np.isfinite(error).sum() for error in point.errors))
