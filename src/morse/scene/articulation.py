"""Joints that the physics moves: the masses of links, and the friction, limits and motors of joints."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

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

    Units are those of revolute joints; read m for rad and N for N m for prismatic joints.

    Attributes:
        damping: N m s/rad.
        friction: dry friction, N m.
        inertia: of the rotor of the motor, as the joint sees it, kg m^2.
        stiffness: of a spring, N m/rad.
        rest: rad, the value at which the spring is at rest.
        effort: largest effort of the motor, N m.
        speed: largest speed, rad/s.
        limited: whether the joint stops at the limits of its bone.
        control: what its motor is told, or None if the file does not say it: a position.
        gain: of the motor: N m/rad for a position, N m s/rad for a velocity; None for one that suits the masses.
        slowing: damping of a motor that is told a position, N m s/rad; None for one that suits its gain.
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
        centre: of mass, m, in the frame of the link.
        inertia: 9 numbers, row by row, about the centre of mass in the axes of the link, kg m^2.
    """

    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Articulation:
    """The joints of an armature, or of the robot that it belongs to, as its file has them.

    Attributes:
        mass: of all links together, kg; 0 if the file has no masses.
        self_collision: whether links collide with each other. Links that a joint joins never do.
        apart: names, in the file, of pairs of links that do not collide.
        control: joint to what its motor is told, where that is not what the file says.
    """

    mass: float = 0.0
    self_collision: bool = False
    apart: tuple[tuple[str, str], ...] = ()
    control: tuple[tuple[str, Control], ...] = ()
