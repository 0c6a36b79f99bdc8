"""The posture of a person in one message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.declarations import BuilderDefaults
from morse.core.limits import POSITION
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind, euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: numbers of the first and the last joint
_FIRST, _LAST = 12, 49
_JOINTS = tuple(f"dof_{number}" for number in range(_FIRST, _LAST + 1))


class HumanPosture(Sensor):
    """Measures where a person is and how the person holds the joints; append it to a `Human`.

    The message has the fields of MORSE 1.4: ``x`` to ``roll`` is the pose of the person in the world, ``empty1`` to
    ``empty6`` are 0, and ``dof_12`` to ``dof_49`` are joints. The skeleton of 1.4 is no longer part of MORSE:
    ``dof_12`` is the first joint of ``human.skeleton``, in the order of its service ``get_joints``, and so on; the
    fields behind the last joint are 0.
    """

    _name = "Human posture"
    _short_desc = "Measures the pose and the joints of a person"
    _builder = BuilderDefaults()

    for _field in ("x", "y", "z"):
        add_data(_field, 0.0, "float", "Position of the person", frame="world", **POSITION)
    for _field in ("yaw", "pitch", "roll"):
        add_data(_field, 0.0, "float", "Rotation of the person", unit="rad", frame="world", angle=True)
    for _number in range(1, 7):
        add_data(f"empty{_number}", 0.0, "float", "Always 0", low=0.0, high=0.0)
    for _field in _JOINTS:
        add_data(_field, 0.0, "float", "Angle of a joint of the skeleton", unit="rad", frame="joint")
    add_kind("joints", names=_JOINTS, position=_JOINTS)
    add_kind("pose", topic="pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        names = (
            [] if parent is None else [child.name for child in parent.bge_object.childrenRecursive if child.node.bones]
        )
        if not names:
            raise ValueError(
                "it measures the skeleton of a person: append it to a Human, as in 'human.append(posture)'"
            )
        self._skeleton: str = names[0]

    def measure(self) -> None:
        """Measure pose and joints."""
        assert self.robot_parent is not None
        pose = self.robot_parent.position_3d
        self.local_data.update(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw, pitch=pose.pitch, roll=pose.roll)
        skeleton: Any = self.context.components[self._skeleton]
        self.local_data.update(zip(_JOINTS, map(float, skeleton.joint_values), strict=False))
