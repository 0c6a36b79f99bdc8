"""People around a robot."""

from __future__ import annotations

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, add_property
from morse.plugins.people.robots.crowd import Crowd


class PeopleTracker(Sensor):
    """Measures the people of all crowds within a distance, as detectors and trackers of people do, without errors.

    The fields have the names of ``people_msgs/Person`` and ``hunav_msgs/Agent`` of ROS 2. With ``Occlusion``, people
    whose trunk is behind something else are left out.
    """

    _name = "PeopleTracker"
    _short_desc = "Measures positions and velocities of the people around a robot"
    _builder = BuilderDefaults(frequency=10.0)

    add_data(
        "people",
        [],
        "list<objects>",
        "Those within the range, the nearest first: name, id, group_id, position (m) and velocity (m/s) in the world, "
        "yaw (rad), radius (m), desired_velocity (m/s), state",
    )
    add_kind("people", records="people")
    add_property("_range", 20.0, "Range", "float", "Largest distance", unit="m", low=0.0, high=1e4)
    add_property("_occlusion", False, "Occlusion", "bool", "Leave out who is behind something else")

    _range: float
    _occlusion: bool

    def measure(self) -> None:
        """Measure who is near."""
        here = np.array(self.bge_object.world_pose()[0])
        found: list[tuple[float, str, dict[str, object]]] = []
        for crowd in self.context.robots.values():
            if not isinstance(crowd, Crowd):
                continue
            places = crowd.local_data["positions"]
            apart = np.sqrt(((places[:, :2] - here[:2]) ** 2).sum(axis=1))
            near = np.flatnonzero((apart <= self._range) & crowd.local_data["present"])
            for person in near[np.argsort(apart[near], kind="stable")].tolist():
                record = crowd.record(person)
                if not self._occlusion or self._sees(crowd, person):
                    found.append((float(apart[person]), str(record["name"]), record))
        found.sort(key=lambda one: one[:2])
        self.local_data["people"] = [record for _, _, record in found]

    def _sees(self, crowd: Crowd, person: int) -> bool:
        """Whether the line to the chest meets the person first."""
        trunk = crowd.trunk(person)
        x, y, z = trunk.world_pose()[0]
        height = float(crowd.gait.height[person])
        hit = self.bge_object.rayCast((x, y, z + 0.68 * height), None, 0.0)[0]
        return hit is None or hit.name == trunk.name
