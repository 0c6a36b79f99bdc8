"""How gliding robots move in a tick, and what they meet.

Gliding robots are moved here and not by the steps of the engine: while the engine moves what else is awake, they sleep
in it. A robot is *touched* when the engine detects a contact with it at one of the times at which the engine takes its
steps. Whether a robot glides on, and where it is at the end of the tick, thus depends only on what it touches.

Most ticks need no contact detection. The engine reports contacts within a gap around each robot that the robot crosses
in several ticks. From the distances follows the number of ticks in which nothing can be touched.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.kernel.driving import Course, Placed
from morse.kernel.memory import address, addresses
from morse.physics.engine_functions import WIDE_AWAKE
from morse.physics.gliding.stances import FORESIGHT
from morse.physics.poses.kinematics import sync

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

    from numpy.typing import NDArray

    from morse.kernel.driving import GliderWork
    from morse.physics.driving.drives import Drives
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.poses.kinematics import Rows
    from morse.physics.state.engine_state import EngineState

#: largest horizontal distance of the centre of mass from the origin, m, that has no effect
_CENTRED = 1e-7
_NO_CONTACTS = np.empty((0, 2), dtype=np.int32)
_NOBODY: frozenset[int] = frozenset()


class Passage:
    """Moves the gliding robots of a world."""

    def __init__(self, state: EngineState, gliding: Gliding) -> None:
        self._state, self._gliding = state, gliding
        self._model, self._data = state.model, state.data
        self._qpos, self._qvel, self._asleep = state.data.qpos, state.data.qvel, state.data.tree_asleep
        self._motion = state.data.qvel, state.data.qacc, state.data.qacc_smooth, state.data.qacc_warmstart
        self._step = state.model.opt.timestep
        self._steps = state.steps
        self._period = self._step * state.steps
        self._tree = state.model.body_treeid[state.model.geom_bodyid]
        state.write_gliders = self.write_poses
        self._arrangement = -1
        self._placed: Placed
        self._places = self._dofs = self._trees = np.empty(0, dtype=np.intp)
        #: velocities of the robots, 0 for everything else; positions at the start of the tick
        self._course = np.zeros(state.model.nv)
        self._start = np.empty(state.model.nq)
        #: addresses for the kernel: coordinates and velocities of the engine; those of `_start` and `_course`
        self._here, self._speeds, self._from, self._along = (
            place or 0 for place in addresses(self._qpos, self._qvel, self._start, self._course)
        )
        self._end: NDArray[np.float64] = np.empty(0)

    # -- a tick without steps of the engine ------------------------------------------------

    def alone(self) -> Collection[int]:
        """Move the robots in a tick in which nothing else moves; return the robots that are touched.

        If a robot is touched, nothing is moved.
        """
        gliding = self._gliding
        if self._arrangement != gliding.arrangement:
            self._refresh()
        if gliding.tick < gliding.clear_until or not self._is_near():
            if not self._swings:
                self._placed.move(self._here, self._speeds, self._period)
                return _NOBODY
            self._begin()
            self._place(self._steps)
        else:
            self._begin()
            touched = self._watch(others=False)
            if touched:
                self._qpos[self._places] = self._start[self._places]
                return touched
        self._qvel[self._dofs] = self._end
        return _NOBODY

    def write_poses(self, positions: Rows, rotations: Rows) -> None:
        """Write the poses of the robots into those of the world, (K, 3) and (K, 9), which were just set."""
        if self._gliding.glides:
            if self._arrangement != self._gliding.arrangement:
                self._refresh()
            here, turn = positions.place or address(positions.array), rotations.place or address(rotations.array)
            self._placed.write_poses(here, turn)

    @property
    def placed(self) -> Placed:
        """The robots in the arrays of the engine."""
        return self._placed

    @property
    def is_straight(self) -> bool:
        """Whether no robot swings around its centre of mass; False if that has to be found out first."""
        return self._arrangement == self._gliding.arrangement and not self._swings

    def will_be_near(self) -> bool:
        """Detect what is near to the robots; return whether a robot could touch something within the next tick."""
        self._gliding.tick += 1
        is_near = self._is_near()
        self._gliding.tick -= 1
        return is_near

    # -- a tick with steps of the engine ---------------------------------------------------

    def beside(self, closely: bool) -> set[int] | None:
        """Move the robots while the engine moves what else is awake.

        Args:
            closely: compare the positions at each step of the engine.

        Returns:
            The robots that are touched; None if something has come near, so that the tick has to be repeated closely.
            In both cases the caller restores the state before the tick.
        """
        gliding = self._gliding
        if self._arrangement != gliding.arrangement:
            self._refresh()
        self._begin()
        if closely or (gliding.tick >= gliding.clear_until and self._is_near()):
            touched = self._watch(others=True)
            if touched:
                return touched
        else:
            if self._step_others(self._steps):
                gliding.clear_until = 0
                return None
            self._place(self._steps)
        self._qvel[self._dofs] = self._end
        return set()

    def _step_others(self, count: int) -> bool:
        """Take steps of the engine while the robots sleep; return whether something has come near to a robot."""
        sleep, asleep = self._state.sleep, self._asleep.copy()
        asleep[self._trees] = self._trees
        sleep.set(asleep)
        self._rest()
        self._state.run(count)
        self._rest()
        asleep = self._asleep.copy()
        woken = bool((asleep[self._trees] < 0).any())
        asleep[self._trees] = WIDE_AWAKE
        sleep.set(asleep)
        return woken

    def _rest(self) -> None:
        """Set what the engine keeps of the motion of a body from step to step to the values of a sleeping body."""
        for values in self._motion:
            values[self._dofs] = 0.0

    # -- positions and contacts ------------------------------------------------------------

    def _watch(self, others: bool) -> set[int]:
        """Move the robots in steps as long as those of the engine; return the robots that are touched."""
        # something that wakes within the gap around a robot would wake what sleeps there
        self._gliding.set_gaps(False)
        try:
            for step in range(self._steps):
                if step:
                    self._place(step)
                self._detect()
                touched = self._touched()
                if touched:
                    return touched
                if others:
                    self._step_others(1)
        finally:
            self._gliding.set_gaps(True)
        self._place(self._steps)
        return set()

    def _detect(self) -> None:
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_collision(self._model, self._data)

    def _is_near(self) -> bool:
        """Detect what is near to the robots; return whether a robot could touch something within this tick."""
        self._detect()
        gliding, data = self._gliding, self._data
        gliding.clear_until = gliding.tick + FORESIGHT
        if not data.ncon:
            return False
        geoms = np.asarray(data.contact.geom)
        owners, trees = gliding.owner[geoms], self._tree[geoms]
        glides = gliding.speeds[owners] >= 0.0
        # there is no limit to the speed of other bodies
        moves = (trees >= 0) & (data.tree_awake[trees] != 0)
        approach = np.where(glides, 0.5 * gliding.margins[owners], np.where(moves, np.inf, 0.0)).sum(axis=1)
        chosen = glides.any(axis=1)
        if not chosen.any():
            return False
        ticks = float((np.asarray(data.contact.dist)[chosen] / approach[chosen]).min())
        gliding.clear_until = gliding.tick + min(max(int(ticks), 0), FORESIGHT)
        return gliding.clear_until <= gliding.tick

    def _touched(self) -> set[int]:
        data, gliding = self._data, self._gliding
        if not data.ncon:
            return set()
        owners = gliding.owner[np.asarray(data.contact.geom)[np.asarray(data.contact.dist) < 0.0]].ravel()
        return set(owners[gliding.speeds[owners] >= 0.0].tolist())

    # -- motion ----------------------------------------------------------------------------

    def _refresh(self) -> None:
        """Find the addresses of the robots in the arrays of the engine again after a robot began or ended to glide."""
        gliding = self._gliding
        self._arrangement = gliding.arrangement
        slots = [glide.slot for glide in gliding.glides.values()]
        self._places = np.array([slot.qpos + i for slot in slots for i in range(7)], dtype=np.intp)
        self._dofs = np.array([slot.dof + i for slot in slots for i in range(6)], dtype=np.intp)
        self._trees = self._model.body_treeid[[slot.body for slot in slots]]
        self._placed = Placed(
            np.array([slot.qpos for slot in slots], np.int64),
            np.array([slot.dof for slot in slots], np.int64),
            np.array(list(gliding.glides), np.int64),
            self._qpos,
        )
        self._course[:] = 0.0
        masses = {index: self._model.body_ipos[glide.slot.body] for index, glide in gliding.glides.items()}
        lopsided = [index for index, place in masses.items() if np.abs(place[:2]).max() > _CENTRED]
        self._lopsided = np.array(lopsided, dtype=np.intp)
        self._swings = bool(lopsided)
        self._levers = np.array([masses[index] for index in lopsided]).reshape(-1, 3)
        self._swinging = np.array([gliding.glides[index].slot.dof for index in lopsided], dtype=np.intp)

    def _begin(self) -> None:
        """Record the positions and the velocities at the start of the tick."""
        np.copyto(self._start, self._qpos)
        self._end = self._qvel[self._dofs]
        self._course[self._dofs] = self._end
        if self._swings:
            self._swing()

    def _place(self, steps: int) -> None:
        """Set the positions of the robots after a number of steps, and their velocities."""
        self._placed.move(self._from, self._along, self._step * steps)

    def _swing(self) -> None:
        """Let the origin of each robot swing around the centre of mass, which moves straight within a tick.

        The engine changes the velocity of the origin in each step by the centripetal acceleration w^2 r, where r points
        from the origin to the centre of mass.
        """
        steps, dofs = self._steps, self._swinging
        turned = self._state.rotations.array[self._lopsided]
        rates = [self._qvel[dofs + 3 + i] for i in range(3)]
        rate = turned[:, 6] * rates[0] + turned[:, 7] * rates[1] + turned[:, 8] * rates[2]
        a, b, c = self._levers.T
        x = turned[:, 0] * a + turned[:, 1] * b + turned[:, 2] * c
        y = turned[:, 3] * a + turned[:, 4] * b + turned[:, 5] * c
        gain = self._step * rate * rate
        angle = rate * self._step
        square = angle * angle
        sine = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0))
        cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0)
        mean, last = np.zeros((2, len(x))), np.zeros((2, len(x)))
        for step in range(steps):
            change = gain * np.array([x, y])
            last += change
            mean += change * ((steps - step) / steps)
            x, y = cosine * x - sine * y, sine * x + cosine * y
        velocities = self._course.copy()
        for axis in range(2):
            velocities[dofs + axis] += last[axis]
            self._course[dofs + axis] += mean[axis]
        self._end = velocities[self._dofs]


class FreeRun:
    """Several ticks at once, while nothing happens in a world but that robots glide, far from everything.

    The bits are those of single ticks: the same functions are called in the same order, without Python in between.

    Args:
        is_idle: function that returns whether no other part of the physics has work.
    """

    def __init__(
        self, state: EngineState, gliding: Gliding, passage: Passage, drives: Drives, is_idle: Callable[[], bool]
    ) -> None:
        self._state, self._gliding, self._passage, self._drives = state, gliding, passage, drives
        self._is_idle = is_idle
        self._step, self._period = state.model.opt.timestep, state.model.opt.timestep * state.steps
        self._course = Course(*state.poses_before)

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
        done, count = 0, min(ticks, self.ahead())
        if not count or not self._follow(robots):
            return 0
        while count:
            ran = self._course.ticks(count)
            done += ran
            # a robot may have to be driven otherwise, or something may be near
            count = min(ticks - done, self.ahead(since=done)) if ran == count and done < ticks else 0
        if done:
            self.ran(done)
        return done

    def course(self) -> Course | None:
        """Return what runs the next ticks, with the commands that the drives have; None if robots do not only glide."""
        robots = self._robots()
        return self._course if robots is not None and self._follow(robots) else None

    def _follow(self, robots: GliderWork) -> bool:
        state = self._state
        return self._course.follow(robots, self._passage.placed, state.positions.array, state.rotations.array)

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
        sync(state)
