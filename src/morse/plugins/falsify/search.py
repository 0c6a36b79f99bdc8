"""What chooses the next point: at random, evenly, or guided by how nearly earlier runs have failed."""

from __future__ import annotations

import importlib
import logging
import warnings
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from morse.plugins.falsify.expressions import FAR
from morse.plugins.falsify.space import halton
from morse.system.extras import install

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.plugins.falsify.space import Space

#: share of points that lie anywhere, so that no part of the space is forgotten
_ANYWHERE = 0.15
#: points that are spread evenly before the guided ones, for each free parameter and at least
_EVEN, _LEAST_EVEN = 6, 16


class Archive:
    """All points that have been tried.

    Attributes:
        points: one row for each run, in the unit cube.
        robustness: one row for each run, one column for each requirement; lower is nearer to a failure.
    """

    def __init__(self, dimensions: int, requirements: int) -> None:
        self._points = np.empty((256, dimensions))
        self._robustness = np.empty((256, requirements))
        self.count = 0

    def add(self, point: NDArray[np.float64], robustness: list[float]) -> None:
        """Add a run."""
        if self.count == len(self._points):
            self._points = np.concatenate([self._points, np.empty_like(self._points)])
            self._robustness = np.concatenate([self._robustness, np.empty_like(self._robustness)])
        self._points[self.count], self._robustness[self.count] = point, robustness
        self.count += 1

    @property
    def points(self) -> NDArray[np.float64]:
        """The points."""
        return self._points[: self.count]

    @property
    def robustness(self) -> NDArray[np.float64]:
        """Their robustness."""
        return self._robustness[: self.count]

    def order(self, target: int) -> NDArray[np.int64]:
        """The numbers of the runs, the nearest to a violation of a requirement first; those that say nothing last."""
        robustness = self.robustness[:, target]
        return np.argsort(np.where(is_known(robustness), robustness, np.inf), kind="stable")


def is_known(robustness: NDArray[np.float64] | float) -> Any:
    """Whether runs say how far a requirement is from being violated: those that end by an error do not."""
    return np.isfinite(robustness) & (np.asarray(robustness) > -FAR)


class Search(Protocol):
    """A way to choose points."""

    def propose(self, target: int) -> NDArray[np.float64]:
        """Return the next point, for the requirement of that number."""

    def tell(self, point: NDArray[np.float64], robustness: list[float]) -> None:
        """Called when a point has been tried."""


class AtRandom:
    """Points at random."""

    def __init__(self, space: Space, _archive: Archive, rng: np.random.Generator) -> None:
        self._dimensions, self._rng = len(space.free), rng

    def propose(self, target: int) -> NDArray[np.float64]:
        """Return a point."""
        return self._rng.random(self._dimensions)

    def tell(self, point: NDArray[np.float64], robustness: list[float]) -> None:
        """Nothing is learnt."""


class Evenly(AtRandom):
    """Points of Halton's sequence, which leave no great gaps."""

    def __init__(self, space: Space, archive: Archive, rng: np.random.Generator) -> None:
        super().__init__(space, archive, rng)
        self._number = archive.count

    def propose(self, target: int) -> NDArray[np.float64]:
        """Return a point."""
        self._number += 1
        return halton(self._number, self._dimensions)


