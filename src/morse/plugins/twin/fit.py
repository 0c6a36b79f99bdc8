"""Least squares: the values of parameters with which a simulation measures what the log has, and how sure they are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core.exceptions import MorseError
from morse.plugins.twin.comparison import shifts
from morse.plugins.twin.identifiability import VAGUE, WITHOUT_EFFECT, relations, spreads_of
from morse.plugins.twin.problem import Equations, Point, Problem, Result, count_of
from morse.plugins.twin.replay import ReplayError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: parts of the log that are fitted one after the other: an error of a motion grows with time
_HORIZONS = (0.08, 0.3, 1.0)
#: shortest part, s
_SHORTEST = 2.0
#: largest number of steps for each part, and how often their derivatives are computed by differences
_STEPS, _DIFFERENTIATIONS = 24, 12
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
#: spread of a combination that a part of the log determines
_SURE = 0.03
#: errors, relative to the noise, that are not noise
_UNEXPLAINED = 3.0


class FitError(MorseError):
    """Nothing can be fitted."""


class Fit(Problem):
    """Fits parameters; see `Problem`."""

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
                vague = VAGUE if horizon == self._duration else _SURE
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

    def _different(self, points: Sequence[Floats]) -> list[Floats]:
        found: list[Floats] = []
        for values in points:
            if not any((np.abs(values - other) < _ALIKE * self._scales).all() for other in found):
                found.append(values)
        return found

    def _descend(self, values: Floats, horizon: float, vague: float = VAGUE) -> tuple[Point, Floats]:
        (here,) = self.at([values], horizon)
        here = self._measured(self._weigh(here), horizon, vague)
        damping = _DAMPING if self._unexplained(here) else 0.0
        is_whole = horizon == self._duration
        little = _LITTLE if is_whole else max(_LITTLE, _LITTLE_OF_PART * count_of(here))
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
            self._tell(f"{horizon:.3g} s, step {step + 1}: error {math.sqrt(here.cost / max(count_of(here), 1)):.4g}")
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
                alone = self._scales / np.sqrt(np.maximum(np.diag(equations.matrix), WITHOUT_EFFECT**-2))
                self._differences = np.clip(alone, self._finest, self._coarsest)
                derivatives, count = self._differentiated(here, horizon), count + 1
        return here, self._equations(here, derivatives.columns).information

    def _predicted(self, change: Floats, equations: Equations) -> float:
        """By how much the cost falls with a step if errors are linear."""
        scaled = change / self._scales
        return float(2.0 * equations.side @ scaled - scaled @ equations.matrix @ scaled)

    def _is_near(self, change: Floats, spreads: Floats) -> bool:
        return bool((np.abs(change) <= _NEAR * np.where(np.isfinite(spreads), spreads, self._scales)).all())

    def _goal(self, values: Floats, equations: Equations, damping: float, vague: float) -> Floats:
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
        return count_of(there) >= 0.98 * count_of(here) and there.cost < here.cost

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


def _solved(matrix: Floats, side: Floats, best: Floats, damping: float, vague: float) -> Floats:
    """The step of Levenberg and Marquardt; along what the log does not tell, there is none."""
    values, vectors = np.linalg.eigh(best)
    kept = vectors[:, values > vague**-2]
    inner = kept.T @ matrix @ kept
    step = kept @ np.linalg.solve(inner + damping * np.diag(np.diag(inner)), kept.T @ side)
    return np.asarray(step / max(1.0, float(np.abs(step).max(initial=0.0)) / _FARTHEST))
