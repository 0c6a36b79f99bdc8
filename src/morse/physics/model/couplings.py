"""Adds the tendons and constraints of armatures to the model of the engine."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.poses.poses import relative_pose
from morse.scene import is_dynamic
from morse.scene.couplings import ConstraintKind, WrapKind

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.physics.model.compile import Slot
    from morse.physics.model.layout import Frame
    from morse.scene import Node
    from morse.scene.couplings import Constraint, Tendon, TendonMotor, Wrap

_EQUALITIES = {
    ConstraintKind.CONNECT: mujoco.mjtEq.mjEQ_CONNECT,
    ConstraintKind.WELD: mujoco.mjtEq.mjEQ_WELD,
    ConstraintKind.JOINT: mujoco.mjtEq.mjEQ_JOINT,
    ConstraintKind.TENDON: mujoco.mjtEq.mjEQ_TENDON,
}
_OBJECTS = {
    ConstraintKind.CONNECT: mujoco.mjtObj.mjOBJ_BODY,
    ConstraintKind.WELD: mujoco.mjtObj.mjOBJ_BODY,
    ConstraintKind.JOINT: mujoco.mjtObj.mjOBJ_JOINT,
    ConstraintKind.TENDON: mujoco.mjtObj.mjOBJ_TENDON,
}


@dataclass(eq=False, slots=True)
class TendonSlot:
    """A motor of a tendon in the arrays of the engine.

    Attributes:
        armature: name of the node.
        start: initial command.
        actuator, tendon: ids.
    """

    armature: str
    motor: TendonMotor
    start: float = 0.0
    actuator: int = -1
    tendon: int = -1

    @property
    def key(self) -> tuple[str, str]:
        """What identifies the motor in the world."""
        return self.armature, self.motor.name


@dataclass(slots=True)
class _Place:
    """A link: its body in the engine, and its pose there."""

    slot: Slot
    body: Any
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

    Attributes:
        motors: of tendons.
        geoms: shapes that only guide tendons, with their nodes.
    """

    def __init__(self, spec: Any, slots: Sequence[Slot], bodies: Mapping[Frame, Any]) -> None:
        self._spec, self._bodies = spec, bodies
        self._slot_of = {node: slot for slot in slots for node in slot.frame.members}
        self.motors: list[TendonSlot] = []
        self.geoms: list[tuple[Any, Node]] = []
        for armature in self._slot_of:
            if armature.articulation is not None and armature.bones and is_dynamic(armature):
                self._add(armature)

    def _add(self, armature: Node) -> None:
        assert armature.articulation is not None
        couplings = armature.articulation.couplings
        links = {child.source_name or child.name: child for child in armature.children}
        for tendon in couplings.tendons:
            self._add_tendon(armature, links, tendon)
        for motor in couplings.motors:
            self._add_motor(armature, motor)
        for number, constraint in enumerate(couplings.constraints):
            self._add_constraint(armature, links, constraint, number)

    def _place(self, armature: Node, links: Mapping[str, Node], name: str) -> _Place:
        # a world without shapes is no link
        node = links.get(name, armature)
        slot = self._slot_of[node]
        return _Place(slot, self._bodies[slot.frame], *relative_pose(node, slot.pose))

    # -- tendons ---------------------------------------------------------------------------

    def _add_tendon(self, armature: Node, links: Mapping[str, Node], tendon: Tendon) -> None:
        name = _tendon_name(armature, tendon.name)
        element = self._spec.add_tendon(
            name=name,
            limited=tendon.limits is not None,
            frictionloss=tendon.friction,
            armature=tendon.inertia,
            springlength=tendon.rest,
            solref_limit=tendon.solver[:2],
            solimp_limit=tendon.solver[2:],
        )
        element.stiffness[0], element.damping[0] = tendon.stiffness, tendon.damping
        if tendon.limits is not None:
            element.range = tendon.limits
        for number, wrap in enumerate(tendon.path):
            if wrap.kind is WrapKind.JOINT:
                element.wrap_joint(f"{armature.name}/{wrap.name}", wrap.value)
            elif wrap.kind is WrapKind.PULLEY:
                element.wrap_pulley(wrap.value)
            elif wrap.kind is WrapKind.SITE:
                element.wrap_site(self._site(armature, links, wrap.name, wrap.position, f"{name}/{number}"))
            else:
                side = "" if wrap.side is None else self._site(armature, links, *wrap.side, f"{name}/{number} side")
                element.wrap_geom(self._guide(armature, links, wrap, f"{name}/{number}"), side)

    def _site(self, armature: Node, links: Mapping[str, Node], link: str, position: Sequence[float], name: str) -> str:
        place = self._place(armature, links, link)
        place.body.add_site(name=name, pos=place.point(position))
        return name

    def _guide(self, armature: Node, links: Mapping[str, Node], wrap: Wrap, name: str) -> str:
        """Add a shape without mass and contacts, over which a tendon runs."""
        place = self._place(armature, links, wrap.name)
        is_sphere = wrap.kind is WrapKind.SPHERE
        geom = place.body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE if is_sphere else mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[wrap.value, wrap.value, 0.0],
            pos=place.point(wrap.position),
            quat=_turned(place.rotation, wrap.quaternion),
            mass=0.0,
            contype=0,
            conaffinity=0,
        )
        self.geoms.append((geom, links.get(wrap.name, armature)))
        return name

    def _add_motor(self, armature: Node, motor: TendonMotor) -> None:
        element = self._spec.add_actuator(
            name=_tendon_name(armature, f"{motor.tendon}/{motor.name}"),
            target=_tendon_name(armature, motor.tendon),
            trntype=mujoco.mjtTrn.mjTRN_TENDON,
        )
        element.gear[0] = motor.gear
        element.dyntype, element.gaintype = mujoco.mjtDyn.mjDYN_NONE, mujoco.mjtGain.mjGAIN_FIXED
        element.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        element.gainprm[0] = motor.gain
        element.biasprm[:3] = motor.bias
        if math.isfinite(motor.force):
            element.forcelimited, element.forcerange = True, [-motor.force, motor.force]
        self.motors.append(TendonSlot(armature.name, motor))

    # -- constraints -----------------------------------------------------------------------

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
        elif kind is ConstraintKind.JOINT:
            names = [f"{armature.name}/{name}" if name else "" for name in names]
        else:
            names = [_tendon_name(armature, name) if name else "" for name in names]
        element = self._spec.add_equality(
            name=f"{armature.name}/constraint {number}",
            type=_EQUALITIES[kind],
            objtype=_OBJECTS[kind],
            name1=names[0],
            name2=names[1],
            active=constraint.is_active,
            solref=constraint.solver[:2],
            solimp=constraint.solver[2:],
        )
        element.data = data

    def resolve(self, model: mujoco.MjModel) -> None:
        """Store the ids that the compiler has assigned, and the initial commands."""
        for slot in self.motors:
            motor, armature = slot.motor, slot.armature
            slot.actuator = model.actuator(f"{armature}/tendon {motor.tendon}/{motor.name}").id
            slot.tendon = model.tendon(f"{armature}/tendon {motor.tendon}").id
            if motor.bias[1] and motor.gain:
                # the command with which it holds its present length
                length = motor.gear * float(model.tendon_length0[slot.tendon])
                slot.start = -(motor.bias[0] + motor.bias[1] * length) / motor.gain
            slot.start = min(max(slot.start, motor.commands[0]), motor.commands[1])


def _tendon_name(armature: Node, name: str) -> str:
    return f"{armature.name}/tendon {name}"


def _matrix(quaternion: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.array(quaternion, dtype=np.float64))
    return rotation.reshape(3, 3)


def _quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    return quaternion


def _turned(rotation: NDArray[np.float64], quaternion: Sequence[float]) -> NDArray[np.float64]:
    return _quaternion(matmul(rotation, _matrix(quaternion)))
