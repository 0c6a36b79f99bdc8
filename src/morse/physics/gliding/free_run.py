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

from morse.kernel.driving import Course
from morse.physics.poses.kinematics import refresh

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.kernel.driving import GliderWork
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
        gliding = self._gliding
        if gliding.next_look - gliding.tick <= 1:
            return 0
        robots = self._robots()
        if robots is None:
            return 0
        count = min(ticks, self.ahead())
        if not count:
            return 0
        count = self._course_of().ticks(robots, count)
        if count:
            self.ran(count)
        return count

    def course(self) -> Course | None:
        """Return what runs the next ticks, with the commands that the drives have; None if robots do not only glide."""
        robots = self._robots()
        course = self._course_of()
        return course if robots is not None and course.follow(robots) else None

    def _robots(self) -> GliderWork | None:
        state, gliding, data = self._state, self._gliding, self._state.data
        if state.is_stirred or state.has_forces or state.touched or state.kinematic or state.engine_rows is not None:
            return None
        if not gliding.glides or data.nv_awake != 6 * len(gliding.glides) or not self._passage.is_straight:
            return None
        robots = self._drives.only_fleet()
        return robots if robots is not None and self._is_idle() else None

    def ahead(self, wanted: int = 1, since: int = 0) -> int:
        """Return the number of the next ticks in which robots touch nothing and stay on their floors.

        Args:
            wanted: a smaller number is the result of a new detection of what is near.
            since: number of ticks that the kernel has run, and of which `ran` does not know yet.
        """
        gliding = self._gliding
        gliding.tick += since
        try:
            if gliding.tick + wanted >= gliding.clear_until and self._passage.will_be_near():
                return 0
            return max(0, min(gliding.next_look, gliding.clear_until) - gliding.tick - 1)
        finally:
            gliding.tick -= since

    def _course_of(self) -> Course:
        state = self._state
        if self._course is None:
            self._course = Course(
                state.model._address,
                state.data._address,
                _functions(),
                state.data.qpos,
                state.engine_positions,
                state.engine_rotations,
                *state.poses_before,
            )
        return self._course

    def ran(self, ticks: int) -> None:
        """Take note of ticks that the kernel has run."""
        state, data = self._state, self._state.data
        self._gliding.tick += ticks
        time = data.time
        for _ in range(ticks):
            time += self._period
        data.time = time
        state.known_contacts = _NO_CONTACTS
        self._drives.clear()
        refresh(state)


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
