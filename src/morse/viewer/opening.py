"""Opens the view that the options of a run select."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

from morse.core.observer import Observer
from morse.physics.studio import Studio

if TYPE_CHECKING:
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import View


# ``--view studio``: the physics of the scene in MuJoCo's own viewer.

logger = logging.getLogger("morse.viewer")

#: wall-clock seconds between two frames
_INTERVAL = 1.0 / 60.0


class StudioView(Observer):
    """Shows the physics model while the simulation drives it; it has no robots, keys or components."""

    def __init__(self, simulation: Simulation) -> None:
        self._studio = Studio(simulation.world, simulation.options.host)
        self._last_frame = 0.0

    @property
    def url(self) -> str:
        """The address for a browser."""
        return self._studio.url

    def announce(self) -> None:
        """Log the address."""
        logger.info("MuJoCo's viewer is at %s", self.url)

    def after_tick(self) -> None:
        """Show the state at the rate of a screen."""
        now = time.monotonic()
        if now - self._last_frame >= _INTERVAL:
            self._last_frame = now
            self._studio.update()

    def close(self) -> None:
        """Stop the viewer."""
        self._studio.close()


def open_view(simulation: Simulation) -> View | StudioView:
    """Start the live view that the options select.

    Raises:
        StudioMissingError: MuJoCo's viewer is selected, but not installed.
    """
    if simulation.options.view == "studio":
        return StudioView(simulation)
    from morse.viewer.live_view import View

    return View(simulation)
