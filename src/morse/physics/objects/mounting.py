"""The pose of an object in its rigid group."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

from morse.physics.poses import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

_ORIGIN = (0.0, 0.0, 0.0)


class Mounted(Protocol):
    """An object in a rigid group; see `morse.physics.objects.gameobject.GameObject`."""

    slot: int
    mounting: Mounting


class Mounting(NamedTuple):
    """A pose in a rigid group.

    Most components have the orientation of their robots, and many are at its origin. Their poses are faster to compute.

    Attributes:
        offset: position, m.
        turned: 9 numbers of the rotation, row by row.
        is_apart: whether the pose differs from the pose of the group.
        is_turned: whether the rotation differs from the rotation of the group.
    """

    offset: Sequence[float]
    turned: Sequence[float]
    is_apart: bool
    is_turned: bool

    @classmethod
    def of(cls, pose: tuple[Sequence[float], Sequence[float]] | None) -> Mounting:
        """Create a mounting from a pose in the group; None for the pose of the group itself."""
        if pose is not None:
            is_turned = _differ(pose[1], rigid.IDENTITY)
            if is_turned or _differ(pose[0], _ORIGIN):
                return cls(*pose, True, is_turned)
        return cls(_ORIGIN, rigid.IDENTITY, False, False)

    def carried(self, position: Sequence[float], rotation: Sequence[float]) -> tuple[Sequence[float], Sequence[float]]:
        """Return the pose in the world, given the pose of the group."""
        if not self.is_apart:
            return position, rotation
        if self.is_turned:
            return rigid.compose(position, rotation, self.offset, self.turned)
        x, y, z = rigid.turn(rotation, self.offset)
        return (position[0] + x, position[1] + y, position[2] + z), rotation


def _differ(a: Sequence[float], b: Sequence[float]) -> bool:
    # a loop takes half the time of a generator
    for x, y in zip(a, b, strict=True):  # noqa: SIM110
        if not -1e-14 <= x - y <= 1e-14:
            return True
    return False
