"""Bodies whose translation or rotation is locked for some axes of the world."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.model.layout import Motion
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from morse.physics.model.layout import Frame
    from morse.physics.state.engine_state import EngineState


class Locks:
    """Keeps the locked coordinates of free bodies constant during every tick.

    Velocities along locked axes are set to 0 before the steps of the engine, and motion along these axes is undone
    afterwards. A body can still be moved by explicit calls. Rotations are locked for all axes together, because the
    axes of a body rotate with it.

    Ground robots of the type ``DYNAMIC`` do not roll or pitch, as in 1.4: the engine does not rotate bodies of this
    type, and commands only turn ground robots about their vertical axis.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        positions: list[int] = []
        velocities: list[int] = []
        level: list[int] = []
        for slot in state.slots:
            if slot.frame.motion is not Motion.FREE or slot.qpos < 0:
                continue
            body = slot.frame.node.body
            for axis in range(3):
                if body.lock_location[axis]:
                    positions.append(slot.qpos + axis)
                    velocities.append(slot.dof + axis)
            if any(body.lock_rotation):
                positions += range(slot.qpos + 3, slot.qpos + 7)
                velocities += range(slot.dof + 3, slot.dof + 6)
            elif _stays_level(slot.frame):
                level += range(slot.dof + 3, slot.dof + 5)
        self._positions = np.array(positions, dtype=np.intp)
        self._velocities = np.array(velocities, dtype=np.intp)
        self._level = np.array(level, dtype=np.intp)
        self._held = np.zeros(len(positions))

    @property
    def has_work(self) -> bool:
        """Whether a coordinate is locked."""
        return bool(len(self._positions) or len(self._level))

    def before_step(self) -> None:
        """Called at the beginning of a tick, after the commanded velocities are set."""
        if len(self._level):
            self._state.data.qvel[self._level] = 0.0
        if len(self._positions):
            self._state.data.qvel[self._velocities] = 0.0
            self._held = self._state.data.qpos[self._positions]

    def after_step(self) -> None:
        """Called at the end of a tick."""
        if len(self._level):
            self._state.data.qvel[self._level] = 0.0
        if len(self._positions):
            self._state.data.qpos[self._positions] = self._held
            self._state.data.qvel[self._velocities] = 0.0


def _stays_level(frame: Frame) -> bool:
    node = frame.node
    return (
        frame.robot is not None and node.body.type is PhysicsType.DYNAMIC and bool(node.properties.get("GroundRobot"))
    )
