"""Adds the joints of armatures to the model of the engine: their masses, limits and motors."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import det, eigh, matmul
from morse.physics.model.couplings import stiff
from morse.physics.model.layout import Motion
from morse.physics.model.motors import Loads, Motor, root_of
from morse.physics.model.shapes import mass_of, moved_inertia
from morse.physics.poses.rigid import as_array, relative_pose
from morse.scene import Articulation, JointDynamics, JointKind, controls_of
from morse.scene.articulation import BonePose, start_frames, start_value
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.physics.model.layout import Frame
    from morse.scene import Bone, Node
    from morse.scene.frames import RigidFrame

#: smallest mass, kg, and moment of inertia, kg m^2, of a link that a joint moves
_LIGHTEST, _SMALLEST = 1e-3, 1e-6
_NOWHERE, _UPRIGHT = np.zeros(3), np.eye(3)
_NOTHING = JointDynamics()
_HINGE, _SLIDE, _BALL = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_BALL
_TYPES = {JointKind.REVOLUTE: _HINGE, JointKind.PRISMATIC: _SLIDE}
#: the joints of the engine for a bone without a value: suffix of the name, type, axis of the bone
_LOOSE = {
    JointKind.BALL: (("", _BALL, 2),),
    JointKind.PLANAR: (("/x", _SLIDE, 0), ("/y", _SLIDE, 1), ("/turn", _HINGE, 2)),
    JointKind.FLOATING: (("/x", _SLIDE, 0), ("/y", _SLIDE, 1), ("/z", _SLIDE, 2), ("/turn", _BALL, 2)),
}


@dataclass(eq=False, slots=True)
class JointSlot:
    """The indices of a joint in the arrays of the engine.

    Attributes:
        armature: the node of the armature.
        name: name of the bone.
        qpos: address of its value, rad or m.
        dof: address of its velocity.
        actuator: id of its motor; -1 for a joint that follows another.
        start: initial value of the joint.
        motor: None for a joint that follows another, or has none.
        width: number of position values in the engine: 4 for a ball joint, otherwise 1.
    """

    armature: Node
    name: str
    qpos: int = -1
    dof: int = -1
    actuator: int = -1
    start: float = 0.0
    motor: Motor | None = None
    width: int = 1

    @property
    def dofs(self) -> int:
        """The number of velocity values in the engine."""
        return 3 if self.width == 4 else 1


@dataclass(eq=False, slots=True)
class AddedJoint:
    """A joint that was added, for the parts that need all joints of an armature."""

    frame: Frame
    bone: Bone
    slot: JointSlot
    joint: mujoco.MjsJoint
    anchor: NDArray[np.float64]
    limit: JointDynamics
    of_file: bool = False


@dataclass(eq=False, slots=True)
class Group:
    """A frame with its body in the engine, its mass (kg), centre of mass (3, world, m), largest moment and joints."""

    frame: Frame
    body: Body
    mass: float
    centre: NDArray[np.float64]
    moment: float = 0.0
    joints: list[AddedJoint] = field(default_factory=list)


class Articulated:
    """The joints of all armatures of a scene whose joints the physics moves."""

    def __init__(self, spec: mujoco.MjSpec, frames: Sequence[Frame]) -> None:
        self._spec, self._frames = spec, frames
        self._shares: dict[Frame, float] = {}
        self._groups: dict[Frame, Group] = {}
        self._made: list[AddedJoint] = []
        #: poses of the bones at the start, by armature: all frames of an armature need them
        self._starts: dict[Node, list[BonePose]] = {}

    # -- masses ----------------------------------------------------------------------------

    def set_inertia(self, frame: Frame, pose: RigidFrame, body: mujoco.MjsBody, *, of_file: bool = False) -> bool:
        """Set mass and inertia of a body from its links; return False if the model of the frame has no links.

        Args:
            of_file: whether the body has those of its MJCF file.
        """
        links = [node for node in frame.members if node.inertial is not None]
        is_root = frame.motion is not Motion.JOINT
        has_links = frame.node.articulation is not None and (frame.carries or is_single_link(frame))
        if is_root and (frame.motion is not Motion.FREE or not has_links):
            self._groups[frame] = Group(frame, body, frame.node.body.mass, np.array(pose.position))
            return False
        scale = _scale(frame)
        parts: list[tuple[float, NDArray[np.float64], NDArray[np.float64]]] = []
        for node in links:
            position, rotation = relative_pose(node, pose)
            inertial = node.inertial
            assert inertial is not None
            inertia = matmul(matmul(rotation, np.reshape(inertial.inertia, (3, 3))), rotation.T)
            parts.append(
                (
                    scale * inertial.mass,
                    position + matmul(rotation, np.array(inertial.centre)),
                    scale * inertia,
                )
            )
        if not any(mass for mass, _, _ in parts) and not _has_masses(frame):
            share = self._share_of_volume(frame)
            parts = [
                (share * m, c, share * i)
                for node in frame.solid
                for m, c, i in (mass_of(shape, *relative_pose(node, pose)) for shape in node.shapes or ())
            ]
        mass = sum((part[0] for part in parts), 0.0)
        if mass < _LIGHTEST:
            mass, centre = _LIGHTEST, np.zeros(3)
            inertia = np.eye(3) * _SMALLEST
        else:
            centre = sum((m * c for m, c, _ in parts), np.zeros(3)) / mass
            inertia = sum((moved_inertia(i, m, c - centre) for m, c, i in parts), np.zeros((3, 3)))
        moments, axes = eigh(inertia)
        if det(axes) < 0.0:
            axes[:, 0] *= -1.0
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(axes).ravel())
        # invalid files, and rounding: no moment may exceed the sum of the others
        moments = np.maximum(moments, _SMALLEST * min(mass, 1.0))
        moments[:2] += max(0.0, 0.5 * (1.001 * moments[2] - moments[0] - moments[1]))
        if not of_file:
            body.explicitinertial = True
            body.mass, body.ipos, body.iquat, body.inertia = mass, centre, quaternion, moments
        place = np.array(pose.position) + matmul(as_array(pose.rotation), centre)
        self._groups[frame] = Group(frame, body, float(mass), place, float(np.max(moments)))
        return True

    def _share_of_volume(self, frame: Frame) -> float:
        """The factor between the mass of a shape and that of water: a robot without masses in its file has its own."""
        root = root_of(frame)
        if root.node.articulation is None:
            return 1.0
        if root not in self._shares:
            solid = (node for one in self._frames if root_of(one) is root for node in one.solid)
            total = sum(mass_of(shape, _NOWHERE, _UPRIGHT)[0] for node in solid for shape in node.shapes or ())
            self._shares[root] = root.node.body.mass / total if total else 1.0
        return self._shares[root]

    # -- joints ----------------------------------------------------------------------------

    def add_joints(
        self, frame: Frame, pose: RigidFrame, body: mujoco.MjsBody, *, of_file: bool = False
    ) -> list[JointSlot]:
        """Add the joints that move a frame, or take those of an MJCF file."""
        armature = frame.armature
        assert armature is not None
        outer = rigid_frame(armature)
        scale = sum(float(outer.stretch[i][i]) for i in range(3)) / 3.0
        bones, frames = armature.bones, self._starts.get(armature)
        if frames is None:
            frames = self._starts[armature] = start_frames(bones, scale)
        base, base_rotation = np.array(outer.position), as_array(outer.rotation)
        origin, rotation = np.array(pose.position), as_array(pose.rotation)
        joints = []
        for index in frame.joints:
            bone = bones[index]
            if bone.kind is JointKind.FIXED:
                continue
            place, axes = frames[index]
            anchor = base + matmul(base_rotation, np.array(place))
            axis = matmul(base_rotation, np.reshape(axes, (3, 3))[:, bone.axis])
            if of_file:
                joints.append(self._take(frame, bone, start_value(bones, index), anchor))
                continue
            if bone.kind.is_loose:
                turned_bone = matmul(matmul(rotation.T, base_rotation), np.reshape(axes, (3, 3)))
                joints += self._add_loose(frame, bone, body, anchor, matmul(rotation.T, anchor - origin), turned_bone)
                continue
            slides = bone.kind is JointKind.PRISMATIC
            value = start_value(bones, index) * (scale if slides else 1.0)
            limit = bone.dynamics or _NOTHING
            name = f"{armature.name}/{bone.name}"
            joint = body.add_joint(
                type=_TYPES[bone.kind],
                name=name,
                pos=matmul(rotation.T, anchor - origin),
                axis=matmul(rotation.T, axis),
                ref=value,
                armature=limit.inertia,
                frictionloss=limit.friction,
            )
            joint.damping[0] = limit.damping
            if limit.stiffness:
                joint.stiffness[0], joint.springref = limit.stiffness, limit.rest
            low, high = (bone.low * scale, bone.high * scale) if slides else (bone.low, bone.high)
            joint.limited = limit.limited and bone.leader < 0 and low <= high
            joint.range = [low, high] if low < high else [low - 1e-6, low + 1e-6]
            slot = JointSlot(armature, bone.name)
            slot.start = value
            entry = AddedJoint(frame, bone, slot, joint, anchor, limit)
            self._made.append(entry)
            self._groups[frame].joints.append(entry)
            joints.append(slot)
        return joints

    def _take(self, frame: Frame, bone: Bone, start: float, anchor: NDArray[np.float64]) -> JointSlot:
        """Return the slot of a joint that comes from an MJCF file."""
        armature = frame.armature
        assert armature is not None
        slot = JointSlot(armature, bone.name, start=start, width=4 if bone.kind is JointKind.BALL else 1)
        joint = self._spec.joint(f"{armature.name}/{bone.name}")
        entry = AddedJoint(frame, bone, slot, joint, anchor, bone.dynamics or _NOTHING, of_file=True)
        self._made.append(entry)
        self._groups[frame].joints.append(entry)
        return slot

    def _add_loose(
        self,
        frame: Frame,
        bone: Bone,
        body: mujoco.MjsBody,
        anchor: NDArray[np.float64],
        place: NDArray[np.float64],
        axes: NDArray[np.float64],
    ) -> list[JointSlot]:
        """Add the joints of a bone without a value.

        Args:
            anchor: the joint in the world, m.
            place, axes: the joint, m, and the axes of the bone as columns, both in the frame of the body.
        """
        armature = frame.armature
        assert armature is not None
        limit, joints = bone.dynamics or _NOTHING, []
        for suffix, kind, axis in _LOOSE[bone.kind]:
            joint = body.add_joint(
                type=kind,
                name=f"{armature.name}/{bone.name}{suffix}",
                pos=place,
                axis=axes[:, axis],
                armature=limit.inertia,
                frictionloss=limit.friction,
            )
            joint.damping[0] = limit.damping
            if limit.stiffness and kind == _BALL:
                joint.stiffness[0] = limit.stiffness
            if kind == _BALL and limit.limited and bone.high > 0.0:
                joint.limited, joint.range = True, [0.0, bone.high]
            slot = JointSlot(armature, f"{bone.name}{suffix}", width=4 if kind == _BALL else 1)
            entry = AddedJoint(frame, bone, slot, joint, anchor, limit)
            self._made.append(entry)
            self._groups[frame].joints.append(entry)
            joints.append(slot)
        return joints

    # -- after all bodies --------------------------------------------------------------------

    def finish(self, step: float) -> None:
        """Add motors, joints that follow others, and the pairs of links that do not collide.

        Args:
            step: time step of the engine, s.
        """
        if not self._made:
            return
        by_name = {(entry.slot.armature, entry.bone.name): entry for entry in self._made}
        leaders: dict[JointSlot, AddedJoint] = {}
        for entry in self._made:
            armature = entry.slot.armature
            if entry.bone.leader >= 0 and (leader := by_name.get((armature, armature.bones[entry.bone.leader].name))):
                leaders[entry.slot] = leader
        loads = Loads(self._groups)
        for entry in self._made:
            armature = entry.slot.armature
            if entry.bone.kind.is_loose:
                continue
            if entry.slot in leaders:
                if not entry.of_file:
                    self._follow(entry, leaders[entry.slot])
                continue
            motor = self._spec.add_actuator(
                name=entry.joint.name, target=entry.joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT
            )
            entry.slot.motor = Motor(entry.limit, loads.of(entry, slides=entry.bone.kind is JointKind.PRISMATIC), step)
            entry.slot.motor.add_to(motor, entry.joint, controls_of(armature)[entry.bone.name])
        of_files = {root_of(entry.frame) for entry in self._made if entry.of_file}
        for root in {root_of(frame): None for frame in self._groups if frame.motion is Motion.JOINT}:
            if root not in of_files:
                self._keep_apart(root)

    def _follow(self, entry: AddedJoint, leader: AddedJoint) -> None:
        equality = self._spec.add_equality(
            name=entry.joint.name,
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=entry.joint.name,
            name2=leader.joint.name,
        )
        data = np.zeros(equality.data.shape)
        # both are at their initial values when the constraint is fulfilled
        data[1] = entry.bone.factor
        equality.data = data
        equality.solref, equality.solimp = stiff(float(self._spec.option.timestep))

    def _keep_apart(self, root: Frame) -> None:
        """Disable collisions between links of one robot, unless the file enables them."""
        frames = [frame for frame in self._groups if root_of(frame) is root]
        names = {frame: {node.source_name or node.name for node in frame.members} for frame in frames}
        for number, one in enumerate(frames):
            for other in frames[number + 1 :]:
                if not (one.solid and other.solid):
                    continue
                settings = [f.armature.articulation for f in (one, other) if f.armature is not None]
                collides = all(setting is not None and setting.self_collision for setting in settings)
                is_excluded = any(
                    (a in names[one] and b in names[other]) or (b in names[one] and a in names[other])
                    for setting in settings
                    if setting is not None
                    for a, b in setting.apart
                )
                if not collides or is_excluded or one.parent is other or other.parent is one:
                    self._spec.add_exclude(
                        bodyname1=self._groups[one].body.name, bodyname2=self._groups[other].body.name
                    )

    def resolve(self, model: mujoco.MjModel) -> None:
        """Store the ids that the compiler has assigned."""
        for entry in self._made:
            joint = model.joint(entry.joint.name).id
            entry.slot.qpos, entry.slot.dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
            entry.slot.actuator = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, entry.joint.name)


def is_single_link(frame: Frame) -> bool:
    """Whether a body is a model with the mass of a link, and without joints."""
    if frame.motion is not Motion.FREE or frame.carries or frame.node.articulation is None:
        return False
    return any(node.inertial is not None and node.inertial.mass > 0.0 for node in frame.members)


def _has_masses(frame: Frame) -> bool:
    """Whether the file of the armature of a frame has masses."""
    armature = frame.armature if frame.armature is not None else frame.node
    return bool((armature.articulation or Articulation()).mass)


def _scale(frame: Frame) -> float:
    """Return the factor between the mass of a robot in the scene and in its file."""
    root = root_of(frame).node
    in_file = root.articulation.mass if root.articulation is not None else 0.0
    return root.body.mass / in_file if in_file and abs(root.body.mass - in_file) > 1e-9 * in_file else 1.0


def carried(frames: Iterable[Frame]) -> dict[Frame, Frame]:
    """Return the root of each joint frame."""
    return {frame: root_of(frame) for frame in frames if frame.motion is Motion.JOINT}
