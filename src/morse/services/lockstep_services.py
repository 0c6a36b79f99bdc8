"""Services that let a client control the clock; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Protocol

from morse.core.abstractobject import AbstractObject
from morse.core.services import concurrent_service, service
from morse.core.validation.arguments import Range

if TYPE_CHECKING:
    from collections.abc import Callable

#: maximum number of ticks in one call: a week at 60 Hz
_MAX_STEPS = 7 * 24 * 3600 * 60
_MAX_SEED = 2**63 - 1

Steps = Annotated[int, Range(1, _MAX_STEPS)]
Seed = Annotated[int, Range(0, _MAX_SEED)]


class Steppable(Protocol):
    """The part of a simulation that the services need."""

    def pause(self) -> None:
        """Pause the simulation."""

    def resume(self) -> None:
        """Resume the simulation."""

    def request_steps(self, ticks: int, on_end: Callable[[tuple[str, object]], object]) -> Callable[[], None]:
        """Run some ticks, then pause and call ``on_end``; return a function that cancels the request."""

    def restart(self, seed: int | None) -> None:
        """Restart with ``seed`` or the present seed."""

    def seed(self) -> int:
        """The seed of all random numbers."""

    def state_hash(self) -> str:
        """Return the hash of the state."""


class LockstepServices(AbstractObject):
    """Pause, step, resume, restart."""

    def __init__(self, simulation: Steppable) -> None:
        super().__init__()
        self._simulation = simulation

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def pause(self) -> None:
        """Pause the simulation; services are still answered. Running step requests end as preempted."""
        self._simulation.pause()

    @service(changes=False)
    def resume(self) -> None:
        """Resume the simulation."""
        self._simulation.resume()

    @concurrent_service(changes=False)
    def step(
        self,
        ended: Callable[[tuple[str, object]], object],
        n: Steps = 1,
        tell_sent: bool = False,
    ) -> object:
        """Run ``n`` ticks; the service ends when they are done and the last message of every stream has been sent.

        The simulation is paused afterwards. Earlier step requests are processed first.

        Args:
            n: number of ticks.
            tell_sent: whether the answer of the socket contains the number of messages that were sent to each client of
                a stream, by address of the client and port of the stream, as in ``"127.0.0.1:40000 60000"``. Clients
                need it because data on one connection may arrive later than a newer answer on another connection.
        """
        return self._simulation.request_steps(n, ended)

    @service(changes=False)  # the simulation records the call itself
    def reset(self, seed: Seed | None = None) -> None:
        """Restart, as if the simulation had just been launched with ``seed``.

        Without ``seed``, the present seed is used. Streams and connections stay open; running services end as
        preempted. A paused simulation stays paused at tick 0.
        """
        self._simulation.restart(seed)

    @service(changes=False)
    def get_seed(self) -> int:
        """The seed of all random numbers."""
        return self._simulation.seed()

    @service(changes=False)
    def state_hash(self) -> str:
        """Return the SHA-256 of the physics and of the data of all components, in hexadecimal digits."""
        return self._simulation.state_hash()
