"""The forces of contacts on a link."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.rows.marks import on_read
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind
from morse.sensors.collision import touched_names

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.core.world.body import ContactMoment


class ContactForce(Sensor):
    """Measures what presses on the part of the robot to which it is appended, for example on a foot:
    ``robot.append(foot, "front_left_shin")``.

    The force is the sum of all contacts of the shapes of that part, and of the parts that are attached to it, with
    other objects and other parts of the robot. Appended to the robot itself, it measures the contacts of the whole
    robot. The forces on the feet of a robot at rest add up to its weight.
    """

    _name = "Contact Force"
    _short_desc = "A sensor that measures the force of contacts on a link, such as a foot"
    _source = "Contact forces of MuJoCo"
    _builder = BuilderDefaults(visual=Visual("cube", (0.01, 0.01, 0.01), (0.8, 0.2, 0.1)))

    add_data("touching", False, "bool", "Whether anything presses on it", follows="force")
    add_data("force", [0.0, 0.0, 0.0], "vec3<float>", "Sum of the forces on it", unit="N", frame="world", shape=3)
    add_data("objects", "", "string", "Names of the objects that press on it, joined by commas", follows="force")
    add_kind(
        "contact",
        touching="touching",
        names=touched_names,
        forces=lambda sensor: [list(sensor.local_data["force"])],
    )

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._part = obj.parent or obj

    @classmethod
    def observe_all(cls, sensors: Sequence[ContactForce]) -> ContactMoment:
        """Return the present contacts."""
        return sensors[0].context.world.contact_moment([sensor._part for sensor in sensors])

    @on_read
    def measure(self) -> None:
        """Measure the contacts."""
        pairs = self.observation().forces(self._part)
        data = self.local_data
        data["touching"] = bool(pairs)
        data["force"] = [sum((force[axis] for _, force in pairs), 0.0) for axis in range(3)]
        data["objects"] = ",".join(dict.fromkeys(other.name for other, _ in pairs))
