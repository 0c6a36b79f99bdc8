"""Doors."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.facilities.panels import Facility, Panels, door_places

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.values import StateData
    from morse.core.world import Body


class Opening(Facility):
    """What opens by presence or by call, and does not close while somebody is in it."""

    add_data("state", "closed", "string", "closed, moving or open")
    add_data("openness", 0.0, "float", "Share of the way from closed to open", low=0.0, high=1.0)
    add_data("locked", False, "bool", "Whether it stays closed")

    _width: float
    _height: float
    _automatic: float
    _hold: float
    _duration: float
    add_property(
        "_automatic", 0.0, "Automatic", "float", "Distance at which it opens by itself; 0: never", unit="m", low=0.0,
        high=100.0,
    )  # fmt: skip
    add_property("_hold", 4.0, "Hold", "float", "Time for which it stays open", unit="s", low=0.0, high=1e6)
    add_property("_duration", 2.0, "Duration", "float", "Time to open", unit="s", low=0.1, high=1000.0)

    add_state("_until", float, "Time until which it stays open, s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._panels = Panels(self.context, obj)
        #: m, of the opening; read once: clients may change properties while the simulation runs
        self._broad = self._width
        self._until = -math.inf
        self._begin()
        self._show()

    def _begin(self) -> None:
        """Read what else was made once."""

    @abstractmethod
    def _swept(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The corners of the box in which a panel moves."""

    @abstractmethod
    def _show(self) -> None:
        """Place the panels."""

    @service
    def open(self) -> None:
        """Open it; it closes after the property ``Hold``."""
        if self.local_data["locked"]:
            raise MorseRPCInvokationError(f"{self.name()} is locked: call unlock first")
        self.keep_open()

    def keep_open(self) -> None:
        """Open it, unless it is locked."""
        if not self.local_data["locked"]:
            self._until = self.clock.time + self._duration + self._hold

    @service
    def close(self) -> None:
        """Close it as soon as nobody is in it."""
        self._until = -math.inf

    @service
    def lock(self) -> None:
        """Close it as soon as nobody is in it, and let nobody open it."""
        self.local_data["locked"] = True
        self._until = -math.inf

    @service
    def unlock(self) -> None:
        """Let it be opened again."""
        self.local_data["locked"] = False

    def default_action(self) -> None:
        """Open, close or stay."""
        data, half = self.local_data, 0.5 * self._broad
        openness = data["openness"]
        if openness == 0.0 and self._until < self.clock.time and not self._automatic:
            return
        people = self._panels.present()
        if self._automatic and not data["locked"] and len(people):
            beyond = np.maximum(np.abs(people) - (0.0, half), 0.0)
            if float((beyond * beyond).sum(axis=1).min()) < self._automatic**2:
                self._until = self.clock.time + self._hold
        step = self.clock.period / self._duration
        if self._until >= self.clock.time:
            openness = min(openness + step, 1.0)
        elif openness > 0.0 and not self._panels.is_in_way(people, *self._swept()):
            openness = max(openness - step, 0.0)
        if openness != data["openness"]:
            data["openness"] = openness
            self._show()
        data["state"] = "open" if openness == 1.0 else "closed" if openness == 0.0 else "moving"

    def set_state(self, state: StateData) -> None:
        """Restore a state, and the panels with it."""
        super().set_state(state)
        self._show()


class Door(Opening):
    """A door that opens by presence or by call, and does not close while somebody is in it."""

    _name = "Door"
    _short_desc = "A hinged or sliding door that opens by presence or by call"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.builder.Door")

    _kind: str
    add_property("_kind", "hinged", "Kind", "string", "How it opens", choices=("hinged", "sliding", "double"),
                 written_by="Door(kind=...)")  # fmt: skip
    add_property("_width", 0.95, "Width", "float", "Width of the opening", unit="m", low=0.3, high=50.0,
                 written_by="Door(width=...)")  # fmt: skip
    add_property("_height", 2.1, "Height", "float", "Height of the opening", unit="m", low=0.3, high=50.0,
                 written_by="Door(height=...)")  # fmt: skip

    def _begin(self) -> None:
        self._made = self._kind, self._width, self._height

    def _swept(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        kind, width, height = self._made
        return (0.0, -0.5 * width, 0.0), (width if kind == "hinged" else 0.0, 0.5 * width, height)

    def _show(self) -> None:
        openness = float(self.local_data["openness"])
        self._panels.place(*door_places(*self._made, openness))
