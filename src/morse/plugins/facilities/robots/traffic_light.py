"""Traffic lights."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Literal

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.services import service
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.facilities.panels import LENSES, Facility, stored

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.values import StateData
    from morse.core.world import Body

#: what it shows
STATES = ("red", "red-yellow", "yellow", "green", "off")
_DAY = json.dumps([("green", 20.0), ("yellow", 3.0), ("red", 25.0), ("red-yellow", 2.0)])


class TrafficLight(Facility):
    """A traffic light that shows its states by a schedule, or as clients say."""

    _name = "TrafficLight"
    _short_desc = "A traffic light with a schedule"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.builder.TrafficLight")

    add_data("state", "off", "string", "red, red-yellow, yellow, green or off")
    add_data("remaining", 0.0, "float", "Time until the next state of the schedule", unit="s", allow=("inf",))

    _phases: str
    _offset: float
    add_property("_phases", _DAY, "Phases", "string", "States and their durations, s, as JSON",
                 written_by="TrafficLight(phases=...)")  # fmt: skip
    add_property(
        "_offset", 0.0, "Offset", "float", "Time in the schedule at the beginning", unit="s", low=0.0, high=1e6
    )

    add_state("_told", str, "The state that a client has set; empty for the schedule")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        # read once: clients may change properties while the simulation runs
        self._schedule: list[tuple[str, float]] = stored(
            self,
            "Phases",
            self._phases,
            lambda phases: phases and all(state in STATES and 0.1 <= seconds <= 1e6 for state, seconds in phases),
        )
        bright = [part for part in obj.children if not part.node.visible]
        self._lenses = dict(zip(LENSES, bright, strict=True))
        self._told = ""
        self.default_action()

    @service
    def show(self, state: Literal["red", "red-yellow", "yellow", "green", "off"]) -> None:
        """Show a state until `resume`."""
        self._told = state

    @service
    def resume(self) -> None:
        """Follow the schedule again."""
        self._told = ""

    def default_action(self) -> None:
        """Show the state of this time."""
        data = self.local_data
        if self._told:
            data["remaining"], state = math.inf, self._told
        else:
            state, data["remaining"] = self._planned()
        if state != data["state"]:
            data["state"] = state
            self._shine()

    def _planned(self) -> tuple[str, float]:
        """The state of the schedule, and the time until the next one, s."""
        time = (self.clock.time + self._offset) % sum(seconds for _, seconds in self._schedule)
        for state, seconds in self._schedule:
            if time < seconds:
                return state, seconds - time
            time -= seconds
        return self._schedule[-1][0], 0.0

    def _shine(self) -> None:
        for color, lens in self._lenses.items():
            lens.setVisible(color in self.local_data["state"].split("-"))

    def set_state(self, state: StateData) -> None:
        """Restore a state, and the lights with it."""
        super().set_state(state)
        self._shine()
