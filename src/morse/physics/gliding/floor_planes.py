"""Planes in place of the level floors below wheeled robots.

A floor is the top face of a box. The engine computes the contacts of a box with an ellipsoid or a cylinder in many
iterations, but those with a plane by a formula, which is also more exact. A plane has no edges. Therefore the shapes of
a robot touch the plane instead of the box only in ticks in which the whole robot is above the floor, far from its
edges.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.driving import PlaneArrays, planes
from morse.physics.model.collision_bits import ALL_BITS, FIRST_PLANE, MOST_PLANES
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.physics.gliding.floors import Floor
    from morse.physics.state.engine_state import EngineState

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
