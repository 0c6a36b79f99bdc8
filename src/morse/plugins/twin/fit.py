"""Least squares: the values of parameters with which a simulation measures what the log has, and how sure they are."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.core.exceptions import MorseError
from morse.plugins.twin.comparison import Comparison, noise_of, persistence, shifts
from morse.plugins.twin.replay import ReplayError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from numpy.typing import NDArray

    from morse.plugins.twin.parameters import Correction, Parameter
    from morse.plugins.twin.replay import Samples, Simulations

    Floats = NDArray[np.float64]
    Traces = dict[str, Samples]

#: parts of the log that are fitted one after the other: an error of a motion grows with time
_HORIZONS = (0.08, 0.3, 1.0)
#: shortest part, s
_SHORTEST = 2.0
#: largest number of steps for each part, and how often their derivatives are computed by differences
_STEPS, _DIFFERENTIATIONS = 24, 12
#: first step of differences, relative to the scale of a parameter, and its range later on
_DIFFERENCE, _FINEST, _COARSEST = 1e-3, 3e-4, 1e-2
#: shares of what a robot is late that are taken for the lag of its commands; the rest is their delay
_LAGS = (0.2, 0.6, 0.95)
#: how many of the best beginnings are tried in each part while errors are not explained
_TRIES = (len(_LAGS) + 1, 2, 1)
#: values that differ by less than this share of their scales are the same beginning
_ALIKE = 0.02
#: difference of the times of commands, ticks: what begins in ticks changes by jumps
_TICKS = 0.25
#: first and last steps of the search for the times of commands, ticks, and how often it tries
_LONGEST_STEPS, _SHORTEST_STEP, _SEARCHES = (2.0, 1.0, 0.5), 0.1, 12
#: how often a part is fitted after such a search has found something better
_ROUNDS = 3
#: largest number of steps of what needs no simulation
_INNER = 4
#: share of the squares of errors that is worth another one
_GAINED = 1e-3
#: the largest step, for scaled parameters
_FARTHEST = 0.5
#: a fit ends if a step makes the sum of squares of errors smaller by less than this: a share of the spreads; and the
#: share of the number of errors with which the beginning of a log ends
_LITTLE, _LITTLE_OF_PART = 0.3, 1e-3
#: derivatives are updated without simulations if a step gains at least this share of what they predict
_PREDICTED = 0.5
#: derivatives are those of the solution if they are of a point that is nearer than this, in spreads
_NEAR = 3.0
#: a fit ends if steps are smaller than this share of the spreads
_SMALL = 0.05
#: of the first step, from where errors are not the noise
_DAMPING = 0.1
#: factor of errors beyond which they count less (Huber)
_OUTLIER = 4.0
#: spread, relative to the scale of a parameter, from which it is not known
UNKNOWN = 0.5
#: the same for a combination of parameters; and the spread of what has no effect at all
_VAGUE, _WITHOUT_EFFECT = 0.3, 1e3
#: spread of a combination that a part of the log determines
_SURE = 0.03
#: errors, relative to the noise, that are not noise
_UNEXPLAINED = 3.0
#: errors, relative to the noise, with which a fit need not look elsewhere
_EXPLAINED = 1.3
#: share in a direction from which a parameter is named
_NAMED = 0.2


class FitError(MorseError):
    """Nothing can be fitted."""


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


class _Equations(NamedTuple):
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


class _Derivatives(NamedTuple):
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


class Fit:
    """Fits parameters.

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
        self._finest, self._coarsest = _FINEST * self._scales, _COARSEST * self._scales
        self._differences = _DIFFERENCE * self._scales
        #: what errors are left at best
        self._noises = list(deviations or [noise_of(comparison.values(channel)) for channel in comparison.channels])
        self._deviations = list(self._noises)

    # -- one point -----------------------------------------------------------------------------

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
        self._differences = 0.1 * _COARSEST * self._scales
        wanted = range(len(self._parameters)) if only is None else only
        columns = self._jacobian(here, self._duration, [number for number in self._moving if number in wanted])
        for column in columns:
            column[:, [number for number in self._measuring if number not in wanted]] = 0.0
        return self._equations(here, columns).information

    # -- differences ---------------------------------------------------------------------------

    def _differentiated(self, here: Point, horizon: float) -> _Derivatives:
        """The derivatives by differences between simulations."""
        columns = self._jacobian(here, horizon, self._moving)
        moving = [number for number in self._moving if any(column[:, number].any() for column in columns)]
        return _Derivatives(columns, here.values, moving)

    def _updated(self, before: _Derivatives, here: Point, there: Point, horizon: float) -> _Derivatives:
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

    def _equations(self, here: Point, jacobian: list[Floats]) -> _Equations:
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
        return _Equations(matrix, side, information, best)

    # -- all steps -----------------------------------------------------------------------------

    def run(self) -> Result:
        """Fit, and judge the result.

        Raises:
            FitError: the simulation cannot be compared with the log.
        """
        values = np.array([one.value for one in self._parameters])
        guess = np.array([one.value if one.guess is None else max(one.value, one.guess) for one in self._parameters])
        (before,) = self.at([values], self._duration)
        if not any(np.isfinite(error).any() for error in before.errors):
            raise FitError("the log and the simulation have no time in common: no sample can be compared")
        here, information = before, np.zeros((len(values), len(values)))
        horizons = [share * self._duration for share in _HORIZONS if share * self._duration >= _SHORTEST]
        horizons = horizons or [self._duration]
        self._set_tick(before)
        beginnings = self._beginnings(before, guess)
        for part, (horizon, tries) in enumerate(zip(horizons, _TRIES, strict=False)):
            if not self._parameters:
                break
            ends: list[tuple[float, Point, Floats]] = []
            for values in self._by_badness(beginnings, horizon)[:tries]:
                # what a part hardly tells is left to the whole
                vague = _VAGUE if horizon == self._duration else _SURE
                here, information = self._descend(values, horizon, vague)
                for _ in range(_ROUNDS):
                    found = self._searched(here, horizon, vague, _LONGEST_STEPS[part])
                    if found is here:
                        break
                    here, information = self._descend(found.values, horizon, vague)
                ends.append((self._badness(here), here, information))
                if not self._unexplained(here):
                    break
            ends.sort(key=lambda end: end[0])
            _, here, information = ends[0]
            beginnings = self._different([end.values for _, end, _ in ends])
        self._weigh(here)
        return self._judged(before, here, information)

    def _set_tick(self, before: Point) -> None:
        periods = [one.times[1] - one.times[0] for one in before.traces.values() if len(one.times) > 1]
        self._tick = float(min(periods, default=0.0))
        #: delays and lags of commands
        self._times = [at for what in ("delay", "lag") for at, one in self._named(what) if one.correction is None]
        self._finest[self._times] = np.maximum(self._finest[self._times], _TICKS * self._tick)
        self._coarsest = np.maximum(self._coarsest, self._finest)
        self._differences = np.maximum(self._differences, self._finest)

    def _searched(self, here: Point, horizon: float, vague: float, longest: float) -> Point:
        """A better point with other times of commands, by a search without derivatives; the same for none.

        What a robot does when a command comes, such as a turn of a joint of constant speed, may begin in a tick: then
        errors change by jumps, and derivatives do not lead to the solution.
        """
        if not self._times or not self._unexplained(here):
            return here
        units = np.eye(len(here.values))
        ways = [units[at] for at in self._times]
        ways += [units[one] - units[other] for at, one in enumerate(self._times) for other in self._times[at + 1 :]]
        best, step = here, longest * self._tick
        for _ in range(_SEARCHES):
            if step < _SHORTEST_STEP * self._tick:
                break
            goals = [best.values + sign * step * way for way in ways for sign in (1.0, -1.0)]
            goals = [np.clip(goal, self._lows, self._highs) for goal in goals]
            try:
                points = [self._measured(there, horizon, vague) for there in self.at(goals, horizon)]
            except ReplayError:
                break
            there = min(points, key=lambda point: point.cost)
            if self._is_better(there, best):
                best = there
            else:
                step *= 0.5
        return best if best.cost < (1.0 - _GAINED) * here.cost else here

    def _beginnings(self, before: Point, guess: Floats) -> list[Floats]:
        """Where a fit begins: a delay has minima beside the solution, in particular together with a lag.

        What a sensor is late is known from the correlation with its simulation. Of sensors whose delay is not fitted,
        it is that of the commands.
        """
        late = shifts(self._comparison, before.traces)
        own = {one.component: number for number, one in self._named("delay") if one.correction is not None}
        delays = [number for number, one in self._named("delay") if one.correction is None]
        lags = [number for number, one in self._named("lag") if one.correction is None]
        common = [late[sensor] for sensor in late if sensor not in own] or list(late.values())
        if not common:
            return [guess]
        commanded = float(np.median(common)) if delays or lags else 0.0
        if not all(sensor in own for sensor in late):
            commanded = max(commanded, 0.0)
        elif delays or lags:
            commanded = max(min(common), 0.0)
        found = [guess]
        for share in _LAGS if delays and lags else (1.0 if lags else 0.0,):
            values = before.values.copy()
            values[lags] = np.maximum(values[lags] + share * commanded, guess[lags])
            values[delays] += (1.0 - share) * commanded
            for sensor, number in own.items():
                values[number] += late.get(sensor, 0.0) - commanded
            found.append(np.clip(values, self._lows, self._highs))
        # the estimates first
        return self._different([*found[1:], guess])

    def _by_badness(self, beginnings: Sequence[Floats], horizon: float) -> list[Floats]:
        """The most likely beginning first."""
        if len(beginnings) < 2:
            return list(beginnings)
        points = [self._measured(self._weigh(there), horizon, _SURE) for there in self.at(beginnings, horizon)]
        return [point.values for point in sorted(points, key=self._badness)]

    def _named(self, what: str) -> list[tuple[int, Parameter]]:
        return [(at, one) for at, one in enumerate(self._parameters) if one.name == f"{one.component}.{what}"]

    def _different(self, points: Sequence[Floats]) -> list[Floats]:
        found: list[Floats] = []
        for values in points:
            if not any((np.abs(values - other) < _ALIKE * self._scales).all() for other in found):
                found.append(values)
        return found

    def _badness(self, here: Point) -> float:
        """The negative logarithm of the likelihood, with the deviations of errors that are most likely."""
        total = 0.0
        for error, noise in zip(here.errors, self._noises, strict=True):
            finite = error[np.isfinite(error)]
            if len(finite):
                total += len(finite) * math.log(max(float(np.sqrt(np.mean(finite**2))), 0.5 * noise))
        return total / max(_count(here), 1)

    def _unexplained(self, here: Point, least: float = _EXPLAINED) -> list[tuple[str, float]]:
        """The channels with errors that are no noise, and how many times the noise they are."""
        found = []
        for channel, error in zip(self._comparison.channels, here.errors, strict=True):
            finite = error[np.isfinite(error)]
            ratio = float(np.sqrt(np.mean(finite**2))) / noise_of(finite) if len(finite) else 0.0
            if ratio > least:
                found.append((channel.name, ratio))
        return found

    def _descend(self, values: Floats, horizon: float, vague: float = _VAGUE) -> tuple[Point, Floats]:
        (here,) = self.at([values], horizon)
        here = self._measured(self._weigh(here), horizon, vague)
        damping = _DAMPING if self._unexplained(here) else 0.0
        is_whole = horizon == self._duration
        little = _LITTLE if is_whole else max(_LITTLE, _LITTLE_OF_PART * _count(here))
        derivatives, is_fresh, count = self._differentiated(here, horizon), True, 1
        for step in range(_STEPS):
            equations = self._equations(here, derivatives.columns)
            # without those that errors share: far from the solution, all errors do
            spreads = spreads_of(equations.matrix) * self._scales
            better, gain, is_tried = None, 0.0, False
            # with derivatives that were updated, a step that gains nothing says nothing about the solution
            for _ in range(6 if is_fresh else 1):
                goal = self._goal(here.values, equations, damping, vague)
                if not self._is_worth_it(goal - here.values, spreads):
                    break
                gain, is_tried = self._predicted(goal - here.values, equations), True
                better = self._tried(goal, here, horizon, vague)
                if better is not None:
                    damping = 0.1 * damping if damping > 1e-4 else 0.0
                    break
                damping = max(10.0 * damping, 1e-2)
            self._tell(f"{horizon:.3g} s, step {step + 1}: error {math.sqrt(here.cost / max(_count(here), 1)):.4g}")
            gained = 0.0 if better is None else here.cost - better.cost
            is_solved = not is_tried if better is None else damping == 0.0 and gained < little
            if better is not None:
                derivatives = self._updated(derivatives, here, better, horizon)
                here = self._weigh(better)
            is_near = self._is_near(here.values - derivatives.at, spreads)
            if (is_solved and (is_near or not is_whole)) or (better is None and is_fresh):
                break
            is_fresh = is_solved or gained < _PREDICTED * gain or better is None
            if is_fresh and count == _DIFFERENTIATIONS:
                break
            if is_fresh:
                # the spreads if all others were known: larger differences of parameters of the same effect seem to
                # tell them apart, by their curvature
                alone = self._scales / np.sqrt(np.maximum(np.diag(equations.matrix), _WITHOUT_EFFECT**-2))
                self._differences = np.clip(alone, self._finest, self._coarsest)
                derivatives, count = self._differentiated(here, horizon), count + 1
        return here, self._equations(here, derivatives.columns).information

    def _predicted(self, change: Floats, equations: _Equations) -> float:
        """By how much the cost falls with a step if errors are linear."""
        scaled = change / self._scales
        return float(2.0 * equations.side @ scaled - scaled @ equations.matrix @ scaled)

    def _is_near(self, change: Floats, spreads: Floats) -> bool:
        return bool((np.abs(change) <= _NEAR * np.where(np.isfinite(spreads), spreads, self._scales)).all())

    def _goal(self, values: Floats, equations: _Equations, damping: float, vague: float) -> Floats:
        """The next values: those that would leave their range stay, and the others are solved without them."""
        free = np.ones(len(values), bool)
        goal = values
        for _ in range(len(values)):
            change = np.zeros(len(values))
            inner = np.flatnonzero(free)
            block = np.ix_(inner, inner)
            change[inner] = _solved(
                equations.matrix[block], equations.side[inner], equations.best[block], damping, vague
            )
            goal = values + change * self._scales
            outside = free & ((goal < self._lows) | (goal > self._highs))
            if not outside.any() or outside.sum() == free.sum():
                break
            free &= ~outside
        return np.clip(goal, self._lows, self._highs)

    def _weigh(self, here: Point) -> Point:
        """Let each channel count by the errors that are left of it."""
        sizes = [float(np.sqrt(np.nanmean(error**2))) if np.isfinite(error).any() else 0.0 for error in here.errors]
        self._deviations = [max(size, 0.5 * noise) for size, noise in zip(sizes, self._noises, strict=True)]
        return here._replace(cost=self._cost(here.errors))

    def _is_worth_it(self, change: Floats, spreads: Floats) -> bool:
        finite = np.where(np.isfinite(spreads), spreads, self._scales)
        return bool((np.abs(change) > np.maximum(_SMALL * finite, 1e-9 * self._scales)).any())

    def _tried(self, goal: Floats, here: Point, horizon: float, vague: float) -> Point | None:
        try:
            (there,) = self.at([goal], horizon)
        except ReplayError:
            return None
        there = self._measured(there, horizon, vague)
        return there if self._is_better(there, here) else None

    def _is_better(self, there: Point, here: Point) -> bool:
        return _count(there) >= 0.98 * _count(here) and there.cost < here.cost

    def _measured(self, here: Point, horizon: float, vague: float) -> Point:
        """The point with the gains, biases and delays of sensors that suit its simulation best."""
        for _ in range(_INNER if self._measuring else 0):
            equations = self._equations(here, self._jacobian(here, horizon, ()))
            goal = self._goal(here.values, equations, 0.0, vague)
            there = self._point(goal, here.traces, horizon)
            if not self._is_better(there, here):
                break
            is_small = there.cost > (1.0 - _GAINED) * here.cost
            here = there
            if is_small:
                break
        return here

    # -- what is known -------------------------------------------------------------------------

    def _judged(self, before: Point, here: Point, information: Floats) -> Result:
        spreads = spreads_of(information) * self._scales
        result = Result(
            self._parameters,
            before.values,
            here.values,
            spreads,
            before,
            here,
            self._deviations,
            information,
            simulations=self._simulations.count,
        )
        result.relations = relations(self._parameters, information)
        for number, one in enumerate(self._parameters):
            if not one.low < here.values[number] < one.high and np.isfinite(spreads[number]):
                result.remarks.append(
                    f"{one.name} has reached the end of its range, {here.values[number]:g} {one.unit}".rstrip()
                )
        for name, ratio in self._unexplained(here, _UNEXPLAINED) if self._parameters else ():
            result.remarks.append(
                f"the errors of {name} are {ratio:.0f} times its noise: something is not in the model, or "
                "the fit has ended beside the solution, and then the spreads are too small"
            )
        return result


