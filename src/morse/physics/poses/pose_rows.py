"""Poses of many objects at many moments, with the same bits as one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.rotation_rows import stacked
from morse.mathutils.rotations import product, turn

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.objects.mounting import Mounting

    #: the numbers of positions (3) or rotations (9), each (R, N)
    Numbers = Sequence[NDArray[np.float64]]

_NONE, _MOVED, _TURNED = 0, 1, 2


class Mountings(NamedTuple):
    """The places of N objects in their rigid groups.

    Attributes:
        numbers: (12, N) offsets, m, and rotations, row by row.
        apart: (N,) whether an object has the pose of its group (0), is moved (1), or moved and turned (2).
    """

    numbers: NDArray[np.float64]
    apart: NDArray[np.uint8]

    @classmethod
    def of(cls, mountings: Sequence[Mounting]) -> Mountings:
        """Take over the places."""
        numbers = np.array([[*one.offset, *one.turned] for one in mountings], dtype=np.float64).reshape(-1, 12)
        ways = [(_TURNED if one.is_turned else _MOVED) if one.is_apart else _NONE for one in mountings]
        return cls(numbers.T, np.array(ways, dtype=np.uint8))


class PoseRows(NamedTuple):
    """The poses of rigid groups at R moments.

    Attributes:
        positions, rotations: (R, K, 3) m, (R, K, 9) of the groups.
        mountings: those of the moments, without repetition.
        places: (R,) which of them are those of a moment.
    """

    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]
    mountings: Sequence[Mountings]
    places: NDArray[np.intp]

    @classmethod
    def of(
        cls,
        positions: Sequence[NDArray[np.float64]],
        rotations: Sequence[NDArray[np.float64]],
        mountings: Sequence[Sequence[Mounting]],
    ) -> PoseRows:
        """Put R moments together.

        Args:
            positions, rotations: of the groups, (K, 3) m and (K, 9) each.
            mountings: of the objects, N each.
        """
        distinct = {id(one): one for one in mountings}
        if len(distinct) == 1:
            places = np.zeros(len(mountings), dtype=np.intp)
        else:
            numbers = {key: place for place, key in enumerate(distinct)}
            places = np.array([numbers[id(one)] for one in mountings], dtype=np.intp)
        each = [Mountings.of(one) for one in distinct.values()]
        return cls(stacked(positions), stacked(rotations), each, places)

    def carried(self, slots: NDArray[np.intp] | Sequence[int] | slice) -> tuple[Numbers, Numbers]:
        """The poses (R, N) of objects in the world, as by `Mounting.carried`."""
        p: list[NDArray[np.float64]] = [self.positions[:, slots, k] for k in range(3)]
        r: list[NDArray[np.float64]] = [self.rotations[:, slots, k] for k in range(9)]
        apart = np.stack([one.apart for one in self.mountings])
        if apart.any():
            own = np.stack([one.numbers for one in self.mountings])
            if len(own) > 1:  # else the places are the same at all moments
                apart, own = apart[self.places], own[self.places]
            moved = turn(r, [own[:, k] for k in range(3)])  # type: ignore[arg-type, misc]
            p = [np.where(apart != _NONE, a + b, a) for a, b in zip(p, moved, strict=True)]
            if (apart == _TURNED).any():
                turned = product(tuple(r), tuple(own[:, k] for k in range(3, 12)))  # type: ignore[arg-type, misc]
                r = [np.where(apart == _TURNED, b, a) for a, b in zip(r, turned, strict=True)]
        return p, r