class Guided(Evenly):
    """Points near those that have nearly failed: an evolution of the whole archive.

    A new point is a parent from the best ones, moved at random by a length of any scale, or along the difference of two
    other good points, which follows valleys (Storn and Price, 1997). Only the order of robustness counts.
    """

    def __init__(self, space: Space, archive: Archive, rng: np.random.Generator) -> None:
        super().__init__(space, archive, rng)
        self._archive = archive
        self._even = max(_LEAST_EVEN, _EVEN * self._dimensions)
        self._is_ordered = np.array([axis.is_ordered for axis in space.free])
        self._step = np.array([0.5 / len(axis.values) if len(axis.values) else 0.0 for axis in space.free])

    def propose(self, target: int) -> NDArray[np.float64]:
        """Return a point."""
        rng, count = self._rng, self._archive.count
        if count < self._even or rng.random() < _ANYWHERE:
            return super().propose(target)
        elite = self._archive.order(target)[: max(4, min(40, count // 5))]
        rank = min(len(elite) - 1, int(rng.exponential(0.15 * len(elite))))
        points = self._archive.points
        parent = points[elite[rank]].copy()
        moved = rng.random(self._dimensions) < max(0.4, 1.5 / self._dimensions)
        moved[rng.integers(self._dimensions)] = True
        if rng.random() < 0.45:
            a, b = points[rng.choice(elite, 2, replace=False)]
            change = rng.uniform(0.3, 1.2) * (a - b) + rng.uniform(0.0, 0.7) * (points[elite[0]] - parent)
            change += rng.normal(0.0, 0.002, self._dimensions)
        else:
            change = 10.0 ** rng.uniform(-3.0, -0.5) * rng.standard_normal(self._dimensions)
        change = np.where(np.abs(change) < self._step, np.sign(change) * self._step * 2.0, change)
        child = np.where(moved, parent + change, parent)
        # what has no order has no neighbours either
        anew = moved & ~self._is_ordered
        child[anew] = rng.random(int(anew.sum()))
        return _reflected(child)


class Covariance(Evenly):
    """CMA-ES (Hansen) by the package ``cma``: an evolution for each requirement, begun again when it converges."""

    def __init__(self, space: Space, archive: Archive, rng: np.random.Generator) -> None:
        super().__init__(space, archive, rng)
        self._cma: Any = _package("cma", "cma")
        self._archive = archive
        self._even = max(_LEAST_EVEN, _EVEN * self._dimensions)
        self._evolutions: dict[int, Any] = {}
        self._asked: dict[int, list[NDArray[np.float64]]] = {}
        self._told: dict[int, list[tuple[NDArray[np.float64], float]]] = {}
        self._target_of: dict[bytes, int] = {}
        self._starts = 0

    def propose(self, target: int) -> NDArray[np.float64]:
        """Return a point."""
        if self._archive.count < self._even or self._dimensions < 2 or self._rng.random() < _ANYWHERE / 2:
            return super().propose(target)
        if not self._asked.get(target):
            self._next_generation(target)
        point = self._asked[target].pop()
        self._target_of[point.tobytes()] = target
        return point

    def _next_generation(self, target: int) -> None:
        evolution, told = self._evolutions.get(target), self._told.pop(target, [])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if evolution is not None and len(told) >= max(2, evolution.popsize // 2):
                # those that are still under way, or say nothing, do not count
                evolution.tell([list(point) for point, _ in told], [value for _, value in told])
            if evolution is None or evolution.stop():
                evolution = self._evolutions[target] = self._begun(target)
            self._asked[target] = [np.asarray(point) for point in evolution.ask()]

    def _begun(self, target: int) -> Any:
        order = self._archive.order(target)
        self._starts += 1
        rank = min(self._archive.count - 1, (self._starts - 1) * 3)
        start = np.clip(self._archive.points[order[rank]], 0.02, 0.98)
        options = {"bounds": [0.0, 1.0], "verbose": -9, "seed": int(self._rng.integers(1, 1 << 30))}
        return self._cma.CMAEvolutionStrategy(list(start), 0.2, options)

    def tell(self, point: NDArray[np.float64], robustness: list[float]) -> None:
        """Take the result of a point that was proposed here."""
        target = self._target_of.pop(point.tobytes(), None)
        if target is not None and is_known(robustness[target]):
            self._told.setdefault(target, []).append((point, robustness[target]))


class Bayesian(Evenly):
    """A model of the robustness by the package ``optuna``: its tree-structured Parzen estimator."""

    def __init__(self, space: Space, archive: Archive, rng: np.random.Generator) -> None:
        super().__init__(space, archive, rng)
        self._optuna: Any = _package("optuna", "optuna")
        self._optuna.logging.set_verbosity(logging.ERROR)
        self._archive = archive
        self._even = max(_LEAST_EVEN, _EVEN * self._dimensions)
        self._studies: dict[int, Any] = {}
        self._trials: dict[bytes, tuple[int, Any]] = {}

    def propose(self, target: int) -> NDArray[np.float64]:
        """Return a point."""
        if self._archive.count < self._even:
            return super().propose(target)
        if target not in self._studies:
            self._studies[target] = self._begun(target)
        trial = self._studies[target].ask()
        point = np.array([trial.suggest_float(str(axis), 0.0, 1.0) for axis in range(self._dimensions)])
        self._trials[point.tobytes()] = target, trial
        return point

    def _begun(self, target: int) -> Any:
        sampler = self._optuna.samplers.TPESampler(seed=int(self._rng.integers(1 << 30)), multivariate=True)
        study = self._optuna.create_study(sampler=sampler)
        distribution = self._optuna.distributions.FloatDistribution(0.0, 1.0)
        axes = {str(axis): distribution for axis in range(self._dimensions)}
        for point, value in zip(self._archive.points, self._archive.robustness[:, target], strict=True):
            if is_known(value):
                values = {str(axis): float(place) for axis, place in enumerate(point)}
                study.add_trial(self._optuna.trial.create_trial(params=values, distributions=axes, value=float(value)))
        return study

    def tell(self, point: NDArray[np.float64], robustness: list[float]) -> None:
        """Take the result of a point that was proposed here."""
        target, trial = self._trials.pop(point.tobytes(), (0, None))
        if trial is not None:
            value = robustness[target]
            is_complete = is_known(value)
            state = self._optuna.trial.TrialState.COMPLETE if is_complete else self._optuna.trial.TrialState.FAIL
            self._studies[target].tell(trial, value if is_complete else None, state=state)


#: the ways to search, by name
SEARCHES: dict[str, Callable[[Space, Archive, np.random.Generator], Search]] = {
    "random": AtRandom,
    "halton": Evenly,
    "guided": Guided,
    "cma": Covariance,
    "optuna": Bayesian,
}


def _package(name: str, word: str) -> Any:
    try:
        with warnings.catch_warnings():
            # of packages that are used for plots alone
            warnings.simplefilter("ignore")
            return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"the search '{word}' needs {name}: {install('falsify')}") from None


def _reflected(point: NDArray[np.float64]) -> NDArray[np.float64]:
    """A point within the unit cube: what would leave it turns back at the border."""
    folded = np.abs(point) % 2.0
    reflected: NDArray[np.float64] = np.where(folded > 1.0, 2.0 - folded, folded)
    return reflected
