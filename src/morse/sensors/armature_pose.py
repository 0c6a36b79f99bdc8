"""The joint values of an armature."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.declarations import BuilderDefaults, DataField
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import nearest, shown
from morse.core.rows.marks import present_data
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.core.values import Fields, Value
from morse.helpers.chain import Chain
from morse.helpers.components import add_kind, add_state, each, on_read
from morse.scene import JointKind

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body


_AT_START: dict[JointKind, tuple[float, ...]] = {
    JointKind.BALL: (1.0, 0.0, 0.0, 0.0),
    JointKind.PLANAR: (0.0, 0.0, 0.0),
    JointKind.FLOATING: (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
}


class ArmaturePose(Sensor):
    """Measures the joint values of the armature to which it is appended: ``arm.append(pose)``.

    It has a field for each joint: the angle of a revolute joint, the displacement of a prismatic joint. The
    velocities of
    dynamic joints and the efforts of their motors are in the slots ``velocity`` and ``effort`` of its messages, and
    returned by services.

    Joints without a motor that move in several directions have a field with several numbers: displacements along their
    axes (m), then an angle (rad, ``planar``) or a quaternion w, x, y, z (``floating``, ``ball``).
    """

    _name = "Armature Pose Sensor"
    _short_desc = "Measures the joint values of an armature"
    _builder = BuilderDefaults()

    add_kind(
        "joints",
        names=each("joints"),
        position=each("joints"),
        velocity=lambda sensor: sensor.velocities,
        effort=lambda sensor: sensor.efforts,
    )

    add_state("efforts", tuple | None, "Forces and torques of dynamic joints")
    add_state("velocities", tuple | None, "Velocities of dynamic joints")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        actuators = {component.name for component in self.context.scene.components if component.kind == "actuator"}
        holder = obj.parent
        while holder is not None and not (
            holder.node.bones and (holder.name in actuators or holder.joints() is not None)
        ):
            holder = holder.parent
        if holder is None:
            raise ValueError(
                "it measures the joints of an armature: append it to an armature, as in 'arm.append(pose)'"
            )
        self._armature: str = holder.name
        #: of joints that no armature component moves
        self._motors: Any = None if holder.name in actuators else holder.joints()
        chain = Chain(holder.node.bones)
        self._bones = tuple(chain.bones[index] for index in chain.joints)
        self._names = tuple(bone.name for bone in self._bones)
        self._loose = tuple(chain.bones[index] for index in chain.loose)
        self.local_data.update((bone.name, bone.value) for bone in self._bones)
        self.local_data.update((bone.name, list(_AT_START[bone.kind])) for bone in self._loose)
        #: rad/s or m/s, and N m or N, in the order of the joints; None unless the joints are dynamic
        self.velocities: tuple[float, ...] | None = None
        self.efforts: tuple[float, ...] | None = None

    @property
    def joints(self) -> tuple[str, ...]:
        """The names of the joints, ordered from the root."""
        return self._names

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """Return one field for each joint."""
        fields = {}
        for bone in self._bones:
            turns = bone.kind is JointKind.REVOLUTE
            fields[bone.name] = DataField(
                bone.value,
                "float",
                "Angle of the joint" if turns else "Displacement of the joint",
                unit="rad" if turns else "m",
                frame="joint",
                low=bone.low,
                high=bone.high,
            )
        for bone in self._loose:
            start = _AT_START[bone.kind]
            fields[bone.name] = DataField(
                list(start), "list", f"Position of the joint, {bone.kind}", shape=(len(start),), frame="joint"
            )
        return fields

    def observe(self) -> Value:
        """Return the present positions, velocities and efforts of the joints, and positions of joints with several.

        They are arrays, (J,) each. Unless the joints are dynamic, positions are a tuple, velocities and efforts None.
        """
        names, motors = self._names, self._motors
        if motors is not None:
            return *motors.measured(names), [motors.loose(bone.name)[0] for bone in self._loose]
        armature: Any = self.context.components[self._armature]
        state = getattr(armature, "joint_state", None)
        if state is None:
            return armature.joint_values, None, None, ()
        return *state, [armature.loose_joint(bone.name)[0] for bone in self._loose]

    @on_read
    def measure(self) -> None:
        """Measure the joint values."""
        data = self.local_data
        values, velocities, efforts, loose = self.observation()
        if velocities is None:
            data.update(zip(self._names, values, strict=True))
            return
        data.update(zip(self._names, values.tolist(), strict=True))
        self.velocities, self.efforts = tuple(velocities.tolist()), tuple(efforts.tolist())
        for bone, position in zip(self._loose, loose, strict=True):
            data[bone.name] = position or data[bone.name]

    def joint_places(self, fields: Sequence[str]) -> list[int] | None:
        """Return the numbers of the fields among the positions of the world; None if one is not among them."""
        motors = self._motors
        if motors is None:
            motors = getattr(self.context.components[self._armature], "motors", None)
        if motors is None or not set(fields) <= set(self._names):
            return None
        places: list[int] = motors.places(fields)
        return None if -1 in places else places

    @service(changes=False)
    def get_joints(self) -> list[str]:
        """The names of the joints, ordered from the root."""
        return list(self.joints)

    # the method has another name, because the method `get_state` of a component saves its state
    @service(name="get_state", changes=False)
    def get_joint_state(self) -> dict[str, float]:
        """Return the values of all joints: name to rad or m."""
        data = present_data(self)
        return {name: data[name] for name in self.joints}

    @service(changes=False)
    def get_joint(self, joint: str) -> float:
        """Return the value of a joint, rad or m."""
        self._check(joint)
        return float(present_data(self)[joint])

    @service(changes=False)
    def get_velocities(self) -> dict[str, float]:
        """Return the velocities of all joints: name to rad/s or m/s; empty unless the joints are dynamic."""
        present_data(self)
        return dict(zip(self.joints, self.velocities or (), strict=False))

    @service(changes=False)
    def get_efforts(self) -> dict[str, float]:
        """Return the efforts of the motors of all joints: name to N m or N; empty unless the joints are dynamic."""
        present_data(self)
        return dict(zip(self.joints, self.efforts or (), strict=False))

    @service(changes=False)
    def get_loose_joints(self) -> dict[str, Fields]:
        """Return the joints that move in several directions: name to ``type``, ``position`` and ``velocity``.

        Positions are displacements along the axes of the joint, m, then an angle, rad (``planar``), or a quaternion w,
        x, y, z (``floating``, ``ball``). Velocities are m/s and rad/s; they are empty unless the joints are dynamic.
        """
        data = present_data(self)
        return {
            bone.name: {
                "type": str(bone.kind),
                "position": list(data[bone.name]),
                "velocity": self._loose_velocity(bone.name),
            }
            for bone in self._loose
        }

    def _loose_velocity(self, name: str) -> list[float]:
        if self._motors is not None:
            return list(self._motors.loose(name)[1])
        armature: Any = self.context.components[self._armature]
        return list(armature.loose_joint(name)[1]) if getattr(armature, "is_dynamic", False) else []

    @service(changes=False)
    def get_joints_length(self) -> dict[str, float]:
        """Return the lengths of the bones of the joints: name to m."""
        return {bone.name: bone.length for bone in self._bones}

    def _check(self, joint: str) -> None:
        if joint not in self.joints:
            raise MorseRPCInvokationError(
                f"{self.name()}: there is no joint {shown(joint)}{nearest(joint, self.joints)}"
            )
