"""The base class of observers of a simulation: the live view, recorders, data streams."""

from __future__ import annotations

#: attribute of a log record whose content observers receive by another method, too
SHOWN = "shown_by_observers"


class Observer:
    """Observes a simulation; all methods are called in the simulation thread and do nothing by default.

    An observer must not change the simulation: input from outside consists of commands, services and controls only.
    """

    @property
    def waits(self) -> bool:
        """Whether the methods for ticks have nothing to do until robots touch something; False for most observers."""
        return False

    @property
    def sees_steps(self) -> bool:
        """Whether it is enough to be notified of the ticks in which robots may touch something, and of the last tick.

        Such an observer does nothing before a tick. False for most observers.
        """
        return False

    def before_tick(self) -> None:
        """Called at the beginning of a tick, or when a paused simulation polls for input."""

    def after_tick(self) -> None:
        """Called at the end of a tick, or when a paused simulation has polled for input."""

    def restarted(self) -> None:
        """Called after a restart: all components are new instances."""

    def rearranged(self) -> None:
        """Called when objects or components were added or removed, or another state was restored."""

    def edited(self) -> None:
        """Called when a model or the class of a component was replaced: states saved before are no longer valid."""

    def viewpoint_changed(self) -> None:
        """Called when a service moved the camera of the scene."""

    def report_pace(self, late: float, cause: str = "") -> None:
        """Report how well the simulation keeps up with the wall clock.

        Args:
            late: wall-clock seconds lost since the last report; 0 if the simulation keeps up again.
            cause: the cause as text for the user; empty if there is no single cause.
        """

    def close(self) -> None:
        """Called at the end of the simulation, or when the observer is removed."""
