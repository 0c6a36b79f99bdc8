"""Services that let a client hold the clock; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from morse.core import status
from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCTypeError
from morse.core.services import async_service, interruptible, service

if TYPE_CHECKING:
    from collections.abc import Callable

#: more ticks than that in one call is a mistake: a week at 60 Hz
_MAX_STEPS = 7 * 24 * 3600 * 60
_SEEDS = 2**63


class Steppable(Protocol):
    """What the services need of a simulation."""

    paused: bool

    def pause(self) -> None:
        """Stop time."""

    def resume(self) -> None:
        """Let time pass."""

    def step(self, ticks: int, done: Callable[[], None] | None = None) -> None:
        """Let some ticks pass, then call ``done``."""

    def restart(self, seed: int | None, done: Callable[[], None]) -> None:
        """Start anew, then call ``done``."""

    def seed(self) -> int:
        """The seed of all random numbers."""

    def state_hash(self) -> str:
        """A fingerprint of everything."""


def _integer(value: Any, what: str, low: int, high: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise MorseRPCTypeError(f"{what} is an integer from {low} to {high}, not {value!r}")
    return value


class LockstepServices(AbstractObject):
    """Pause, step by step, resume, start anew."""

    def __init__(self, simulation: Steppable) -> None:
        super().__init__()
        self._simulation = simulation

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service
    def pause(self) -> None:
        """Stop time; services are still answered."""
        self._simulation.pause()

    @service
    def resume(self) -> None:
        """Let time pass again."""
        self._simulation.resume()

    @interruptible
    @async_service
    def step(self, n: int = 1) -> None:
        """Let ``n`` ticks pass, and answer when they are done and their data is sent.

        A simulation that was running is paused.
        """
        count = _integer(n, "the number of steps", 1, _MAX_STEPS)
        self._simulation.pause()
        self._simulation.step(count, lambda: self.completed(status.SUCCESS))

    @interruptible
    @async_service
    def reset(self, seed: int | None = None) -> None:
        """Start anew, as if the simulation had just been launched with that seed."""
        checked = None if seed is None else _integer(seed, "the seed", 0, _SEEDS)
        self._simulation.restart(checked, lambda: self.completed(status.SUCCESS))

    @service
    def get_seed(self) -> int:
        """The seed of all random numbers."""
        return self._simulation.seed()

    @service
    def state_hash(self) -> str:
        """SHA-256 of the physics and of the data of all components, in hexadecimal digits."""
        return self._simulation.state_hash()
