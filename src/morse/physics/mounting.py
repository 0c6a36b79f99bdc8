"""Where an object is in the rigid group that it moves with."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

from morse.physics import rigid

if TYPE_CHECKING:
    from collections.abc import Sequence

_ORIGIN = (0.0, 0.0, 0.0)


class Mounted(Protocol):
    """An object in a rigid group; see `morse.physics.gameobject.GameObject`."""

    slot: int
    mounting: Mounting


class Mounting(NamedTuple):
    """A pose in a rigid group.

    Most components sit on their robots unturned, many at its origin: their poses cost less.

    Attributes:
        offset: metres.
        turned: 9 numbers of the rotation, row by row.
        is_apart: whether it is not just the pose of the group.
        is_turned: whether it has axes of its own.
    """

    offset: Sequence[float]
    turned: Sequence[float]
    is_apart: bool
    is_turned: bool

    @classmethod
    def of(cls, pose: tuple[Sequence[float], Sequence[float]] | None) -> Mounting:
        """A pose in the group; None for that of the group itself."""
        if pose is not None:
            is_turned = _differ(pose[1], rigid.IDENTITY)
            if is_turned or _differ(pose[0], _ORIGIN):
                return cls(*pose, True, is_turned)
        return cls(_ORIGIN, rigid.IDENTITY, False, False)

    def carried(self, position: Sequence[float], rotation: Sequence[float]) -> tuple[Sequence[float], Sequence[float]]:
        """The pose in the world, if the group has that one."""
        if not self.is_apart:
            return position, rotation
        if self.is_turned:
            return rigid.compose(position, rotation, self.offset, self.turned)
        x, y, z = rigid.turn(rotation, self.offset)
        return (position[0] + x, position[1] + y, position[2] + z), rotation


def _differ(a: Sequence[float], b: Sequence[float]) -> bool:
    return any(not -1e-14 <= x - y <= 1e-14 for x, y in zip(a, b, strict=True))
