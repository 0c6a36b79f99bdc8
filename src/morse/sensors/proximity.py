"""What is near."""

from __future__ import annotations

import math
from typing import Any

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.exceptions import MorseRPCTypeError
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.helpers.components import add_data, add_property


class Proximity(Sensor):
    """Lists the objects with a certain property whose centres are near that of the robot, walls or no walls."""

    _name = "Proximity"
    _short_desc = "Distance sensor to detect nearby objects"
    _builder = BuilderDefaults(
        frequency=12.0,
        properties={"Range": 30.0},
        visual=Visual("cylinder", (0.02, 0.02, 0.02), (0.5, 0.5, 0.5)),
    )

    add_data("near_objects", {}, "dict", "Name of each object to its distance", unit="m")
    add_data("near_robots", {}, "dict", "The same, under the name that older scripts use", unit="m")

    add_property("_range", 100.0, "Range", "float", "How far it looks, m")
    add_property("_tag", "Robot_Tag", "Track", "string", "The property that objects must have")

    _range: float
    _tag: str

    @property
    def reach(self) -> float:
        """How far it looks, m."""
        return self._range

    @service
    def set_range(self, range: float) -> None:
        """Look that far.

        Args:
            range: metres.
        """
        if isinstance(range, bool) or not isinstance(range, (int, float)) or not range >= 0.0:
            raise MorseRPCTypeError(f"set_range takes a number of metres from 0 upward, not {range!r}")
        self._range = float(range)

    @service
    def set_tracked_tag(self, tag: str) -> None:
        """Look for objects that have that property.

        Args:
            tag: name of the property.
        """
        if not isinstance(tag, str) or not tag:
            raise MorseRPCTypeError(f"set_tracked_tag takes the name of a property, not {tag!r}")
        self._tag = tag

    def default_action(self) -> None:
        """See what is near."""
        own, tag = self.robot_parent.bge_object, self._tag
        here = own.world_pose()[0]
        near: dict[str, Any] = {}
        for obj in self.context.world.objects():
            if tag in obj.properties and obj is not own:
                distance = math.dist(here, obj.world_pose()[0])
                if distance <= self._range:
                    near[obj.name] = distance
        self.local_data["near_objects"] = self.local_data["near_robots"] = near
