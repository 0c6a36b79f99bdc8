"""Adds the constraints of armatures to the model of the engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.restitution import stiff
from morse.physics.poses.poses import relative_pose
from morse.scene import is_dynamic
from morse.scene.articulation import ConstraintKind

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.physics.model.layout import Frame
    from morse.physics.model.slot import Slot
    from morse.scene import Node
    from morse.scene.articulation import Constraint

_EQUALITIES = {
    ConstraintKind.CONNECT: mujoco.mjtEq.mjEQ_CONNECT,
    ConstraintKind.WELD: mujoco.mjtEq.mjEQ_WELD,
    ConstraintKind.JOINT: mujoco.mjtEq.mjEQ_JOINT,
}
_OBJECTS = {
    ConstraintKind.CONNECT: mujoco.mjtObj.mjOBJ_BODY,
    ConstraintKind.WELD: mujoco.mjtObj.mjOBJ_BODY,
    ConstraintKind.JOINT: mujoco.mjtObj.mjOBJ_JOINT,
}


@dataclass(slots=True)
class _Place:
    """A link: its body in the engine, and its pose there."""

    slot: Slot
    body: Body
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]

    def point(self, local: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """A point of the link in the frame of the body."""
        point: NDArray[np.float64] = self.position + matmul(self.rotation, np.array(local))
        return point


class CouplingBuilder:
    """The couplings of all armatures of a scene.

    Args:
        spec: receives them.
        slots: of all frames.
        bodies: of the engine, by frame.
    """

    def __init__(self, spec: mujoco.MjSpec, slots: Sequence[Slot], bodies: Mapping[Frame, mujoco.MjsBody]) -> None:
        self._spec, self._bodies = spec, bodies
        self._slot_of = {node: slot for slot in slots for node in slot.frame.members}
        for armature in self._slot_of:
            if armature.articulation is not None and armature.bones and is_dynamic(armature):
                self._add(armature)

    def _add(self, armature: Node) -> None:
        assert armature.articulation is not None
        couplings = armature.articulation.couplings
        links = {child.source_name or child.name: child for child in armature.children}
        for number, constraint in enumerate(couplings.constraints):
            self._add_constraint(armature, links, constraint, number)

    def _place(self, armature: Node, links: Mapping[str, Node], name: str) -> _Place:
        # a world without shapes is no link
        node = links.get(name, armature)
        slot = self._slot_of[node]
        return _Place(slot, self._bodies[slot.frame], *relative_pose(node, slot.pose))

    def _add_constraint(self, armature: Node, links: Mapping[str, Node], constraint: Constraint, number: int) -> None:
        kind = constraint.kind
        data = np.zeros(12)
        data[: len(constraint.data)] = constraint.data[:12]
        names = [constraint.one, constraint.other]
        if kind in (ConstraintKind.CONNECT, ConstraintKind.WELD):
            one, other = (self._place(armature, links, name) for name in names)
            if one.body is other.body:
                return
            names = [one.body.name, other.body.name]
            first, second = (one, other) if kind is ConstraintKind.CONNECT else (other, one)
            data[:3], data[3:6] = first.point(data[:3]), second.point(data[3:6])
            if kind is ConstraintKind.WELD:
                # of the second body in the first one
                data[6:10] = _quaternion(matmul(matmul(one.rotation, _matrix(data[6:10])), other.rotation.T))
        else:
            names = [f"{armature.name}/{name}" if name else "" for name in names]
        solref: Sequence[float]
        solref, solimp = stiff(float(self._spec.option.timestep))
        if constraint.solver is not None:
            solref, solimp = constraint.solver[:2], constraint.solver[2:]
        element = self._spec.add_equality(
            name=f"{armature.name}/constraint {number}",
            type=_EQUALITIES[kind],
            objtype=_OBJECTS[kind],
            name1=names[0],
            name2=names[1],
            active=constraint.is_active,
            solref=solref,
            solimp=solimp,
        )
        element.data = data


def _matrix(quaternion: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.array(quaternion, dtype=np.float64))
    return rotation.reshape(3, 3)


def _quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    return quaternion
