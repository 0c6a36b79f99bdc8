"""What couples the joints and links of an armature, apart from its bones: tendons, and constraints."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

Floats = tuple[float, ...]
_IDENTITY = (1.0, 0.0, 0.0, 0.0)


class WrapKind(StrEnum):
    """What a tendon runs over."""

    JOINT = "joint"
    SITE = "site"
    SPHERE = "sphere"
    CYLINDER = "cylinder"
    PULLEY = "pulley"


@dataclass(frozen=True, slots=True)
class Wrap:
    """A part of the path of a tendon.

    Attributes:
        name: of the joint, or of the link on which the part is.
        value: coefficient of a joint, divisor of a pulley, radius (m) of a sphere or a cylinder.
        position: m, in the frame of the link.
        quaternion: w, x, y, z; cylinders are along Z.
        side: the tendon passes a sphere or a cylinder on the side of this point: link and position; or None.
    """

    kind: WrapKind
    name: str = ""
    value: float = 0.0
    position: Floats = (0.0, 0.0, 0.0)
    quaternion: Floats = _IDENTITY
    side: tuple[str, Floats] | None = None


@dataclass(frozen=True, slots=True)
class Tendon:
    """A tendon, with the attributes of MJCF.

    Its length is the sum of the coefficients times the joint values, or the length of its path, m.

    Attributes:
        limits: smallest and largest length, or None.
        stiffness: of its spring, N/m.
        damping: N s/m.
        friction: N.
        rest: lengths between which the spring is at rest.
        inertia: kg.
        solver: ``solreflimit`` (2) and ``solimplimit`` (5).
    """

    name: str
    path: tuple[Wrap, ...]
    limits: tuple[float, float] | None
    stiffness: float
    damping: float
    friction: float
    rest: tuple[float, float]
    inertia: float
    solver: Floats


@dataclass(frozen=True, slots=True)
class TendonMotor:
    """A motor that pulls a tendon: force = gain * command + bias[0] + bias[1] * length + bias[2] * velocity.

    Attributes:
        gear: length that the motor sees divided by that of the tendon.
        commands: smallest and largest command.
        force: largest force, N.
    """

    name: str
    tendon: str
    gear: float
    gain: float
    bias: tuple[float, float, float]
    commands: tuple[float, float] = (-math.inf, math.inf)
    force: float = math.inf


class ConstraintKind(StrEnum):
    """What a constraint keeps equal; the words of MJCF."""

    CONNECT = "connect"
    WELD = "weld"
    JOINT = "joint"
    TENDON = "tendon"


@dataclass(frozen=True, slots=True)
class Constraint:
    """A constraint.

    Attributes:
        one, other: names of two links, joints or tendons; the second one of joints and tendons may be empty.
        data: ``connect``: the point in the frame of the first link, m. ``weld``: a point in the frame of the second
            link and the same point in that of the first one, m; the quaternion of the second link in the first one; the
            torque scale. Otherwise five coefficients of a polynomial, of the differences from the initial values.
        solver: ``solref`` (2) and ``solimp`` (5).
        is_active: whether it holds from the start.
    """

    kind: ConstraintKind
    one: str
    other: str
    data: Floats
    solver: Floats
    is_active: bool = True


@dataclass(frozen=True, slots=True)
class Couplings:
    """All couplings of an armature."""

    tendons: tuple[Tendon, ...] = ()
    motors: tuple[TendonMotor, ...] = ()
    constraints: tuple[Constraint, ...] = ()
