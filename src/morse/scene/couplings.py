"""Constraints between the links of an armature, apart from its bones."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

Floats = tuple[float, ...]


class ConstraintKind(StrEnum):
    """What a constraint keeps equal; the words of MJCF."""

    CONNECT = "connect"
    WELD = "weld"
    JOINT = "joint"


@dataclass(frozen=True, slots=True)
class Constraint:
    """A constraint.

    Attributes:
        one, other: names of two links or joints; the second one of joints may be empty.
        data: ``connect``: the point in the frame of the first link, m. ``weld``: a point in the frame of the second
            link and the same point in that of the first one, m; the quaternion of the second link in the first one; the
            torque scale. Otherwise five coefficients of a polynomial, of the differences from the initial values.
        solver: ``solref`` (2) and ``solimp`` (5); None for as stiff as the step of the engine allows.
        is_active: whether it holds from the start.
    """

    kind: ConstraintKind
    one: str
    other: str
    data: Floats
    solver: Floats | None = None
    is_active: bool = True


@dataclass(frozen=True, slots=True)
class Couplings:
    """All couplings of an armature."""

    constraints: tuple[Constraint, ...] = ()
