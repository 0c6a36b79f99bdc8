"""The joints of an MJCF model as the bones of an armature."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.robot_nodes import joint_bone
from morse.mathutils import Matrix, Quaternion, Vector
from morse.scene import Control, JointDynamics, JointKind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.assets.mjcf.model import BodyData, JointData, ModelData, MotorData
    from morse.scene import Bone

#: range of joints without limits, rad or m
_ENDLESS = 1e4
_KINDS = {"slide": JointKind.PRISMATIC, "hinge": JointKind.REVOLUTE, "ball": JointKind.BALL}


def pose(position: Iterable[float], quaternion: Iterable[float]) -> Matrix:
    """Return the 4x4 of a pose; the quaternion is w, x, y, z."""
    result: Matrix = Quaternion(tuple(quaternion)).to_matrix().to_4x4()
    result.translation = tuple(position)
    return result


class Bones:
    """Makes the bones of a model.

    Attributes:
        bones: parents before their children.
        places: 4x4 of each body in the model when all joints have the values of the file.
        hung: body to the index of the bone that carries it, -1 for none, and its 4x4 in the frame of the bone.
        motors: joint to the name of its motor.
        warnings: differences from the file, one sentence each.
    """

    def __init__(self, model: ModelData, bodies: list[int], base: int | None = None) -> None:
        self._model = model
        self.bones: list[Bone] = []
        self.places: dict[int, Matrix] = {0: Matrix.Identity(4)}
        self.hung: dict[int, tuple[int, Matrix]] = {}
        self.motors: dict[str, str] = {}
        self.warnings: list[str] = []
        self._frames: list[Matrix] = []
        self._bone_of: dict[int, int] = {}
        for index in bodies:
            body = model.bodies[index]
            # the free body is the origin
            here = Matrix.Identity(4) if index == base else pose(body.position, body.quaternion)
            self.places[index] = self.places[body.parent] @ here
            self._add(index, body)
        self._let_follow()

    def _add(self, index: int, body: BodyData) -> None:
        above = self.hung[body.parent][0] if body.parent in self.hung else -1
        last = above
        for number in body.joints:
            joint = self._model.joints[number]
            if joint.kind == "ball":
                last = self._bone(index, joint.name, joint, (0.0, 0.0, 1.0), number, last)
            elif joint.kind in ("hinge", "slide"):
                last = self._bone(index, joint.name, joint, joint.axis, number, last)
        if not body.joints and last >= 0:
            # a link that does not move relative to its parent belongs to the same bone
            last = above
        frame = self._frames[last] if last >= 0 else Matrix.Identity(4)
        self.hung[index] = (last, frame.inverted() @ self.places[index])

    def _bone(self, body: int, name: str, joint: JointData, axis: tuple[float, ...], number: int, parent: int) -> int:
        place = self.places[body]
        rotation = Vector((0.0, 0.0, 1.0)).rotation_difference(Vector(axis)).to_matrix().to_4x4()
        frame = place @ Matrix.Translation(joint.position) @ rotation
        self._frames.append(frame)
        # the pose of a bone is that at joint value 0
        if joint.kind == "slide":
            frame = frame @ Matrix.Translation((0.0, 0.0, -joint.start))
        elif joint.start:
            frame = frame @ Matrix.Rotation(-joint.start, 4, "Z")
        local = frame if parent < 0 else self._frames[parent].inverted() @ frame
        limits = joint.limits or (-_ENDLESS, _ENDLESS)
        low, high = (min(max(value, -_ENDLESS), _ENDLESS) for value in limits)
        kind = _KINDS[joint.kind]
        index = len(self.bones)
        dynamics = self._dynamics(number, joint)
        self.bones.append(joint_bone(name, parent, local, kind, (low, high), joint.start, dynamics))
        self._bone_of.setdefault(number, index)
        return index

    # -- motors ----------------------------------------------------------------------------

    def _dynamics(self, number: int, joint: JointData) -> JointDynamics:
        motor = next((one for one in self._model.motors if one.joint == number and one.gear and one.is_direct), None)
        if motor is not None:
            self.motors[joint.name] = motor.name
        control, gain, slowing, effort = _drive(motor)
        return JointDynamics(
            damping=max(joint.damping, 0.0),
            friction=max(joint.friction, 0.0),
            inertia=max(joint.inertia, 0.0),
            stiffness=max(joint.stiffness, 0.0),
            rest=joint.rest,
            effort=min(effort, joint.effort) or math.inf,
            limited=joint.limits is not None,
            control=control,
            gain=gain,
            slowing=slowing,
        )

    def _let_follow(self) -> None:
        leaders: set[int] = set()
        for joint, other, factor, offset in self._model.follows:
            follower, leader = self._bone_of.get(joint), self._bone_of.get(other)
            if follower is None or leader is None:
                continue
            name = self.bones[follower].name
            if follower in leaders or self.bones[leader].leader >= 0 or follower == leader:
                self.warnings.append(
                    f"the joint '{name}' cannot follow '{self.bones[leader].name}'; it moves by itself"
                )
                continue
            leaders.add(leader)
            self.bones[follower] = replace(
                self.bones[follower], leader=leader, factor=factor, offset=offset, starts_apart=True
            )


def _drive(motor: MotorData | None) -> tuple[Control, float | None, float | None, float]:
    """Return the quantity that a motor controls, its gain and damping, and its largest effort, at the joint."""
    if motor is None:
        return Control.EFFORT, None, None, math.inf
    gear, most = abs(motor.gear), abs(motor.gear) * motor.force
    stiffness, slowing = -motor.bias[1] * gear * gear, -motor.bias[2] * gear * gear
    if stiffness > 0.0:
        return Control.POSITION, stiffness, max(slowing, 0.0), most
    if slowing > 0.0:
        return Control.VELOCITY, slowing, None, most
    return Control.EFFORT, None, None, min(most, gear * abs(motor.gain) * motor.control)
