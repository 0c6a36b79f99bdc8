"""How far joints may be from a trajectory and from its end, as in ``control_msgs/FollowJointTrajectory``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.core.reports.hints import nearest
from morse.core.reports.quoting import shown
from morse.core.validation.spec import Spec

if TYPE_CHECKING:
    from collections.abc import Sequence

_QUANTITIES = ("position", "velocity")
_WIDEST = 1e9


class Bound(NamedTuple):
    """The tolerance of a joint; `math.inf` for any error.

    Attributes:
        position: rad or m.
        velocity: rad/s or m/s.
    """

    position: float = math.inf
    velocity: float = math.inf


class Tolerances(NamedTuple):
    """The tolerances of a trajectory, by joint; joints without an entry have none.

    Attributes:
        path: while the joints follow the path.
        goal: at the end of the path.
        late: time after the end within which the joints have to be at the goal, s.
    """

    path: dict[str, Bound]
    goal: dict[str, Bound]
    late: float = math.inf


def bounds_of(entry: object, names: Sequence[str], key: str) -> dict[str, Bound]:
    """Parse tolerances: a number for the positions of all joints, or names to numbers or ``{"position": rad or m,
    "velocity": rad/s or m/s}``.

    Raises:
        ValueError: they are invalid; the message contains the expected format.
    """
    if entry is None:
        return {}
    if isinstance(entry, (int, float)) and not isinstance(entry, bool):
        return dict.fromkeys(names, Bound(_tolerance(entry, f"'{key}'")))
    if not isinstance(entry, dict):
        raise ValueError(f"'{key}' is {shown(entry)}, expected a number, or an object: name of a joint to a number")
    bounds = {}
    for name, value in entry.items():
        if name not in names:
            raise ValueError(f"'{key}' has no joint {shown(name)}{nearest(str(name), names)}")
        where = f"'{key}' of '{name}'"
        if not isinstance(value, dict):
            bounds[name] = Bound(_tolerance(value, where))
            continue
        for quantity in value:
            if quantity not in _QUANTITIES:
                raise ValueError(f"{where} has {shown(quantity)}, expected {' and '.join(_QUANTITIES)}")
        bounds[name] = Bound(**{quantity: _tolerance(one, where) for quantity, one in value.items()})
    return bounds


def _tolerance(value: object, where: str) -> float:
    try:
        return float(Spec("number", low=0.0, high=_WIDEST).check()(value))
    except ValueError as error:
        raise ValueError(f"{where} is {shown(value)}, expected {error}") from None


def beyond(
    bounds: dict[str, Bound], errors: dict[str, float], speeds: dict[str, float] | None
) -> tuple[str, str, float, float] | None:
    """Return the first joint outside of its bound: name, quantity, error and tolerance; None if there is none.

    Args:
        bounds: joints to tolerances.
        errors: errors of positions, rad or m.
        speeds: errors of velocities, rad/s or m/s; None if they are not known.
    """
    for name, bound in bounds.items():
        if abs(errors[name]) > bound.position:
            return name, "position", abs(errors[name]), bound.position
        if speeds is not None and abs(speeds[name]) > bound.velocity:
            return name, "velocity", abs(speeds[name]), bound.velocity
    return None
