"""Lifts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.facilities.panels import (
    Facility,
    Panels,
    are_lengths,
    check_numbers,
    lift_places,
    stored,
    travel,
)

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.values import StateData
    from morse.core.world import Body

#: s, in which doors open and close
_DOORS = 1.5
Level = Annotated[int, Range(0, 99)]


class Lift(Facility):
    """A lift: it goes to the floors from which it is called, in the order of the calls, and opens its doors there."""

    _name = "Lift"
    _short_desc = "A lift with doors, which robots and people call and ride"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.builder.Lift")

    add_data("level", 0, "int", "The floor where it is, or that it has passed last", low=0)
    add_data("destination", 0, "int", "The floor to which it goes", low=0)
    add_data("height", 0.0, "float", "Height of the cabin above the lowest floor", unit="m")
    add_data("speed", 0.0, "float", "Speed, upward", unit="m/s")
    add_data("openness", 0.0, "float", "Share of the way of its doors from closed to open", low=0.0, high=1.0)
    add_data("state", "stopped", "string", "stopped, up, down, opening, open or closing")

    _levels: str
    _size: str
    _speed: float
    _acceleration: float
    _hold: float
    _capacity: int
    add_property("_levels", "[0.0, 3.5]", "Levels", "string", "Heights of the floors, m, as JSON",
                 written_by="Lift(levels=...)")  # fmt: skip
    add_property("_size", "[2.0, 1.8, 2.2]", "Size", "string", "Depth, width and height of the cabin, m, as JSON",
                 written_by="Lift(size=..., height=...)")  # fmt: skip
    add_property("_speed", 1.0, "Speed", "float", "Speed", unit="m/s", low=0.05, high=20.0)
    add_property("_acceleration", 0.8, "Acceleration", "float", "Acceleration", unit="m/s^2", low=0.05, high=10.0)
    add_property("_hold", 5.0, "Hold", "float", "Time for which its doors stay open", unit="s", low=0.0, high=1e6)
    add_property("_capacity", 0, "Capacity", "int", "People who ride at once; 0 for as many as have room", low=0)

    add_state("_calls", list, "Floors that have called it")
    add_state("_until", float, "Time until which its doors stay open, s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._panels = Panels(self.context, obj)
        self.levels: list[float] = stored(
            self, "Levels", self._levels, lambda one: are_lengths(one) and 2 * len(one) + 6 == self._panels.count
        )
        self._cabin: list[float] = stored(self, "Size", self._size, lambda one: are_lengths(one) and len(one) == 3)
        self._calls: list[int] = []
        self._until = -math.inf
        self._show()

    @service
    def call(self, level: Level) -> None:
        """Call the lift to a floor, from there or from the cabin.

        Args:
            level: number of the floor, from 0.
        """
        if level >= len(self.levels):
            raise MorseRPCInvokationError(f"{self.name()} has the floors 0 to {len(self.levels) - 1}, not {level}")
        if level not in self._calls:
            self._calls.append(level)

    @service(changes=False)
    def floors(self) -> list[float]:
        """Heights of the floors above the lowest one, m."""
        return list(self.levels)

    @service
    def hold_doors(self, seconds: Annotated[float, Range(0.0, 3600.0, "s")]) -> None:
        """Keep the doors open for some time, if they are open."""
        if self.local_data["openness"] > 0.0:
            self._until = max(self._until, self.clock.time + seconds)

    def default_action(self) -> None:
        """Follow the calls."""
        data = self.local_data
        if not self._calls and data["openness"] == 0.0:
            return
        height = data["height"]
        target = self._calls[0] if self._calls else data["level"]
        there = height == self.levels[target] and data["speed"] == 0.0
        if there:
            self._serve(target)
        elif data["openness"] > 0.0:
            self._shut()
        else:
            self._travel(self.levels[target])
        data["destination"] = self._calls[0] if self._calls else data["level"]
        self._show()

    def _serve(self, level: int) -> None:
        """Open the doors at a floor, wait, and close them."""
        data = self.local_data
        data["level"] = level
        step = self.clock.period / _DOORS
        if self._calls and data["state"] != "open":
            data["openness"] = min(data["openness"] + step, 1.0)
            data["state"] = "opening"
            if data["openness"] == 1.0:
                data["state"] = "open"
                self._calls.pop(0)
                self._until = self.clock.time + self._hold
        elif self._calls and self._calls[0] == level:
            self._calls.pop(0)
            self._until = self.clock.time + self._hold
        elif self.clock.time >= self._until:
            self._shut()

    def _shut(self) -> None:
        data = self.local_data
        if self.clock.time < self._until:
            return
        depth, width, tall = self._cabin
        height, people = data["height"], self._panels.present(data["height"])
        low, high = (0.5 * depth, -0.5 * width, height), (0.5 * depth, 0.5 * width, height + tall)
        if self._panels.is_in_way(people, low, high):
            return
        data["openness"] = max(data["openness"] - self.clock.period / _DOORS, 0.0)
        data["state"] = "closing" if data["openness"] else "stopped"

    def _travel(self, target: float) -> None:
        """Move for a tick: as fast as allowed, and so that the cabin stops at the floor."""
        data = self.local_data
        up = target > data["height"]
        limits = self._speed, self._acceleration
        data["height"], data["speed"] = travel(data["height"], data["speed"], target, limits, self.clock.period)
        data["state"] = "stopped" if not data["speed"] else "up" if up else "down"
        floors = range(len(self.levels))
        if up:
            data["level"] = max((one for one in floors if self.levels[one] <= data["height"] + 1e-6), default=0)
        else:
            data["level"] = min((one for one in floors if self.levels[one] >= data["height"] - 1e-6), default=0)

    def _show(self) -> None:
        data = self.local_data
        places = lift_places(self.levels, self._cabin, float(data["height"]), float(data["openness"]))
        self._panels.place(places, np.zeros(len(places)))

    def set_state(self, state: StateData) -> None:
        """Restore a state, and the panels with it.

        Raises:
            StateError: the lift was called to floors that it does not have.
        """
        check_numbers(self, state, "_calls", len(self.levels))
        super().set_state(state)
        self._show()
