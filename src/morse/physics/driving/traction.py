"""Traction of robots on driven wheels.

The wheels of a turning robot slide: four wheels without steering always slide, and the contact of a tyre is not a
point. With Coulomb friction at single contact points, the resulting motion would depend on rounding and on the load of
each wheel. Therefore the friction of all wheels of a robot is computed together. The wheels have no friction in the
engine, and once per tick the velocity of the robot is moved towards the velocity of its turning wheels, limited by the
friction.

The velocity of the turning wheels is that of a steadily turning robot. Wheels at (x_i, y_i) from their centre, whose
treads run at s_i, exert forces against their slip. For slips of equal size, forces and moments are balanced at

    v = mean(s_i)        w = -sum(y_i s_i) / sum(x_i^2 + y_i^2)

For two wheels, this is rolling without slip. For four wheels, see J. L. Martinez et al., "Approximating kinematics for
tracked mobile robots", Int. J. Robotics Research 24 (2005).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.driving import ChassisArrays, chassis
from morse.physics.driving.command import SKIDDING
from morse.physics.poses.kinematics import contact_pairs

if TYPE_CHECKING:
    from morse.kernel.driving import Floats
    from morse.physics.driving.drives import Drives
    from morse.physics.state.engine_state import EngineState

#: speed, m/s and rad/s, below which a robot with stopped wheels is held by plain friction
_CREEP = 0.02


class Traction:
    """Moves the robots of a world that have driven wheels.

    Args:
        drives: the velocity commands, which show the slots that are driven as bodies, independent of their wheels.
    """

    def __init__(self, state: EngineState, drives: Drives) -> None:
        self._state = state
        self._drives = drives
        robots = [(index, wheels) for index, wheels in state.wheels.items() if wheels]
        self._slots = [index for index, _ in robots]
        if not robots:
            return
        self._some_driven = False
        self._gravity = state.model.opt.gravity
        each = [self._chassis(index, wheels) for index, wheels in robots]
        geoms, motors, radii, levers = (np.concatenate(column) for column in list(zip(*each, strict=True))[:4])
        axles, frictions, turnings = (
            np.array(column, dtype=np.float64) for column in list(zip(*each, strict=True))[4:]
        )
        self._arrays = ChassisArrays(
            first=np.cumsum([0, *(len(wheels) for _, wheels in robots)], dtype=np.int64),
            geoms=geoms.astype(np.int64),
            motors=motors.astype(np.int64),
            radii=radii,
            levers=levers,
            slots=np.array(self._slots, dtype=np.int64),
            dofs=np.array([state.slots[index].dof for index in self._slots], dtype=np.int64),
            axles=axles,
            frictions=frictions,
            turnings=turnings,
            driven=np.zeros(len(robots), dtype=np.uint8),
            touching=np.zeros((16, 2), dtype=np.int32),
            touched=np.zeros(state.model.ngeom, dtype=np.uint8),
            controls=state.data.ctrl,
            velocities=state.data.qvel,
            dimensions=state.model.geom_condim,
            period=state.period,
            creep=_CREEP,
        )
        self._work = chassis(self._arrays)

    def _chassis(
        self, index: int, wheels: list[int]
    ) -> tuple[list[int], list[int], Floats, Floats, float, float, float]:
        """Return geoms, motors, radii and levers of the wheels; axle, friction and turning; see `ChassisArrays`."""
        state, model = self._state, self._state.model
        slots = [state.slots[wheel] for wheel in wheels]
        bodies = [slot.body for slot in slots]
        geoms = [geom for slot in slots for shape in slot.geoms.values() for geom in shape]
        places = model.body_pos[bodies]
        middle = places.mean(axis=0)
        x, y = (places - middle)[:, :2].T
        squares = float((x * x + y * y).sum()) or 1.0
        body = state.slots[index].body
        mass = float(model.body_subtreemass[body])
        inertia = float(model.body_inertia[body].max() + (model.body_mass[bodies] * (x * x + y * y)).sum())
        return (
            geoms,
            [slot.actuator for slot in slots],
            model.geom_size[geoms, 0],
            -y / squares * (SKIDDING if state.physics_of_1_4 and len(wheels) > 2 else 1.0),
            float(middle[0]),
            float(model.geom_friction[geoms, 0].mean()),
            mass * math.sqrt(squares / len(wheels)) / inertia,
        )

    @property
    def has_work(self) -> bool:
        """Whether a robot has driven wheels."""
        return bool(self._slots)

    def before_step(self) -> None:
        """Change the velocities of the robots at the beginning of a tick."""
        state, arrays, drives = self._state, self._arrays, self._drives
        if drives.has_commands or self._some_driven:
            arrays.driven[:] = driven = [drives.is_commanded(index) for index in self._slots]
            self._some_driven = any(driven)
        pairs = contact_pairs(state)
        count = len(pairs)
        if count > len(arrays.touching):
            arrays.touching = np.zeros((2 * count, 2), dtype=np.int32)
        arrays.touching[:count] = pairs
        self._work.pull(state.rotations.array, count, -float(self._gravity[2]))

    def after_step(self) -> None:
        """Do nothing at the end of a tick."""