def _weights(errors: Floats) -> Floats:
    size = np.abs(errors)
    return np.where(size <= _OUTLIER, 1.0, _OUTLIER / np.maximum(size, 1e-300))


def _count(point: Point) -> int:
    return int(sum(np.isfinite(error).sum() for error in point.errors))


def _solved(matrix: Floats, side: Floats, best: Floats, damping: float, vague: float) -> Floats:
    """The step of Levenberg and Marquardt; along what the log does not tell, there is none."""
    values, vectors = np.linalg.eigh(best)
    kept = vectors[:, values > vague**-2]
    inner = kept.T @ matrix @ kept
    step = kept @ np.linalg.solve(inner + damping * np.diag(np.diag(inner)), kept.T @ side)
    return np.asarray(step / max(1.0, float(np.abs(step).max(initial=0.0)) / _FARTHEST))


def spreads_of(information: Floats) -> Floats:
    """The standard deviations of the scaled parameters: the Cramér-Rao bound; inf for what has no effect."""
    values, vectors = np.linalg.eigh(information)
    least = max(_WITHOUT_EFFECT**-2, 1e-13 * max(float(values[-1]), 0.0)) if len(values) else 0.0
    is_flat = values <= least
    variances = (vectors[:, ~is_flat] ** 2 / values[~is_flat]).sum(axis=1)
    # what is part of a direction without effect is not known
    variances[(vectors[:, is_flat] ** 2).sum(axis=1) > 1e-6] = math.inf
    return np.asarray(np.sqrt(variances))


