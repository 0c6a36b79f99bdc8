"""The live view of a row of a batch, which a simulation beside the batch copies."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from morse.core.realism import copied
from morse.core.rows.marks import present_data
from morse.viewer import page_messages as page
from morse.viewer.feeds.recorded import cast_wished_rays
from morse.viewer.live_view import View
from morse.viewer.page import PageLeft
from morse.viewer.view_messages import Refused

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.simulation.simulation import Simulation

    Handlers = dict[type, Callable[[object], object]]

#: wall-clock seconds between two pictures; and the largest share of the time that they may take
_INTERVAL, _SHARE = 1.0 / 30.0, 0.1
#: wall-clock seconds over which the speed is computed
_SPEED_INTERVAL = 0.3


class RowView(View):
    """Shows a row of a batch, only while a page is open. Commands, keys and services of the pages are refused.

    Args:
        simulation: a simulation of the same scene, which shows the row and is not stepped.
    """

    changeable = False

    def __init__(self, simulation: Simulation) -> None:
        super().__init__(simulation)
        self._still = False
        self._next = 0.0
        #: wall-clock and simulated time since which the speed is computed, s
        self._since = time.monotonic(), 0.0
        self._speed = 0.0
        nothing: Handlers = dict.fromkeys((page.ListenTo, page.ToggleCapturing, PageLeft), _ignore)
        own: Handlers = {
            page.Play: lambda _: self._hold(still=False),
            page.Pause: lambda _: self._hold(still=True),
        }
        self._handlers = {**dict.fromkeys(self._handlers, self._refuse), **nothing, **own}

    def _hold(self, *, still: bool) -> None:
        self._still, self._next = still, 0.0

    def _refuse(self, event: object) -> None:
        self._server.send(Refused(type(event).__name__, "a row of a batch is only shown: its program drives it"))

    def _is_paused(self) -> bool:
        return self._still

    def _factor(self) -> float:
        now, time_now = time.monotonic(), self._simulation.clock.time
        since, begin = self._since
        if time_now < begin:  # another episode
            self._since = now, time_now
        elif now - since > _SPEED_INTERVAL:
            self._since, self._speed = (now, time_now), (time_now - begin) / (now - since)
        return self._speed

    def turn(self, row: Callable[[], Simulation]) -> None:
        """Show a row as it is now, if a page is open and the last picture is old enough.

        Args:
            row: returns the simulation of the row, up to date.
        """
        if not self._server.watched:
            return
        begin = time.monotonic()
        if begin < self._next:
            return
        if events := self._server.take_events():
            self._handle(events)
        if not self._still:
            self._copy(row())
        self.after_tick()
        network = self._simulation.context.network
        assert network is not None
        network.give_back()
        now = time.monotonic()
        self._next = now + max(_INTERVAL, (now - begin) / _SHARE)

    def _copy(self, row: Simulation) -> None:
        simulation = self._simulation
        simulation.arrange(row.save(), described=False)
        for name, component in simulation.context.components.items():
            original = row.context.component(name)
            if original is not None:
                component.local_data.update({field: copied(value) for field, value in present_data(original).items()})
        cast_wished_rays(simulation.context, self._server.wishes.overlays)


def _ignore(_event: object) -> None:
    """Requests that concern the page alone."""
