"""How far a sensor's rays go through what the sensor is mounted on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.rays import primitives
from morse.physics.rays.sweep import margins

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.rays.solids import Solids


def way_out(
    solids: Solids,
    slot: int,
    offset: tuple[Sequence[float], Sequence[float]],
    directions: NDArray[np.float64],
    origins: NDArray[np.float64] | None,
    grain: float,
) -> NDArray[np.float64]:
    """Metres (N,) from which on each ray has left all boxes around the solids of its own group.

    Both keep their places in the frame of the group, so that this need not be asked every tick.

    Args:
        offset: position (3,) and rotation (9,) of the sensor in that frame.
        directions: (N, 3) in the frame of the sensor.
        origins: (N, 3) in the frame of the sensor, or None for its origin.
    """
    position, rotation = np.asarray(offset[0]), np.reshape(offset[1], (3, 3))
    ways = directions @ rotation.T
    starts = np.broadcast_to(position, ways.shape) if origins is None else origins @ rotation.T + position
    result = np.zeros(len(ways))
    members = np.flatnonzero(solids.slots == slot)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for solid, margin in zip(members.tolist(), margins(members, grain).tolist(), strict=True):
            turn = solids.turns[solid]
            middle = solids.places[solid] + turn @ solids.centres[solid]
            halves = np.repeat((solids.halves[solid] + margin)[:, None], len(ways), axis=1)
            _, leave = primitives.box(turn.T @ (starts - middle).T, turn.T @ ways.T, halves)
            np.maximum(result, leave, out=result)
    return np.where(result > 0.0, result + grain, 0.0)
