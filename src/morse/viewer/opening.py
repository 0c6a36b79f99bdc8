"""Opens the view that the options of a run select."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import View
    from morse.viewer.studio import StudioView


def open_view(simulation: Simulation) -> View | StudioView:
    """Start the live view that the options select.

    Raises:
        StudioMissingError: MuJoCo's viewer is selected, but not installed.
    """
    if simulation.options.view == "studio":
        from morse.viewer.studio import StudioView

        return StudioView(simulation)
    from morse.viewer.live_view import View

    return View(simulation)
