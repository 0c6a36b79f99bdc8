"""Level floors: the top faces of static boxes, and the planes in their place below wheeled robots.

A plane has no edges. Therefore the shapes of a robot touch the plane instead of the box only in ticks in which the
whole robot is above the floor, far from its edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.kernel.driving import PlaneArrays, planes
from morse.physics.gliding.feet import level_axis
from morse.physics.model.layout import Motion
from morse.physics.model.shapes import ALL_BITS, FIRST_PLANE, MOST_FLOORS, MOST_PLANES

if TYPE_CHECKING:
    from collections.abc import Sequence

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


#: distance to the edges that a robot needs, in addition to its own size, m
_EDGE = 0.01
#: depth of the origin of a robot below the floor, m; robots that are lower may be below the box
_DEEP = 0.05


class FloorPlanes:
    """The planes of a world, and the wheeled robots that stand on them.

    Args:
        floors: the floors of the world.
    """

    def __init__(self, state: EngineState, floors: Sequence[Floor]) -> None:
        self._state = state
        with_planes = [floor for floor in floors if floor.geom in state.planes][:MOST_PLANES]
        robots = [index for index in state.wheels if state.slots[index].frame.motion is Motion.FREE]
        self._work = None
        if not with_planes or not robots:
            return
        model, data = state.model, state.data
        bits = np.array([FIRST_PLANE << number for number in range(len(with_planes))], dtype=np.int32)
        shapes = [self._shapes(index) for index in robots]
        boxes = [floor.geom for floor in with_planes]
        arrays = PlaneArrays(
            first=np.cumsum([0, *(len(geoms) for geoms in shapes)], dtype=np.int64),
            geoms=np.array([geom for geoms in shapes for geom in geoms], dtype=np.int64),
            carriers=np.array(
                [
                    -1 if body == state.slots[index].body else body
                    for index, geoms in zip(robots, shapes, strict=True)
                    for body in model.geom_bodyid[geoms].tolist()
                ],
                dtype=np.int64,
            ),
            slots=np.array(robots, dtype=np.int64),
            dofs=np.array([state.slots[index].dof for index in robots], dtype=np.int64),
            boxes=np.array(boxes, dtype=np.int64),
            places=np.hstack([data.geom_xpos[boxes], data.geom_xmat[boxes]]),
            tops=np.array(
                [(f.height, *f.centre, *f.axes[0], *f.axes[1], *f.half) for f in with_planes], dtype=np.float64
            ),
            box_bits=np.array([floor.bit for floor in with_planes], dtype=np.int32),
            plane_bits=bits,
            velocities=data.qvel,
            body_places=model.body_pos,
            box_places=data.geom_xpos,
            box_turns=data.geom_xmat,
            shape_places=model.geom_pos,
            radii=model.geom_rbound,
            types=model.geom_contype,
            affinities=model.geom_conaffinity,
            period=state.period,
            edge=_EDGE,
            deep=_DEEP,
            all_bits=ALL_BITS,
        )
        for floor, bit in zip(with_planes, bits, strict=True):
            plane = state.planes[floor.geom]
            model.geom_contype[plane] = model.geom_conaffinity[plane] = bit
        self._work = planes(arrays)

    def _shapes(self, index: int) -> list[int]:
        """Return the shapes of a robot and its wheels."""
        slots = [self._state.slots[slot] for slot in (index, *self._state.wheels[index])]
        return [geom for slot in slots for geoms in slot.geoms.values() for geom in geoms]

    @property
    def has_work(self) -> bool:
        """Whether there are planes, and robots on wheels."""
        return self._work is not None

    def before_step(self) -> None:
        """Select for each robot, at the beginning of a tick, the planes or the boxes that its shapes touch."""
        if self._work is not None:
            self._work.select(self._state.positions.array)

    def after_step(self) -> None:
        """Do nothing at the end of a tick."""
