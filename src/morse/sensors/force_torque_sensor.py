"""The force and the torque in a joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.rows.marks import on_read
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind
from morse.mathutils.rotations import turn_back

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body
    from morse.core.world.body import JointMoment


class ForceTorqueSensor(Sensor):
    """Measures the force and the torque in the joint that carries its link: ``robot.append(sensor, "hand")``.

    They are those that the link, with all that it carries and touches, exerts on the rest of the robot: a load of 1 kg
    that hangs from the link adds 9.81 N downward. The torque is about the position of the sensor; both have its axes.
    The joint may be fixed, as those of real wrists and ankles are: it is measured as any other. Without a joint, on the
    first link of a robot that moves freely, or in a robot without dynamic joints, it measures 0.
    """

    _name = "Force/Torque Sensor"
    _short_desc = "A sensor that measures the force and the torque in the joint that carries a link, such as a wrist"
    _source = "Featherstone, Rigid Body Dynamics Algorithms (2008): recursive Newton-Euler, by MuJoCo"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.02, 0.02, 0.01), (0.2, 0.6, 0.9)))

    add_data("force", [0.0, 0.0, 0.0], "vec3<float>", "Force", unit="N", frame="own", shape=3)
    add_data("torque", [0.0, 0.0, 0.0], "vec3<float>", "Torque", unit="N·m", frame="own", shape=3)
    add_kind("wrench", force="force", torque="torque")

    #: the physics gives its link a body of its own
    measures_joint = True

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        if not self.context.world.joint_moment([obj]).is_carried(obj):
            text = (
                f"{self.name()}: no joint of the physics carries it, and it measures 0: append it to a link of an arm"
            )
            self.context.complaints.warn(text, text)

    @classmethod
    def observe_all(cls, sensors: Sequence[ForceTorqueSensor]) -> JointMoment:
        """Return the present loads of the joints."""
        return sensors[0].context.world.joint_moment([sensor.bge_object for sensor in sensors])

    @on_read
    def measure(self) -> None:
        """Measure force and torque."""
        position, rotation = self.position_3d.get_pose()
        force, torque = self.observation().load(self.bge_object, position)
        self.local_data["force"] = list(turn_back(rotation, force))
        self.local_data["torque"] = list(turn_back(rotation, torque))
