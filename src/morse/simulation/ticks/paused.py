"""Pausing a simulation, and the ticks that clients request of one that is paused."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core import status

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.context import Context
    from morse.core.services import Outcome
    from morse.simulation.ticks.pacing import Pacer
    from morse.simulation.ticks.stepping import Stepping


def _nobody(_outcome: Outcome) -> None:
    """Default callback for the end of requested ticks."""


class Paused:
    """The part of a simulation that pauses it; see `morse.simulation.simulation.Simulation`."""

    context: Context
    pacer: Pacer
    _stepping: Stepping

    @property
    def paused(self) -> bool:
        """Whether `run` is paused and executes only the requested ticks."""
        return self._stepping.paused

    def pause(self) -> None:
        """Pause `run`; step requests of clients end as preempted."""
        self._stepping.paused = True
        self.cancel_steps()

    def resume(self) -> None:
        """Resume `run`."""
        self._stepping.paused = False
        self.pacer.restart()

    def request_steps(self, ticks: int = 1, ended: Callable[[Outcome], object] = _nobody) -> Callable[[], None]:
        """Let `run` execute ``ticks`` ticks and then pause; earlier requests are executed first.

        Args:
            ended: callback, called with the status when the data of the last tick have been passed to the network.

        Returns:
            A function that cancels the request.
        """
        for manager in self.context.stream_managers.values():
            manager.drain()
        self._stepping.paused = True
        return self._stepping.add(ticks, ended)

    def cancel_steps(self) -> None:
        """Cancel the requested ticks."""
        self._stepping.end(status.PREEMPTED)