def relations(parameters: Sequence[Parameter], information: Floats) -> list[str]:
    """In words: what the log does not tell about the parameters, and what it tells instead."""
    if not parameters:
        return []
    values, vectors = np.linalg.eigh(information)
    silent = {number for number in range(len(parameters)) if information[number, number] <= _WITHOUT_EFFECT**-2}
    lines = [f"{parameters[number].name} has no effect here" for number in sorted(silent)]
    for value, vector in zip(values, vectors.T, strict=True):
        if value > _VAGUE**-2:
            break
        parts = [number for number in np.argsort(-np.abs(vector)) if abs(vector[number]) > _NAMED]
        parts = [number for number in parts if number not in silent]
        if len(parts) < 2:
            lines += [f"{parameters[number].name} hardly has an effect here" for number in parts]
            continue
        lines.append(_relation(parameters, vector, parts))
    return lines


def _relation(parameters: Sequence[Parameter], vector: Floats, parts: Sequence[int]) -> str:
    names = [parameters[number].name for number in parts]
    if len(parts) == 2:
        one, other = parts
        # what stays the same along the direction
        first, second = float(vector[other]), -float(vector[one])
        if first < 0.0:
            first, second = -first, -second
        if parameters[one].is_ratio and parameters[other].is_ratio:
            power = second / first
            if abs(abs(power) - 1.0) < 0.15:
                return f"only {names[0]} {'×' if power > 0.0 else '/'} {names[1]} matters here"
            return f"only {names[0]} × {names[1]}^{power:.2g} matters here"
        first, second = first / parameters[one].scale, second / parameters[other].scale
        share = second / first
        sign = "+" if share > 0.0 else "-"
        return f"only {names[0]} {sign} {abs(share):.3g} · {names[1]} matters here"
    return f"{', '.join(names[:-1])} and {names[-1]} cannot be told apart here"
