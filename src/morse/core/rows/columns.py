"""The data of sensors in many ticks at once: columns, with the same bits as one measurement after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from morse.core.rows.marks import mark_of
from morse.helpers.transformation import UPRIGHT, euler_angles
from morse.mathutils import portable
from morse.mathutils.rotation_rows import stacked

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.values import Value
    from morse.core.world import Snapshot

_F = TypeVar("_F", bound="Callable[..., object]")


class Columns(NamedTuple):
    """The measurements of N sensors of one class in R ticks.

    Attributes:
        fields: names of the fields; those that the sensors have besides follow from these.
        of: returns, by field, the values of each sensor: (R,) numbers, (R, ...) arrays, or a tuple of R arrays. Its
            arguments are R snapshots of the poses, and R lists of what was kept.
        keep: returns the part of an observation that is kept: an array that nobody changes. None if nothing is kept.
        one: returns the same values of one sensor at a position (3) and a rotation (9, row by row), as numbers, which
            takes less time than arrays of a few; None if these are not all that they depend on.
    """

    fields: Sequence[str]
    of: Callable[[Sequence[Snapshot], Sequence[Sequence[np.ndarray]]], Mapping[str, np.ndarray | Sequence[object]]]
    keep: Callable[[Value], np.ndarray] | None = None
    one: Callable[[Sequence[float], Sequence[float]], Sequence[float]] | None = None


class Setpoints(NamedTuple):
    """Joints of which the next actions of an actuator do nothing but move them to the numbers in its data.

    In an action a joint goes to the number of its field within its limits, or by a step toward it.

    Attributes:
        fields: the fields, J; their numbers are rad, m, or what the motors control.
        values: (J,) to which the last action has moved them.
        bounds: (J, 2) limits of the setpoints.
        steps: (J,) what an action changes at most.
        channels: (J,) numbers of the motors among the commands of the world; -1 for a joint without motor.
    """

    fields: Sequence[str]
    values: Sequence[float]
    bounds: Sequence[tuple[float, float]]
    steps: Sequence[float]
    channels: Sequence[int]


def in_columns(columns: Columns) -> Callable[[_F], _F]:
    """Mark an action that is marked by `morse.core.rows.marks.on_read`, and measures the same in columns."""

    def mark(action: _F) -> _F:
        action.columns = columns  # type: ignore[attr-defined]
        return action

    return mark


def columns_of(cls: type) -> Columns | None:
    """The columns of a class; None if it measures in no other way than by its action."""
    columns: Columns | None = mark_of(cls, "columns")
    return columns


def _poses_of(snapshots: Sequence[Snapshot], _kept: object) -> dict[str, NDArray[np.float64]]:
    positions, rotations = snapshots[0].poses_at(snapshots)
    roll, pitch, yaw = euler_rows(rotations)
    pairs = zip(POSES.fields, (*positions, yaw, pitch, roll), strict=True)
    return {name: each.T for name, each in pairs}


def _positions_of(snapshots: Sequence[Snapshot], _kept: object) -> dict[str, NDArray[np.float64]]:
    positions, _ = snapshots[0].poses_at(snapshots)
    return {name: each.T for name, each in zip(POSITIONS.fields, positions, strict=True)}


def _pose_of(position: Sequence[float], rotation: Sequence[float]) -> Sequence[float]:
    roll, pitch, yaw = euler_angles(rotation)
    return *position, yaw, pitch, roll


def _position_of(position: Sequence[float], _rotation: Sequence[float]) -> Sequence[float]:
    return position


#: `Transformation3d.numbers`, and the positions alone
POSES = Columns(("x", "y", "z", "yaw", "pitch", "roll"), _poses_of, one=_pose_of)
POSITIONS = Columns(("x", "y", "z"), _positions_of, one=_position_of)


def arrays_of(arrays: Sequence[Sequence[NDArray[np.generic]]]) -> list[np.ndarray | tuple[np.ndarray, ...]]:
    """The arrays of each sensor in R ticks as one; as they are if their sizes differ."""
    return [stacked(one) if len({array.shape for array in one}) == 1 else one for one in zip(*arrays, strict=True)]


def euler_rows(m: Sequence[NDArray[np.float64]]) -> tuple[NDArray[np.float64], ...]:
    """Return roll, pitch and yaw of rotations by `euler_angles`: arrays of the shape of the nine numbers."""
    shape = m[0].shape
    m = [numbers.reshape(-1) for numbers in m]
    # robots on a floor neither roll nor pitch: atan2(y, x) and asin(y) of a zero y are y, if x is positive
    upright = m[8] > UPRIGHT
    if upright.all() and m[7].all() and m[3].all():
        return tuple(
            angle.reshape(shape)
            for angle in (portable.arctan2(m[7], m[8]), -portable.arcsin(m[6]), portable.arctan2(m[3], m[0]))
        )
    roll, pitch, yaw = m[7].copy(), -m[6], m[3].copy()
    for angle, x in ((roll, m[8]), (yaw, m[0])):
        rows = np.flatnonzero(upright & ~((angle == 0.0) & (x > 0.0)))
        angle[rows] = portable.arctan2(angle[rows], x[rows])
    rows = np.flatnonzero(upright & (pitch != 0.0))
    pitch[rows] = -portable.arcsin(m[6][rows])
    for row in np.flatnonzero(~upright).tolist():
        roll[row], pitch[row], yaw[row] = euler_angles([float(numbers[row]) for numbers in m])
    return roll.reshape(shape), pitch.reshape(shape), yaw.reshape(shape)
