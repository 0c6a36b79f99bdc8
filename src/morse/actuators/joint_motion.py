"""The base class of actuators that move the joints of an armature towards setpoints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.actuator import Actuator
from morse.core.declarations import DataField, add_state
from morse.core.parts.link_parts import link_parts
from morse.helpers.chain import Chain
from morse.mathutils.rotations import product, turn_back
from morse.scene import JointKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.parts.moving_parts import MovingPart
    from morse.core.robot import Robot
    from morse.core.world import Body


class JointMotion(Actuator):
    """Moves the joints of its armature, and the objects that are attached to the bones.

    ``local_data`` contains the setpoint of each joint. Joints stay within their limits.
    """

    add_state("_values", list, "Joint values of the last action")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        node = obj.node
        if not node.bones:
            raise ValueError(
                f"'{node.plain_name}' has no bones: an armature is an object of the type Armature in Blender whose "
                "bones have unlocked axes (Bone > Inverse Kinematics)"
            )
        stretch = rigid_frame(node).stretch
        self.chain = Chain(node.bones, sum(float(stretch[i][i]) for i in range(3)) / 3.0)
        self._values = list(self.chain.start)
        self.local_data.update(zip(self.chain.names, self._values, strict=True))
        #: the last setpoints, and the clamped setpoints
        self._told: list[Any] = []
        self._limits = [(low, high) for _, low, high in self.chain.limits]
        self._told_bounds: Sequence[tuple[float, float]] = self._limits
        self._clamped: list[float] = []
        self._linkage = self.context.world.linkage(obj, self.chain.linked, list(self._hanging(obj)))

    @property
    def own_fields(self) -> Mapping[str, DataField]:
        """Return one field for each joint."""
        fields = {}
        for index in self.chain.joints:
            bone = self.chain.bones[index]
            turns = bone.kind is JointKind.REVOLUTE
            fields[bone.name] = DataField(
                bone.value,
                "float",
                f"{'Angle' if turns else 'Displacement'} to move to, from {bone.low:g} to {bone.high:g}",
                unit="rad" if turns else "m",
                frame="joint",
                low=-1e6,
                high=1e6,
            )
        return fields

    @property
    def joints(self) -> tuple[str, ...]:
        """The names of the joints, from the root to the tips."""
        return self.chain.names

    @property
    def joint_values(self) -> tuple[float, ...]:
        """The present joint values, rad or m."""
        return tuple(self._values)

    def moving_parts(self) -> list[MovingPart]:
        """The links of the armature, with the names of its file."""
        return link_parts(self.bge_object, self.chain, lambda: self.joint_values, self.context.components)

    def _hanging(self, obj: Any) -> Any:
        """The objects attached to bones: object, index of the bone, and its pose in the frame of the bone."""
        frames = self.chain.frames(self.chain.start)
        for child in obj.children:
            index = self.chain.index(child.node.bone) if child.node.bone else None
            if index is not None:
                (x, y, z), rotation = child.local_pose()
                (px, py, pz), r = frames[index]
                back = (r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8])
                yield child, index, turn_back(r, (x - px, y - py, z - pz)), product(back, tuple(rotation))

    def _wanted(self) -> list[float]:
        """Return the setpoints, clamped to the limits; the list must not be modified."""
        data = self.local_data
        targets = [data[name] for name in self.chain.names]
        bounds = self._bounds()
        if targets != self._told or bounds is not self._told_bounds:
            # most setpoints do not change for many ticks
            self._told, self._told_bounds = targets, bounds
            self._clamped = [
                low if value < low else high if value > high else value
                for value, (low, high) in zip(map(float, targets), bounds, strict=True)
            ]
        return self._clamped

    def _bounds(self) -> Sequence[tuple[float, float]]:
        """Return the limits of the setpoints; the same object as long as they are the same."""
        return self._limits

    def _move_to(self, values: Sequence[float]) -> None:
        """Set the joint values immediately, and move the attached objects."""
        if list(values) == self._values:
            return
        self._values = list(values)
        self._linkage.move(self.chain.bone_values(self._values))
