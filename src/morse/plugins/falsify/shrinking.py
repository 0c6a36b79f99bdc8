"""Makes a failing case plain: nothing differs from the defaults that need not, and the rest as little as possible.

Since runs repeat, each step is sure: a case that has failed fails again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Generator

    from morse.plugins.falsify.space import Axis, Space

#: distance of two values from 0 to 1, of which one passes and one fails, that is small enough
_PRECISION = 0.004
#: rounds through all parameters
_ROUNDS = 3
#: seeds that are tried in the place of the one that has failed
_SEEDS = 5

_Point: TypeAlias = dict[str, Any]


@dataclass(frozen=True)
class Boundary:
    """Where a parameter begins to matter, the others being those of the smallest case.

    Attributes:
        passes: a value with which the run passes.
        fails: the value next to it that is known to fail.
    """

    passes: Any
    fails: Any


class Shrinking:
    """The search for the smallest case of one kind of failure.

    Attributes:
        smallest: the smallest case so far.
        boundaries: where each parameter begins to matter.
    """

    def __init__(self, space: Space, found: _Point) -> None:
        self._space, self.smallest = space, dict(found)
        self.boundaries: dict[str, Boundary] = {}

    def steps(self) -> Generator[_Point, bool, None]:
        """Yields points; each has to be answered by whether it fails in the same way."""
        for _ in range(_ROUNDS):
            before = dict(self.smallest)
            for axis in self._space.free:
                yield from self._parameter(axis)
            if self.smallest == before:
                break
        for axis in self._space.free:
            yield from self._round(axis)

    def _parameter(self, axis: Axis) -> Generator[_Point, bool, None]:
        name = axis.name
        if self.smallest[name] == axis.default:
            return
        if (yield self.smallest | {name: axis.default}):
            self.smallest[name] = axis.default
            self.boundaries.pop(name, None)
            return
        if not axis.is_ordered:
            for value in axis.values[:_SEEDS] if name == "seed" else axis.values:
                if value == self.smallest[name]:
                    return
                if (yield self.smallest | {name: value}):
                    self.smallest[name] = value
                    return
            return
        passes = axis.default
        while axis.distance(passes, self.smallest[name]) > _PRECISION:
            middle = axis.between(passes, self.smallest[name])
            if middle == self.smallest[name]:
                break
            if (yield self.smallest | {name: middle}):
                self.smallest[name] = middle
            else:
                passes = middle
        self.boundaries[name] = Boundary(passes, self.smallest[name])

    def _round(self, axis: Axis) -> Generator[_Point, bool, None]:
        boundary = self.boundaries.get(axis.name)
        if boundary is None:
            return
        for short in axis.rounded(self.smallest[axis.name], axis.default):
            if short == self.smallest[axis.name]:
                return
            if (yield self.smallest | {axis.name: short}):
                self.smallest[axis.name] = short
                return
