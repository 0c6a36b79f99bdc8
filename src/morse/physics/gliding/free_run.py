"""Several ticks at once, while nothing happens in a world but that robots glide.

The bits are those of single ticks: the same functions are called in the same order, without Python in between.
"""

from __future__ import annotations

import ctypes
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.kernel.driving.course import Course
from morse.physics.poses.kinematics import refresh

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.physics.driving.drives import Drives
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.gliding.passage import Passage
    from morse.physics.state.engine_state import EngineState

_NO_CONTACTS = np.empty((0, 2), dtype=np.int32)


class FreeRun:
    """Ticks of robots that glide, far from everything.

    Args:
        is_idle: function that returns whether no other part of the physics has work.
    """

    def __init__(
        self, state: EngineState, gliding: Gliding, passage: Passage, drives: Drives, is_idle: Callable[[], bool]
    ) -> None:
        self._state, self._gliding, self._passage, self._drives = state, gliding, passage, drives
        self._is_idle = is_idle
        self._step, self._period = state.model.opt.timestep, state.model.opt.timestep * state.steps
        self._course: Course | None = None

    def run(self, ticks: int) -> int:
        """Run at most that many ticks, with the commands that the drives have for the next tick.

        Returns:
            The number of ticks; 0 if the next tick needs more than that robots glide, and nothing has changed then.
        """
        state, gliding, drives = self._state, self._gliding, self._drives
        count, data = min(ticks, gliding.next_look - gliding.tick - 1), state.data
        if count <= 0 or state.is_stirred or state.has_forces or state.touched or state.kinematic:
            return 0
        if state.engine_rows is not None:
            return 0
        if not gliding.glides or data.nv_awake != 6 * len(gliding.glides) or not self._passage.is_straight:
            return 0
        robots = drives.only_fleet()
        if robots is None or not self._is_idle():
            return 0
        if gliding.tick + 1 >= gliding.clear_until and self._passage.will_be_near():
            return 0
        count = min(count, gliding.clear_until - gliding.tick - 1)
        if self._course is None:
            self._course = Course(
                state.model._address,
                data._address,
                _functions(),
                data.qpos,
                state.engine_positions,
                state.engine_rotations,
                *state.poses_before,
            )
        count = self._course.ticks(robots, count)
        if not count:
            return 0
        gliding.tick += count
        time = data.time
        for _ in range(count):
            time += self._period
        data.time = time
        state.known_contacts = _NO_CONTACTS
        drives.clear()
        refresh(state)
        return count


@cache
def _functions() -> Sequence[int | None] | None:
    """The addresses of functions of the engine; None if its library is not where its package has it."""
    for file in sorted(Path(mujoco.__file__).parent.glob("*mujoco*")):
        if ".so" in file.name or file.suffix in (".dylib", ".dll"):
            try:
                engine = ctypes.CDLL(str(file))
                functions = engine.mj_integratePos, engine.mj_kinematics
            except (OSError, AttributeError):
                continue
            return [ctypes.cast(function, ctypes.c_void_p).value for function in functions]
    return None
