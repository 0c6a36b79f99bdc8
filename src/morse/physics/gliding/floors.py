"""Level floors: the top faces of static boxes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco

from morse.physics.gliding.level import level_axis
from morse.physics.model.collision_bits import MOST_FLOORS
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState


@dataclass(frozen=True, slots=True)
class Floor:
    """A level rectangle on which robots stand.

    Attributes:
        geom: id of the box.
        slot: slot of the box.
        bit: bit of the box in the collision masks.
        height: height in the world, m.
        centre: x, y in the world, m.
        axes: horizontal unit vectors along the sides.
        half: half lengths of the sides, m.
    """

    geom: int
    slot: int
    bit: int
    height: float
    centre: tuple[float, float]
    axes: tuple[tuple[float, float], tuple[float, float]]
    half: tuple[float, float]

    def room(self, x: float, y: float) -> float:
        """Return the distance from a point to the nearest edge, m; negative outside."""
        dx, dy = x - self.centre[0], y - self.centre[1]
        (ax, ay), (bx, by) = self.axes
        return min(self.half[0] - abs(ax * dx + ay * dy), self.half[1] - abs(bx * dx + by * dy))


def find_floors(state: EngineState) -> list[Floor]:
    """Return the largest level top faces of the static boxes of a world."""
    model, data = state.model, state.data
    # thousands of boxes are looked at: single elements of arrays of the engine are slow
    kinds, bits, sizes = model.geom_type.tolist(), model.geom_contype.tolist(), model.geom_size.tolist()
    rotations = data.geom_xmat.reshape(-1, 3, 3)
    box = int(mujoco.mjtGeom.mjGEOM_BOX)
    candidates: list[tuple[float, int, int, NDArray[np.float64], int]] = []
    for slot_index, slot in enumerate(state.slots):
        if slot.frame.motion is not Motion.FIXED or slot.body < 0:
            continue
        for geoms in slot.geoms.values():
            for geom in geoms:
                if kinds[geom] != box or not bits[geom]:
                    continue
                rotation = rotations[geom]
                up = level_axis(rotation)
                if up is not None:
                    first, second = (sizes[geom][i] for i in range(3) if i != up)
                    area = first * second
                    candidates.append((-area, geom, slot_index, rotation, up))
    nearest = sorted(candidates, key=lambda entry: entry[:2])[:MOST_FLOORS]
    return [
        _floor(state, geom, slot, rotation, up, number)
        for number, (_, geom, slot, rotation, up) in enumerate(nearest, 1)
    ]


def _floor(state: EngineState, geom: int, slot: int, rotation: NDArray[np.float64], up: int, number: int) -> Floor:
    x, y, z = state.data.geom_xpos[geom].tolist()
    size: Sequence[float] = state.model.geom_size[geom].tolist()
    first, second = (i for i in range(3) if i != up)
    axes = tuple((float(rotation[0, i]), float(rotation[1, i])) for i in (first, second))
    return Floor(geom, slot, 1 << number, z + size[up], (x, y), (axes[0], axes[1]), (size[first], size[second]))
