"""Services that let a client hold the clock; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCTypeError
from morse.core.services import concurrent_service, service

if TYPE_CHECKING:
    from collections.abc import Callable

#: more ticks than that in one call is a mistake: a week at 60 Hz
_MAX_STEPS = 7 * 24 * 3600 * 60
_MAX_SEED = 2**63 - 1


class Steppable(Protocol):
    """What the services need of a simulation."""

    def pause(self) -> None:
        """Stop time."""

    def resume(self) -> None:
        """Let time pass."""

    def step(self, ticks: int, ended: Callable[[tuple[str, Any]], object]) -> None:
        """Let some ticks pass and no more, then call ``ended``."""

    def cancel_steps(self) -> None:
        """Stop after the present tick, although somebody asked for more."""

    def restart(self, seed: int | None) -> None:
        """Start anew, with that seed or the present one."""

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
        """Stop time; services are still answered. Steps that go on end as preempted."""
        self._simulation.pause()

    @service
    def resume(self) -> None:
        """Let time pass again."""
        self._simulation.resume()

    @concurrent_service
    def step(self, ended: Callable[[tuple[str, Any]], object], n: int = 1, tell_sent: bool = False) -> None:
        """Let ``n`` ticks pass, and answer when they are done and the last message of every stream is sent.

        A simulation that was running is paused then. Steps that were asked for before come first.

        Args:
            n: number of ticks.
            tell_sent: let the socket answer how many messages each client of a stream has been sent, by address of the
                client and port of the stream, as in ``"127.0.0.1:40000 60000"``: data on one connection may arrive
                after an answer on another that was sent later.
        """
        self._simulation.step(_integer(n, "the number of steps", 1, _MAX_STEPS), ended)

    def interrupt(self) -> None:
        """A step is cancelled: stop where it is."""
        self._simulation.cancel_steps()

    @service
    def reset(self, seed: int | None = None) -> None:
        """Start anew, as if the simulation had just been launched with that seed.

        Without one, with the present seed. Streams and connections stay; services that go on end as preempted. A
        simulation that was paused is paused at its beginning.
        """
        self._simulation.restart(None if seed is None else _integer(seed, "the seed", 0, _MAX_SEED))

    @service
    def get_seed(self) -> int:
        """The seed of all random numbers."""
        return self._simulation.seed()

    @service
    def state_hash(self) -> str:
        """SHA-256 of the physics and of the data of all components, in hexadecimal digits."""
        return self._simulation.state_hash()
