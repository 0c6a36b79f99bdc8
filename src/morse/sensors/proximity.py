"""Nearby objects."""

from __future__ import annotations

import math
from typing import Annotated

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.exceptions import MorseRPCTypeError
from morse.core.limits import LENGTH
from morse.core.sensor import Sensor, WatchedSpace
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property

Reach = Annotated[float, Range(**LENGTH, allow=("inf",))]


class Proximity(Sensor):
    """Lists the objects with a certain property whose centres are near the robot, even behind walls."""

    _name = "Proximity"
    _short_desc = "Distance sensor to detect nearby objects"
    _builder = BuilderDefaults(
        frequency=12.0,
        properties={"Range": 30.0},
        visual=Visual("cylinder", (0.02, 0.02, 0.02), (0.5, 0.5, 0.5)),
    )

    add_data("near_objects", {}, "dict", "Name of each object to its distance", unit="m")
    add_data("near_robots", {}, "dict", "The same as near_objects, for older scripts", unit="m", follows="near_objects")

    add_property("_range", 100.0, "Range", "float", "Largest distance", **LENGTH, allow=("inf",))
    add_property("_tag", "Robot_Tag", "Track", "string", "Property that objects must have")

    _range: float
    _tag: str

    def watched_space(self) -> WatchedSpace:
        """Return a sphere with the range as radius."""
        return WatchedSpace(self._range, seen=tuple(self.local_data["near_objects"]))

    @service
    def set_range(self, range: Reach) -> None:
        """Set the range.

        Args:
            range: metres.
        """
        self._range = float(range)

    @service
    def set_tracked_tag(self, tag: str) -> None:
        """Set the property that objects must have.

        Args:
            tag: name of the property.
        """
        if not tag:
            raise MorseRPCTypeError("set_tracked_tag: 'tag' is the name of a property, not ''")
        self._tag = tag

    def measure(self) -> None:
        """Find the nearby objects."""
        own, tag = self.robot_parent.bge_object, self._tag
        here = own.world_pose()[0]
        near: dict[str, float] = {}
        for obj in self.context.world.objects():
            if tag in obj.properties and obj is not own:
                distance = math.dist(here, obj.world_pose()[0])
                if distance <= self._range:
                    near[obj.name] = distance
        self.local_data["near_objects"] = near

    def report(self) -> None:
        """Copy the objects to the second field."""
        self.local_data["near_robots"] = self.local_data["near_objects"]
