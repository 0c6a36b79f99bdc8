"""Services that let a client hold the clock; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Protocol

from morse.core.abstractobject import AbstractObject
from morse.core.services import concurrent_service, service
from morse.core.validation.arguments import Range

if TYPE_CHECKING:
    from collections.abc import Callable

#: more ticks than that in one call is a mistake: a week at 60 Hz
_MAX_STEPS = 7 * 24 * 3600 * 60
_MAX_SEED = 2**63 - 1

Steps = Annotated[int, Range(1, _MAX_STEPS)]
Seed = Annotated[int, Range(0, _MAX_SEED)]


class Steppable(Protocol):
    """What the services need of a simulation."""

    def pause(self) -> None:
        """Stop time."""

    def resume(self) -> None:
        """Let time pass."""

    def request_steps(self, ticks: int, ended: Callable[[tuple[str, Any]], object]) -> Callable[[], None]:
        """Let some ticks pass and no more, then call ``ended``; returns what cancels them."""

    def restart(self, seed: int | None) -> None:
        """Start anew, with that seed or the present one."""

    def seed(self) -> int:
        """The seed of all random numbers."""

    def state_hash(self) -> str:
        """A fingerprint of everything."""


class LockstepServices(AbstractObject):
    """Pause, step by step, resume, start anew."""

    def __init__(self, simulation: Steppable) -> None:
        super().__init__()
        self._simulation = simulation

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def pause(self) -> None:
        """Stop time; services are still answered. Steps that go on end as preempted."""
        self._simulation.pause()

    @service(changes=False)
    def resume(self) -> None:
        """Let time pass again."""
        self._simulation.resume()

    @concurrent_service(changes=False)
    def step(
        self,
        ended: Callable[[tuple[str, Any]], object],
        n: Steps = 1,
        tell_sent: bool = False,
    ) -> Any:
        """Let ``n`` ticks pass, and answer when they are done and the last message of every stream is sent.

        A simulation that was running is paused then. Steps that were asked for before come first.

        Args:
            n: number of ticks.
            tell_sent: let the socket answer how many messages each client of a stream has been sent, by address of the
                client and port of the stream, as in ``"127.0.0.1:40000 60000"``: data on one connection may arrive
                after an answer on another that was sent later.
        """
        return self._simulation.request_steps(n, ended)

    @service(changes=False)  # the simulation itself notes it
    def reset(self, seed: Seed | None = None) -> None:
        """Start anew, as if the simulation had just been launched with that seed.

        Without one, with the present seed. Streams and connections stay; services that go on end as preempted. A
        simulation that was paused is paused at its beginning.
        """
        self._simulation.restart(seed)

    @service(changes=False)
    def get_seed(self) -> int:
        """The seed of all random numbers."""
        return self._simulation.seed()

    @service(changes=False)
    def state_hash(self) -> str:
        """SHA-256 of the physics and of the data of all components, in hexadecimal digits."""
        return self._simulation.state_hash()
