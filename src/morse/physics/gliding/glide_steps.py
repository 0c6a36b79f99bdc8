"""The engine's steps of a tick while robots glide.

If no other body is awake, there are no contacts to solve. One step as long as the tick then gives the same result as
several short steps, provided that no other body is within reach of a robot during the tick. If also no other body was
changed by an explicit call, the robots *drift*: the step consists of a check for contacts and the integration of
positions. If there is enough free space around all of them, one contact check serves for several ticks. If all bodies
sleep, no step is needed either.

If a robot is touched, lifted, tilted or pushed down within a tick, the tick is undone and repeated with its feet on the
floor.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.gliding.glide import FIRST_WAIT, FORESIGHT, LONGEST_WAIT
from morse.physics.stability import UnstableError
from morse.physics.state import engine_values

if TYPE_CHECKING:
    from morse.physics.crowding import Crowding
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.rescue import Rescue
    from morse.physics.state.engine_state import EngineState
    from morse.physics.state.saved import SavedGliding

#: deviations from the commanded speed, m/s and rad/s, beyond which a robot is disturbed
_DISTURBED = 1e-7
_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class GlideSteps:
    """Runs the steps of the engine for a tick."""

    def __init__(self, state: EngineState, gliding: Gliding, rescue: Rescue, crowding: Crowding) -> None:
        self._state = state
        self._gliding = gliding
        self._rescue = rescue
        self._crowding = crowding
        rescue.attach(state, gliding)
        self._tree_asleep = state.data.tree_asleep
        self._asleep = self._tree_asleep.copy()
        self._qpos, self._qvel = state.data.qpos, state.data.qvel
        self._saved = np.empty(mujoco.mj_stateSize(state.model, _STATE))
        self._step = state.model.opt.timestep
        self.reset()

    def reset(self) -> None:
        """Reset: no long step and no check far ahead has failed yet."""
        self._stride_at, self._stride_wait = 0, FIRST_WAIT
        self._far_at, self._far_wait = 0, FIRST_WAIT
        self._slept = False

    def get_state(self) -> dict[str, int]:
        """See `morse.physics.state.saved.SavedGliding`."""
        return {
            "stride_at": self._stride_at,
            "stride_wait": self._stride_wait,
            "far_at": self._far_at,
            "far_wait": self._far_wait,
        }

    def set_state(self, state: SavedGliding) -> None:
        """Restore a validated state."""
        self._stride_at, self._stride_wait = state.stride_at, state.stride_wait
        self._far_at, self._far_wait = state.far_at, state.far_wait
        self._slept = False
        if state.tick < state.clear_until:
            # the contacts that the engine has just found are far away
            self._state.data.ncon = 0

    def step(self) -> None:
        """Run the steps of a tick. Bodies that diverge are reset, and the tick is repeated.

        Raises:
            UnstableError: the simulation diverges even after every body has been reset.
        """
        if self._gliding.glides and self._can_stride():
            if self._drift():
                return
            # the other steps need the contacts within this tick
            self._gliding.look_ahead(1)
        if self._all_sleep():
            return
        self._crowding.relieve()
        mujoco.mj_getState(self._state.model, self._state.data, self._saved, _STATE)
        np.copyto(self._asleep, self._tree_asleep)
        try:
            self._run()
        except mujoco.FatalError as error:
            self._run_relieved(str(error))
        if not self._rescue.all_is_well():
            self._rescue.repeat(self._saved, self._asleep, self._run)

    def _run_relieved(self, problem: str) -> None:
        """Run the steps again after the engine has run out of memory, without the bodies that overlap most.

        Raises:
            UnstableError: the memory is exhausted by other bodies.
        """
        state = self._state
        engine_values.rewind(state, self._saved, self._asleep)
        if not self._crowding.relieve_at_once():
            raise _exhausted(problem)
        mujoco.mj_getState(state.model, state.data, self._saved, _STATE)
        try:
            self._run()
        except mujoco.FatalError as error:
            raise _exhausted(str(error)) from None

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

    def _run(self) -> None:
        state = self._state
        if not self._gliding.glides:
            state.run(state.steps)
            return
        state.data.maxuse_con = 0
        if self._can_stride() and self._stride():
            return
        state.run(state.steps)
        while self._take_back():
            state.run(state.steps)

    # -- long steps ------------------------------------------------------------------------

    def _can_stride(self) -> bool:
        gliding = self._gliding
        can = (
            gliding.tick >= self._stride_at
            and self._state.data.nv_awake == 6 * len(gliding.glides)
            and gliding.tick > gliding.newest
            and not gliding.lopsided
        )
        if can != (gliding.foresight > 0):
            gliding.look_ahead(int(can))
        return can

    def _drift(self) -> bool:
        """Integrate the present velocities; return False without changes if a step of the engine is needed.

        The step of the engine also wakes sleeping bodies that were pushed or moved. It is therefore required after a
        body that does not glide was changed by an explicit call.
        """
        state, gliding = self._state, self._gliding
        if state.is_stirred or state.has_forces or not self._rescue.all_is_well():
            return False
        if gliding.tick >= gliding.clear_until and not self._is_clear():
            return False
        period = self._step * state.steps
        mujoco.mj_integratePos(state.model, self._qpos, self._qvel, period)
        state.data.time += period
        return True

    def _is_clear(self) -> bool:
        """Check for bodies near the robots: far ahead if there is free space, otherwise within this tick."""
        gliding, data = self._gliding, self._state.data
        tick, far = gliding.tick, gliding.tick >= self._far_at
        if gliding.is_rearranged:
            mujoco.mj_kinematics(self._state.model, data)
            gliding.is_rearranged = False
        gliding.look_ahead(FORESIGHT if far else 1)
        mujoco.mj_collision(self._state.model, data)
        if far and data.ncon:
            if tick - self._far_at > LONGEST_WAIT:
                self._far_wait = FIRST_WAIT
            self._far_at = tick + self._far_wait
            self._far_wait = min(2 * self._far_wait, LONGEST_WAIT)
            gliding.look_ahead(1)
            mujoco.mj_collision(self._state.model, data)
        if data.ncon:
            return False
        gliding.clear_until = tick + gliding.foresight
        return True

    def _stride(self) -> bool:
        """Try one step as long as the tick; undo it and return False if a body is near or wakes up."""
        gliding = self._gliding
        model, data = self._state.model, self._state.data
        model.opt.timestep = self._step * self._state.steps
        mujoco.mj_step(model, data)
        model.opt.timestep = self._step
        alone = data.nv_awake == 6 * len(gliding.glides)
        if alone and data.ncon:
            near = set(gliding.owner[data.contact.geom[: data.ncon]].ravel().tolist())
            alone = not any(index in near for index in gliding.glides)
        if alone:
            return True
        mujoco.mj_setState(model, data, self._saved, _STATE)
        data.maxuse_con = 0
        gliding.look_ahead(0)
        if gliding.tick - self._stride_at > LONGEST_WAIT:
            self._stride_wait = FIRST_WAIT
        self._stride_at = gliding.tick + self._stride_wait
        self._stride_wait = min(2 * self._stride_wait, LONGEST_WAIT)
        return False

    # -- disturbances within a tick ----------------------------------------------------------

    def _take_back(self) -> bool:
        """If a gliding robot was disturbed, restore the state before the tick, and let the robot stand on its feet."""
        data, gliding = self._state.data, self._gliding
        if not gliding.glides or data.maxuse_con == 0:
            return False
        disturbed = self._disturbed()
        if not disturbed:
            return False
        mujoco.mj_setState(self._state.model, data, self._saved, _STATE)
        data.maxuse_con = 0
        for index in disturbed:
            gliding.stances.disturb(index, gliding.tick, gliding.glides[index].since)
            gliding.leave(index)
        return True

    def _disturbed(self) -> list[int]:
        data, gliding = self._state.data, self._gliding
        touched = set(gliding.owner[data.contact.geom[: data.ncon]].ravel().tolist()) if data.ncon else set()
        found = []
        for index, glide in gliding.glides.items():
            dof = glide.slot.dof
            vz, *rates = data.qvel[dof + 2 : dof + 6].tolist()
            up = glide.up
            along = sum(a * b for a, b in zip(up, rates, strict=True))
            tumbling = max(abs(rate - along * axis) for rate, axis in zip(rates, up, strict=True))
            if index in touched or abs(vz) > _DISTURBED or tumbling > _DISTURBED:
                found.append(index)
        return found


def _exhausted(problem: str) -> UnstableError:
    return UnstableError("the scene", f"its contacts exhaust the memory of the engine: {problem[:200]}")
