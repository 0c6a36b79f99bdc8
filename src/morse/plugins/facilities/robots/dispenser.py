"""Dispensers of boxes."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.facilities.panels import Facility, Panels, are_lengths, check_numbers, stored

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.values import StateData
    from morse.core.world import Body


class Dispenser(Facility):
    """A cabinet that puts boxes out, one by one, as soon as the place in front of it is free."""

    _name = "Dispenser"
    _short_desc = "A cabinet that puts out boxes, at a rate or by call, and takes them back"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.handling.Dispenser")

    add_data("left", 0, "int", "Boxes in the cabinet", low=0)
    add_data("count", 0, "int", "Boxes that it has put out so far", low=0)
    add_data("last", "", "string", "Name of the last box")
    add_data("blocked", False, "bool", "Whether the next box waits for a free place")

    _own_boxes: str
    _size: str
    _height: float
    _interval: float
    add_property("_own_boxes", "[]", "Boxes", "string", "Names of its boxes, as JSON",
                 written_by="Dispenser(stock=...)")  # fmt: skip
    add_property("_size", "[0.3, 0.3, 0.2]", "Size", "string", "Length, width and height of a box, m, as JSON",
                 written_by="Dispenser(size=...)")  # fmt: skip
    add_property("_height", 0.82, "Height", "float", "Height at which the bottom of a box appears", unit="m", low=0.0)
    add_property(
        "_interval", 0.0, "Interval", "float", "Time between two boxes; 0: by call", unit="s", low=0.0, high=1e6
    )

    add_state("_out", list, "Numbers of the boxes that are out, in their order")
    add_state("_next", float, "Time of the next box, s")
    add_state("_waiting", int, "Boxes that were asked for, and wait for a free place")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._panels = Panels(self.context, obj)
        objects = self.context.world.objects_by_name
        self._boxes = [objects[name] for name in json.loads(self._own_boxes)]
        self._places = [one.world_pose() for one in self._boxes]
        self._numbers = {one.name: number for number, one in enumerate(self._boxes)}
        # read once, as the boxes were made: clients may change properties while the simulation runs
        self._sides: list[float] = stored(self, "Size", self._size, lambda one: are_lengths(one) and len(one) == 3)
        self._outlet = (0.0, 0.0, float(self._height) + 0.5 * self._sides[2])
        self._out: list[int] = []
        self._next, self._waiting = 0.0, 0
        self.local_data["left"] = len(self._boxes)

    @service
    def dispense(self, count: Annotated[int, Range(1, 200)] = 1) -> None:
        """Put out boxes, each as soon as the place is free.

        Args:
            count: how many.
        """
        left = self.local_data["left"] - self._waiting
        if count > left:
            raise MorseRPCInvokationError(f"{self.name()} has {left} boxes left, not {count}: call take_back(box)")
        self._waiting += count

    @service
    def take_back(self, box: str) -> None:
        """Take a box back into the cabinet, wherever it is.

        Args:
            box: its name.
        """
        number = self._numbers.get(box)
        if number is None:
            hint = nearest(box, sorted(self._numbers))
            raise MorseRPCInvokationError(f"{self.name()} has no box '{box:.80}'{hint}")
        if number not in self._out:
            raise MorseRPCInvokationError(f"{box} is in the cabinet of {self.name()}")
        self._out.remove(number)
        self._put(number, *self._places[number])

    @service(changes=False)
    def boxes(self) -> list[str]:
        """Names of the boxes that are out, in the order in which they were put out."""
        return [self._boxes[number].name for number in self._out]

    def default_action(self) -> None:
        """Put out what is due."""
        data, now = self.local_data, self.clock.time
        if self._interval and now >= self._next:
            if not self._waiting and len(self._out) < len(self._boxes):
                self._waiting = 1
            self._next = now + self._interval
        data["blocked"] = bool(self._waiting) and not self._is_free()
        if self._waiting and not data["blocked"]:
            self._waiting -= 1
            number = next(one for one in range(len(self._boxes)) if one not in self._out)
            self._out.append(number)
            axes = self._panels.axes
            place = self._panels.origin + (axes * np.array(self._outlet)).sum(axis=1)
            self._put(number, place.tolist(), axes.ravel().tolist())
            data["count"] += 1
            data["last"] = self._boxes[number].name
        data["left"] = len(self._boxes) - len(self._out)

    def _put(self, number: int, position: Sequence[float], rotation: Sequence[float]) -> None:
        box = self._boxes[number]
        box.set_pose(position, rotation)
        box.set_velocity((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def _is_free(self) -> bool:
        """Whether no other box, no robot and nobody is where the next box appears."""
        reach = math.dist((0.0, 0.0, 0.0), self._sides)
        place = self._panels.origin + (self._panels.axes * np.array(self._outlet)).sum(axis=1)
        if any(math.dist(self._boxes[number].world_pose()[0], place) < reach for number in self._out):
            return False
        half = 0.5 * np.array(self._sides)
        low, high = np.array(self._outlet) - half, np.array(self._outlet) + half
        return not self._panels.is_in_way(np.zeros((0, 2)), low.tolist(), high.tolist())

    def set_state(self, state: StateData) -> None:
        """See `Object.set_state`.

        Raises:
            StateError: boxes are out that it does not have.
        """
        check_numbers(self, state, "_out", len(self._boxes))
        super().set_state(state)
