"""What looks on while a simulation runs: the live view, recorders, data streams."""

from __future__ import annotations


class Observer:
    """Looks on; every method is called in the simulation thread, and does nothing unless it is overridden.

    An observer must not change the simulation: what comes in from outside are commands, services and controls.
    """

    def before_tick(self) -> None:
        """A tick begins, or a simulation that is paused looks for input."""

    def after_tick(self) -> None:
        """A tick has ended, or a simulation that is paused has looked for input."""

    def restarted(self) -> None:
        """The simulation started anew: the components are new ones."""

    def rearranged(self) -> None:
        """Objects or components have come or gone, or another state was restored."""

    def edited(self) -> None:
        """A model or the class of a component was exchanged: states that were saved before do not fit any more."""

    def viewpoint_changed(self) -> None:
        """The camera of the scene was moved by a service."""

    def report_pace(self, late: float, cause: str = "") -> None:
        """How well the simulation keeps up with the wall clock.

        Args:
            late: wall-clock seconds lost since the last report; 0 if it keeps up again.
            cause: why, as a clause for people; empty if no single cause stands out.
        """

    def close(self) -> None:
        """The simulation ends, or nobody wants to look any more."""
