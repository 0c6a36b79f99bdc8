"""Proposes a manoeuvre that tells what a log does not tell."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.plugins.twin.comparison import Comparison
from morse.plugins.twin.identifiability import UNKNOWN, spreads_of
from morse.plugins.twin.problem import Problem, Result
from morse.plugins.twin.replay import ReplayError, Samples, Simulations

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.declarations import DataField
    from morse.plugins.twin.parameters import Parameters
    from morse.plugins.twin.replay import Probe

    Floats = NDArray[np.float64]

#: length of a manoeuvre, s, the rate of its commands, Hz, and how much farther than in the log they go
_LENGTH, _RATE, _FARTHER = 12.0, 20.0, 1.5
#: the beginning of manoeuvres by which they are compared, s
_COMPARED = 6.0
#: largest number of fields that are varied
_MOST = 8
#: waves of times (N,), from -1 to 1; fields that are varied together have different factors of time, from 1 on
_WAVES: dict[str, Callable[[Floats], Floats]] = {
    "steps of 1 s": lambda t: np.sign(np.sin(math.pi * t + 1e-9)),
    "steps of 3 s": lambda t: np.sign(np.sin(math.pi * t / 3.0 + 1e-9)),
    "a sine of 0.5 Hz": lambda t: np.sin(math.pi * t),
    "a sine of 2 Hz": lambda t: np.sin(4.0 * math.pi * t),
}


class Manoeuvre(NamedTuple):
    """Commands that would tell more.

    Attributes:
        text: what they are, in words.
        spreads: of the parameters, with the log and the manoeuvre together.
    """

    text: str
    spreads: dict[str, float]


def propose(
    result: Result,
    parameters: Parameters,
    comparison: Comparison,
    commands: Mapping[str, Samples],
    sensors: Mapping[str, Sequence[str]],
    probe: Probe,
    workers: int,
    most: float,
) -> Manoeuvre | None:
    """The manoeuvre after which most of the parameters are known that are not known now; None for none.

    All manoeuvres are compared by what they would tell about the unknown parameters if the others were known. The best
    one is then judged with all parameters.

    Args:
        most: simulated time that this may take, s; one manoeuvre is always tried.
    """
    unknown = [number for number in range(len(result.parameters)) if not result.is_known(number)]
    if not unknown:
        return None
    scales = np.array([one.scale for one in result.parameters])
    found = [replace(one, value=float(value)) for one, value in zip(result.parameters, result.values, strict=True)]
    values = {one.name: one.value for one in found if one.correction is None}
    sizes = dict(zip([one.name for one in comparison.channels], result.deviations, strict=True))
    candidates = list(_candidates(commands, probe))
    # one simulation, and one for each parameter that needs some
    judged = (1 + len(values)) * _LENGTH
    compared = (1 + sum(found[number].correction is None for number in unknown)) * _COMPARED

    def spreads(which: int, length: float, only: Sequence[int] | None = None) -> Floats:
        simulations.which = which
        (traces,) = simulations.each([values], length)
        there = Comparison.of(traces, probe)
        deviations = [sizes.get(one.name, math.inf) for one in there.channels]
        problem = Problem(found, there, simulations, length, deviations=deviations)
        return np.asarray(spreads_of(result.information + problem.information_at(traces, only)) * scales)

    best: tuple[float, int] | None = None
    with Simulations(parameters, [orders for _, orders in candidates], sensors, workers) as simulations:
        for which in range(len(candidates)):
            if simulations.seconds + compared + judged > most and best is not None:
                break
            try:
                there = spreads(which, _COMPARED, unknown)
            except ReplayError:
                continue
            left = float(np.minimum(there[unknown] / scales[unknown], 10.0 * UNKNOWN).sum())
            if best is None or left < best[0]:
                best = left, which
        if best is None or best[0] >= 10.0 * UNKNOWN * len(unknown):
            return None
        try:
            there = spreads(best[1], _LENGTH)
        except ReplayError:
            return None
    if not (there[unknown] < UNKNOWN * scales[unknown]).any():
        return None
    names = [one.name for one in result.parameters]
    return Manoeuvre(candidates[best[1]][0], dict(zip(names, map(float, there), strict=True)))


def _candidates(commands: Mapping[str, Samples], probe: Probe) -> Iterator[tuple[str, dict[str, Samples]]]:
    times = np.arange(0.0, _LENGTH, 1.0 / _RATE)
    fields = [
        (name, field) for name, one in commands.items() for field, values in one.fields.items() if values.ndim == 1
    ]
    # what the log varies first, and then what it does not
    fields = sorted(fields, key=lambda one: not np.ptp(commands[one[0]].fields[one[1]]))[:_MOST]
    rest = {
        name: {field: np.full((len(times), *values.shape[1:]), _middle(values)) for field, values in one.fields.items()}
        for name, one in commands.items()
    }
    # what varies all tells most
    for chosen in [*([fields] if len(fields) > 1 else []), *([one] for one in fields)]:
        for what, wave in _WAVES.items():
            orders = {name: dict(columns) for name, columns in rest.items()}
            words = []
            for number, (name, field) in enumerate(chosen):
                low, high = _range(commands[name].fields[field], probe.fields[name].get(field))
                orders[name][field] = 0.5 * (low + high) + 0.5 * (high - low) * wave(times * (1.0 + 0.3 * number))
                words.append(f"{name}.{field} between {low:.3g} and {high:.3g}")
            yield f"{what}: {', '.join(words)}", {name: Samples(times, columns) for name, columns in orders.items()}


def _middle(values: Floats) -> Floats:
    return np.asarray(np.median(values, axis=0))


def _range(values: Floats, declared: DataField | None) -> tuple[float, float]:
    """The range of a command, a little farther than in the log, but no farther than it may be."""
    low, high = float(values.min()), float(values.max())
    middle, half = 0.5 * (low + high), 0.5 * (high - low) or 0.5
    low, high = middle - _FARTHER * half, middle + _FARTHER * half
    if declared is not None and declared.low is not None:
        low = max(low, declared.low)
    if declared is not None and declared.high is not None:
        high = min(high, declared.high)
    return low, high
