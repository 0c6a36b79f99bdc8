"""The place of a frame in the arrays of the engine."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from morse.physics.model.layout import Frame, Motion

if TYPE_CHECKING:
    from morse.physics.model.articulated import JointSlot
    from morse.scene import Node
    from morse.scene.frames import RigidFrame


@dataclass(eq=False, slots=True)
class Slot:
    """The indices of a frame in the arrays of the engine; -1 or empty if the frame has no such item.

    Attributes:
        body: id of the MuJoCo body; 0 for static shapes that belong to the world, at their poses in it.
        qpos: address of the free joint (7 numbers) or hinge (1).
        dof: address of its velocity (6 or 1).
        mocap: mocap id.
        actuator: id of the wheel motor.
        geoms: geom ids by node, one for each shape of the node.
        feet: geom ids of the spheres on which a driven robot stands.
        joints: the joints of a joint frame, the innermost first; ``qpos`` and ``dof`` are those of the first one.
    """

    frame: Frame
    pose: RigidFrame
    body: int = -1
    qpos: int = -1
    dof: int = -1
    mocap: int = -1
    actuator: int = -1
    geoms: dict[Node, list[int]] = field(default_factory=dict)
    feet: list[int] = field(default_factory=list)
    joints: list[JointSlot] = field(default_factory=list)

    @property
    def numbers(self) -> tuple[int, int]:
        """Number of positions and velocities of the slot in the engine."""
        if self.qpos < 0:
            return 0, 0
        if self.frame.motion is Motion.FREE:
            return 7, 6
        return sum(joint.width for joint in self.joints) or 1, sum(joint.dofs for joint in self.joints) or 1
