"""Actuators of MJCF files that are no motors of single joints: of tendons, muscles, and those with dynamics."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(eq=False, slots=True)
class FileMotor:
    """An actuator in the arrays of the engine.

    Attributes:
        armature: name of the node.
        name: name of the actuator; with the suffix ``_tendon`` or ``_motor`` if a joint has it.
        commands: smallest and largest command.
        start: initial command.
        actuator: id.
    """

    armature: str
    name: str
    commands: tuple[float, float]
    start: float
    actuator: int

    @property
    def key(self) -> tuple[str, str]:
        """What identifies the motor in the world."""
        return self.armature, self.name


def motors_of(model: mujoco.MjModel, armature: str) -> Iterator[FileMotor]:
    """Yield the actuators of an armature; those with position control at first hold their length."""
    prefix = f"{armature}/"
    joints = {model.joint(index).name for index in range(model.njnt)}
    for index in range(model.nu):
        full = model.actuator(index).name
        if not full.startswith(prefix) or full in joints:
            continue
        tendon = int(model.actuator_trntype[index]) == int(mujoco.mjtTrn.mjTRN_TENDON)
        name = full.removeprefix(prefix)
        name = name.removesuffix(SUFFIX)
        if full.removesuffix(SUFFIX) in joints:
            name += "_tendon" if tendon else "_motor"
        low, high = model.actuator_ctrlrange[index] if model.actuator_ctrllimited[index] else (-math.inf, math.inf)
        start, gain = 0.0, float(model.actuator_gainprm[index][0])
        if int(model.actuator_biastype[index]) == int(mujoco.mjtBias.mjBIAS_AFFINE) and gain:
            constant, stiffness = model.actuator_biasprm[index][:2]
            if stiffness:
                start = -(constant + stiffness * float(model.actuator_length0[index])) / gain
        yield FileMotor(armature, name, (float(low), float(high)), min(max(start, float(low)), float(high)), index)


#: of the names of actuators in the engine, in which the motor of a joint has the name of the joint
SUFFIX = " actuator"
