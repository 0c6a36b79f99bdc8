"""The steps of the engine in a tick.

Robots that glide are moved by `morse.physics.gliding.passage`. If nothing else is awake or was changed by an explicit
call, no step of the engine is needed. A robot that is touched within a tick ends gliding: the tick is repeated with its
feet on the floor.

If all bodies sleep, no step is needed either.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.gliding.passage import Passage
from morse.physics.poses.kinematics import settle_fixed, sync
from morse.physics.stability import UnstableError
from morse.physics.state import engine_values

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.stability import Crowding, Rescue
    from morse.physics.state.engine_state import EngineState

_STATE = engine_values.STATE
_SLEEP = int(mujoco.mjtEnableBit.mjENBL_SLEEP)
_FULL = int(mujoco.mjtWarning.mjWARN_CNSTRFULL)
_NO_CONTACTS = np.empty((0, 2), dtype=np.int32)


class Steps:
    """Runs the steps of the engine for a tick.

    Attributes:
        passage: moves the robots that glide.
    """

    def __init__(self, state: EngineState, gliding: Gliding, rescue: Rescue, crowding: Crowding) -> None:
        self._state = state
        self._gliding = gliding
        self.passage = Passage(state, gliding)
        self._rescue = rescue
        self._crowding = crowding
        rescue.attach(state, gliding)
        self._tree_asleep = state.data.tree_asleep
        self._asleep = self._tree_asleep.copy()
        self._saved = np.empty(mujoco.mj_stateSize(state.model, _STATE))
        self._model, self._data = state.model, state.data
        #: without sleep, all trees stay as they are
        self._may_sleep = bool(state.model.opt.enableflags & _SLEEP)
        self._step = state.model.opt.timestep
        self._period = self._step * state.steps
        self.reset()

    def reset(self) -> None:
        """Forget that all bodies slept in the last tick, or that they diverged."""
        self._slept = False
        #: the error of the next tick, which was begun with the ticks before
        self._unstable: UnstableError | None = None

    def step(self) -> None:
        """Run the steps of a tick. Bodies that diverge are reset, and the tick is repeated.

        Raises:
            UnstableError: the simulation diverges even after every body has been reset.
        """
        state = self._state
        if self._unstable is not None:
            raise self._unstable
        if self._gliding.glides and self._glide_alone():
            state.known_contacts = _NO_CONTACTS
        elif not self._all_sleep():
            self._run_safely()
            state.known_contacts = None
            if state.has_forces:
                state.data.xfrc_applied[:] = 0.0
                state.has_forces = False
        state.rest_surfaces()
        state.is_stirred = False

    @property
    def are_plain(self) -> bool:
        """Whether the next ticks are the same steps of the engine, whatever it moves, as long as no object slides."""
        state, gliding = self._state, self._gliding
        return not (
            gliding.glides
            or state.has_forces
            or state.touched
            or any(change.may_begin() for change in state.changes)
            or self._unstable is not None
            or self._may_sleep
            # their vertices are read by the world
            or state.flexes is not None
        )

    @property
    def most_contacts(self) -> int:
        """Number of contacts beyond which bodies may be excluded."""
        return self._crowding.most

    def missed(self, ticks: int) -> None:
        """Take note of ticks whose steps were run elsewhere."""
        if ticks:
            self._gliding.tick += ticks
            self._slept = self._state.is_stirred = False
            self._state.known_contacts = None

    def run(self, ticks: int) -> int:
        """Run at most that many ticks in which only the engine has work, and nobody looks at the poses between them.

        Returns:
            The number of ticks; 0 if a tick needs more than steps of the engine, and nothing has changed then.
        """
        state, data, gliding = self._state, self._data, self._gliding
        if gliding.glides or state.has_forces or not data.nv_awake or self._unstable is not None:
            return 0
        self._slept = False
        for number in range(1, ticks + 1):
            gliding.tick += 1
            try:
                if self._run_safely() and data.nv_awake:
                    continue
            except UnstableError as error:
                if number == 1:
                    raise
                # the ticks before it count
                number, self._unstable = number - 1, error
            break
        state.known_contacts = None
        state.rest_surfaces()
        state.is_stirred = False
        sync(state)
        return number

    def _glide_alone(self) -> bool:
        """Run the tick without the engine if only gliding robots move; return False if that is not possible."""
        state, data = self._state, self._data
        if state.is_stirred or state.has_forces or data.nv_awake != 6 * len(self._gliding.glides):
            return False
        touched = self.passage.alone()
        if touched:
            self._disturb(touched)
            return False
        data.time += self._period
        return True

    def _all_sleep(self) -> bool:
        """Advance time without a step, if all bodies sleep and nothing was changed.

        The engine runs the first tick of that kind, and removes the contacts of sleeping bodies.
        """
        state = self._state
        data = state.data
        sleep = not (data.nv_awake or state.is_stirred or state.has_forces) and self._rescue.all_is_well()
        slept, self._slept = self._slept, sleep
        if not (slept and sleep):
            return False
        for _ in range(state.steps):  # the sum is bit-identical to that of the engine
            data.time += self._step
        return True

    def _run_safely(self) -> bool:
        """Run the steps; if they fail, again without the bodies that overlap most, or that diverge.

        Returns:
            Whether they did not fail.
        """
        state, data = self._state, self._data
        for change in state.changes:
            change.begin()
        if data.ncon > self._crowding.most:
            self._crowding.relieve()
        mujoco.mj_getState(self._model, data, self._saved, _STATE)
        if self._may_sleep:
            self._asleep[:] = self._tree_asleep
        data.maxuse_con = 0
        try:
            self._run()
        except mujoco.FatalError as error:
            # the engine also stops at contacts of a deformable body that has diverged
            if "memory" in str(error) or self._rescue.all_is_well():
                self._run_relieved(str(error))
        else:
            # the engine may also continue with a part of the contacts
            if data.maxuse_con > self._crowding.most and data.warning[_FULL].number:
                self._run_relieved("there are too many")
        if self._rescue.all_is_well():
            return True
        self._rescue.repeat(self._saved, self._asleep, self._run)
        return False

    def _run_relieved(self, problem: str) -> None:
        """Run the steps again after the engine has run out of memory, without the bodies that overlap most.

        Raises:
            UnstableError: the memory is exhausted by other bodies.
        """
        state = self._state
        engine_values.rewind(state, self._saved, self._asleep)
        state.data.warning[_FULL].number = 0
        if not self._crowding.relieve_at_once():
            raise _exhausted(problem)
        mujoco.mj_getState(state.model, state.data, self._saved, _STATE)
        try:
            self._run()
        except mujoco.FatalError as error:
            raise _exhausted(str(error)) from None

    def _run(self) -> None:
        """Run the steps, and move the robots that glide; the state before the tick is saved."""
        state = self._state
        closely, watch = False, state.watch
        if watch is not None:
            watch.before_step()
        elif not (state.changes or self._gliding.glides):
            mujoco.mj_step(self._model, self._data, state.steps)
            return
        model, data = self._model, self._data
        while self._gliding.glides:
            touched = self.passage.beside(closely)
            if touched is not None and not touched:
                return
            mujoco.mj_setState(model, data, self._saved, _STATE)
            # the engine wakes sleeping bodies that are not at their positions
            settle_fixed(state)
            state.sleep.set(self._asleep)
            if watch is not None:
                watch.before_step()
            closely = True
            self._disturb(touched or ())
        state.run(state.steps)

    def _disturb(self, touched: Iterable[int]) -> None:
        """End the gliding of robots that are touched; they wait before they glide again."""
        gliding = self._gliding
        for index in touched:
            gliding.stances.disturb(index, gliding.tick, gliding.glides[index].since)
            gliding.leave(index)


def _exhausted(problem: str) -> UnstableError:
    return UnstableError("the scene", f"its contacts exhaust the memory of the engine: {problem[:200]}")
