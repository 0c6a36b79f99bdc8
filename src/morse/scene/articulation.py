"""Joints that the physics moves: the masses of links, and the friction, limits and motors of joints."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

from morse.scene.couplings import Couplings
from morse.scene.mjcf import MjcfModel  # noqa: TC001 (recordings read the annotations)

#: property of an armature: whether the physics moves its joints
DYNAMIC = "Dynamic"
#: property of an armature: the control mode of its motors
CONTROL = "Control"


class Control(StrEnum):
    """The control mode of the motor of a joint.

    A motor that controls a position or a velocity exerts the necessary effort (N m or N), up to its limit. A motor
    for efforts exerts the commanded effort; without a command, the joint moves freely.
    """

    POSITION = "position"
    VELOCITY = "velocity"
    EFFORT = "effort"


@dataclass(frozen=True, slots=True)
class JointDynamics:
    """The dynamics of a joint.

    Units are those of revolute joints. For prismatic joints, rad is replaced by m, and N m by N.

    Attributes:
        damping: N m s/rad.
        friction: dry friction, N m.
        inertia: inertia of the rotor of the motor at the joint, kg m^2.
        stiffness: stiffness of a spring, N m/rad.
        rest: joint value at which the spring is at rest, rad.
        effort: largest effort of the motor, N m.
        speed: largest speed, rad/s.
        limited: whether the joint stops at the limits of its bone.
        control: quantity that the motor controls, or None if the file does not declare it: a position.
        gain: gain of the motor: N m/rad for a position, N m s/rad for a velocity; None for a value derived from the
            masses.
        slowing: damping of a motor that controls a position, N m s/rad; None for a value derived from the gain.
    """

    damping: float = 0.0
    friction: float = 0.0
    inertia: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    effort: float = math.inf
    speed: float = math.inf
    limited: bool = True
    control: Control | None = None
    gain: float | None = None
    slowing: float | None = None


@dataclass(frozen=True, slots=True)
class Inertial:
    """The mass of a link.

    Attributes:
        mass: kg.
        centre: centre of mass, m, in the frame of the link.
        inertia: 9 numbers, row by row, about the centre of mass in the axes of the link, kg m^2.
    """

    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Articulation:
    """The joints of an armature, or of the robot to which it belongs, as declared in the file.

    Attributes:
        mass: mass of all links together, kg; 0 if the file has no masses.
        self_collision: whether links collide with each other. Links that are connected by a joint never collide.
        apart: pairs of links that do not collide, by their names in the file.
        couplings: constraints.
        control: joint to the quantity that its motor controls, if it differs from the file.
        gains: joint, stiffness (N m/rad) and damping (N m s/rad) of its motor, if they differ from the file.
        description: of a robot: its URDF file, expanded, with the paths of meshes as URLs; empty for other formats.
        meshes: of the description: URLs with their files on this machine; empty if the scene comes from a recording.
        model: the MJCF model of the robot, from which the engine takes its bodies; None for other formats.
    """

    mass: float = 0.0
    self_collision: bool = False
    apart: tuple[tuple[str, str], ...] = ()
    control: tuple[tuple[str, Control], ...] = ()
    gains: tuple[tuple[str, float | None, float | None], ...] = ()
    couplings: Couplings = field(default_factory=Couplings)
    description: str = ""
    meshes: tuple[tuple[str, str], ...] = ()
    model: MjcfModel | None = None
