"""A page that shows a row of a batch while it runs."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, cast

from morse.core.reports.faults import describe

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.many.scenes import Scenes
    from morse.simulation.simulation import Simulation
    from morse.viewer.notebook import Frame
    from morse.viewer.row_view import RowView

logger = logging.getLogger(__name__)


class Window:
    """Serves the page of one row at a time, on this machine only.

    Args:
        scenes: of the batch.
        port: TCP port; 0 for any free port.
    """

    def __init__(self, scenes: Scenes, port: int = 0) -> None:
        self._scenes, self._port = scenes, port
        self._simulation: Simulation | None = None
        self.row = -1

    def show(self, row: int, height: int) -> Frame:
        """Show another row; return its page."""
        if self._simulation is None or not self._scenes.are_alike(row, self.row):
            # imported on demand: it imports the server of pages
            from morse.viewer.row_view import RowView

            self.close()
            self._simulation = simulation = self._scenes.load_view(row, RowView, self._port)
            view = _view(simulation)
            self._port = view.address[0]
            view.announce()
        self.row = row
        view = _view(self._simulation)
        frame = view.show(height)
        logger.info("row %d is shown at %s", row, view.url)
        return frame

    def turn(self, row_of: Callable[[int], Simulation]) -> None:
        """Show the row as it is now, if somebody looks; a page that fails is closed, and the batch goes on."""
        if self._simulation is None:
            return
        try:
            _view(self._simulation).turn(lambda: row_of(self.row))
        except Exception as error:
            logger.error("the page of row %d is closed: %s", self.row, describe(error))
            self.close()

    def close(self) -> None:
        """Close the page."""
        simulation, self._simulation = self._simulation, None
        if simulation is not None:
            simulation.close()


def _view(simulation: Simulation) -> RowView:
    """Return the view that `Scenes.load_view` has opened."""
    return cast("RowView", simulation.view)
