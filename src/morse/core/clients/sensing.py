"""The budget of pixels and rays for what clients set and spawn, for each simulated second.

A scene script may have cameras and scanners of any size: its author chooses the pace. A client that enlarges them makes
all other clients wait. What clients add together has one budget, whatever they change: sizes of images, angles between
rays, layers, or robots with sensors that they spawn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol
from weakref import WeakKeyDictionary

from morse.core.exceptions import MorseRPCInvokationError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from morse.core.clock import Clock

MOST_PIXELS = 8_000_000
"""The budget, pixels per simulated second."""

RAY = 16
"""Pixels that a ray counts as: a ray is cast, becomes a point, and is written in messages."""

#: Hz; a measurement is made within a tick, whatever its rate, and others wait for the tick: a rare one may not be large
_LEAST_RATE = 10.0


class Sensing(Protocol):
    """A component that may take images or cast rays."""

    frequency: float
    clock: Clock

    def sensing_cost(self) -> float:
        """The pixels of a measurement."""


class SensingBudget:
    """The budget of one simulation.

    Args:
        components: returns the present sensors and actuators.
    """

    def __init__(self, components: Callable[[], Iterable[Sensing]]) -> None:
        self._components = components
        #: pixels per second of what a script or a program has created
        self._granted: WeakKeyDictionary[Sensing, float] = WeakKeyDictionary()

    def grant(self, components: Iterable[Sensing]) -> None:
        """Allow what a scene script or a program has created, as it is at present."""
        for component in components:
            if pixels := _rate(component):
                self._granted[component] = pixels

    def replace(self, before: Sensing, after: Sensing) -> None:
        """A component takes the place of another one, because its class was edited."""
        if before in self._granted:
            self.grant([after])

    def check(self, who: str, changed: Iterable[Sensing]) -> None:
        """Check what clients have set and spawned.

        Args:
            who: what a client has just changed or spawned, for the message.
            changed: its components.

        Raises:
            MorseRPCInvokationError: all together is more than the budget, and ``changed`` is more than scripts allow.
        """
        asked = sum(map(self._extra, changed))
        if not asked:
            return
        total = sum(map(self._extra, self._components()))
        if total > MOST_PIXELS:
            left = max(MOST_PIXELS - (total - asked), 0.0)
            rule = f"a ray counts as {RAY} pixels, less than {_LEAST_RATE:g} measurements per second as {_LEAST_RATE:g}"
            raise MorseRPCInvokationError(
                f"{who}: the budget for what clients set is {MOST_PIXELS:,} pixels per simulated second ({rule}): "
                f"{asked:,.0f} are asked, {left:,.0f} are left; the scene script may set more"
            )

    def _extra(self, component: Sensing) -> float:
        """Pixels per second in addition to those that the script allows."""
        return max(_rate(component) - self._granted.get(component, 0.0), 0.0)


def _rate(component: Sensing) -> float:
    """Pixels per simulated second of a component while it measures."""
    try:
        pixels = component.sensing_cost()
        return pixels * min(max(component.frequency, _LEAST_RATE), component.clock.frequency) if pixels else 0.0
    except Exception:  # code of a user, which cannot tell
        return 0.0
