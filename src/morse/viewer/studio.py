"""``--view studio``: the physics of the scene in MuJoCo's own viewer."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

from morse.core.observer import Observer
from morse.physics.studio import Studio

if TYPE_CHECKING:
    from morse.simulation.simulation import Simulation

logger = logging.getLogger("morse.viewer")

#: wall-clock seconds between two pictures
_INTERVAL = 1.0 / 60.0


class StudioView(Observer):
    """Shows the physics model while the simulation drives it; it has no robots, keys or components."""

    def __init__(self, simulation: Simulation) -> None:
        self._studio = Studio(simulation.world, simulation.options.host)
        self._shown = 0.0

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        return self._studio.url

    def announce(self) -> None:
        """Say where to look."""
        logger.info("MuJoCo's viewer is at %s", self.url)

    def after_tick(self) -> None:
        """Show the state, as often as a screen does."""
        now = time.monotonic()
        if now - self._shown >= _INTERVAL:
            self._shown = now
            self._studio.update()

    def close(self) -> None:
        """Stop the viewer."""
        self._studio.close()
