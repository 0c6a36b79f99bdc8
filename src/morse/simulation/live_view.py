"""What a simulation expects of whatever shows it."""

from __future__ import annotations

from typing import Protocol


class LiveView(Protocol):
    """A view of a running simulation; called from the simulation thread."""

    @property
    def url(self) -> str:
        """The address to open in a browser."""

    def announce(self) -> None:
        """The simulation is ready: say where to look."""

    def before_tick(self) -> None:
        """A tick begins: carry out what was asked for."""

    def after_tick(self) -> None:
        """A tick has ended: show what has changed."""

    def restarted(self) -> None:
        """The simulation started anew: the components are new ones."""

    def viewpoint_changed(self) -> None:
        """The camera of the scene was moved by a service."""

    def report_pace(self, late: float, costliest: str = "", cost: float = 0.0) -> None:
        """How well the simulation keeps up; ``late`` in seconds, ``cost`` in milliseconds a tick."""

    def close(self) -> None:
        """Stop showing."""
