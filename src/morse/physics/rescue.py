"""Resets a body whose state diverges. The other bodies are not affected."""

from __future__ import annotations

import logging
import math
from collections import deque
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.layout import Motion
from morse.physics.model.limits import RUNAWAY_DISTANCE, RUNAWAY_SPEED
from morse.physics.stability import UnstableError
from morse.physics.state import engine_values

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.model.slot import Slot
    from morse.physics.state.engine_state import EngineState

logger = logging.getLogger(__name__)

_norm = mujoco.mju_norm
#: resets of one body within this time, s, count as one event
_EVENT = 1.0
#: s between two reports
_QUIET = 10.0
#: maximum number of resets that are kept
_REMEMBERED = 100
#: maximum number of bodies that are reset one by one in a tick; further diverged bodies are reset together
_ONE_BY_ONE = 8


@dataclass(frozen=True, slots=True)
class Recovery:
    """A body that diverged and was reset.

    Attributes:
        time: simulated seconds.
        body: name of the body.
        what: description of the value that diverged.
    """

    time: float
    body: str
    what: str


class Rescue:
    """Finds bodies whose state has diverged, and resets them to their last valid pose, at rest.

    Attributes:
        recoveries: the last events.
        count: the number of resets of all bodies.
    """

    def __init__(self) -> None:
        self.recoveries: deque[Recovery] = deque(maxlen=_REMEMBERED)
        self.count = 0
        self._last: dict[str, float] = {}
        self._reported = -math.inf

    def attach(self, state: EngineState, gliding: Gliding) -> None:
        """Use a model that was compiled again."""
        self._state = state
        self._gliding = gliding
        self._qvel, self._qpos = state.data.qvel, state.data.qpos

    def reset(self) -> None:
        """Forget the kept states, because the simulation restarts."""
        self._last.clear()

    def all_is_well(self) -> bool:
        """Whether the state has not diverged. NaN and infinity fail the comparison with the limits."""
        # unlike dot of numpy, the norm of the engine does not emit warnings, and it takes a third of the time
        return bool(_norm(self._qvel) < RUNAWAY_SPEED and _norm(self._qpos) < RUNAWAY_DISTANCE)

    def repeat(self, numbers: NDArray[np.float64], asleep: NDArray[np.int32], run: Callable[[], None]) -> None:
        """Repeat a tick after a reset of the bodies that diverged in it.

        Args:
            numbers, asleep: the state before the tick, see `engine_values.rewind`; bodies are reset to it.
            run: function that runs the tick.

        Raises:
            UnstableError: the simulation diverges even after every body has been reset.
        """
        if not self._wrong():
            return
        state, messages = self._state, dict[str, str]()
        for attempt in range(_ONE_BY_ONE + 2):
            engine_values.rewind(state, numbers, asleep)
            culprits = self._culprits()
            if not culprits:
                break
            engine_values.rewind(state, numbers, asleep)
            removals = culprits if attempt >= _ONE_BY_ONE else culprits[:1]
            for slot, what in removals:
                self._put_back(slot)
                messages[slot.frame.node.name] = what
            mujoco.mj_getState(state.model, state.data, numbers, engine_values.STATE)
            asleep[:] = state.data.tree_asleep
            engine_values.rewind(state, numbers, asleep)
            run()
            if not self._wrong():
                break
        else:
            raise UnstableError(*next(iter(messages.items())))
        for name, what in messages.items():
            self._note(name, what)

    def report(self, text: str) -> None:
        """Log an error that may occur in many ticks, at most every ten seconds of wall-clock time."""
        now = monotonic()
        if now - self._reported >= _QUIET:
            self._reported = now
            logger.error("%s", text)

    def _note(self, body: str, what: str) -> None:
        self.count += 1
        now = float(self._state.data.time)
        last = self._last.get(body, -math.inf)
        self._last[body] = now
        if now - last <= _EVENT:
            return
        self.recoveries.append(Recovery(now, body, what))
        logger.error(
            "the physics of '%s' diverged: %s. It was reset to its last valid pose, at rest; other bodies continue. "
            "Look for forces and speeds that are far too large, for bodies that start inside each other, and for "
            "masses that differ by more than 1:1000",
            body,
            what,
        )

    # -- which bodies diverged -------------------------------------------------------------------------

    def _wrong(self) -> list[tuple[Slot, str]]:
        """Return the bodies with diverged values, and a description of each."""
        data, faults = self._state.data, []
        for slot in self._state.slots:
            if slot.dof < 0:
                continue
            free = slot.frame.motion is Motion.FREE
            count, dofs = slot.numbers
            speeds = data.qvel[slot.dof : slot.dof + dofs]
            places = data.qpos[slot.qpos : slot.qpos + count]
            if not np.isfinite(places).all():
                faults.append((slot, "its position is not finite"))
            elif not np.isfinite(speeds).all():
                faults.append((slot, "its velocity is not finite"))
            elif np.abs(speeds).max() > RUNAWAY_SPEED:
                faults.append((slot, f"it moves at {np.abs(speeds).max():.3g} m/s or rad/s"))
            elif free and np.abs(places[:3]).max() > RUNAWAY_DISTANCE:
                faults.append((slot, f"it is {np.abs(places[:3]).max():.3g} m away"))
        return faults

    def _culprits(self) -> list[tuple[Slot, str]]:
        """Return the bodies that diverge first when the tick is repeated step by step, sorted by previous speed."""
        state = self._state
        model, data = state.model, state.data
        for _ in range(state.steps + 1):
            wrong = self._wrong()
            overpushed = [
                (slot, "the force on it is far too large") for slot in state.slots if self._is_overpushed(slot)
            ]
            if wrong or overpushed:
                return overpushed or wrong
            before = data.qvel.copy()
            mujoco.mj_step(model, data)
            wrong = self._wrong()
            if wrong:
                pushes = np.abs(data.xfrc_applied).max(axis=1)
                return sorted(wrong, key=lambda entry: -self._urge(entry[0], before, pushes))
        return []

    def _is_overpushed(self, slot: Slot) -> bool:
        return slot.body > 0 and not np.isfinite(self._state.data.xfrc_applied[slot.body]).all()

    def _urge(self, slot: Slot, speeds: NDArray[np.float64], pushes: NDArray[np.float64]) -> float:
        """Return the speed of a body before a step plus the speed that the forces add in the step."""
        model = self._state.model
        dofs = slot.numbers[1]
        mass = max(float(model.body_mass[slot.body]), 1e-9)
        speed_gain = float(pushes[slot.body]) / mass * float(model.opt.timestep)
        return float(np.abs(speeds[slot.dof : slot.dof + dofs]).max()) + speed_gain

    # -- reset -----------------------------------------------------------------------------

    def _put_back(self, slot: Slot) -> None:
        """Reset a body and its wheels to their pose before the tick; if that is lost, to their pose in the scene."""
        state = self._state
        data = state.data
        index = state.slot_of[slot.frame.root.node]
        slot = state.slots[index]
        links = [state.slots[link] for link in state.links.get(index, ())]
        for link in links:
            self._stop_joints(link)
        if slot.frame.motion is not Motion.FREE:
            return
        self._gliding.unsettle(index)
        pose = data.qpos[slot.qpos : slot.qpos + 7]
        norm = float(matmul(pose[3:], pose[3:])) if np.isfinite(pose).all() else 0.0
        if not (0.25 < norm < 4.0 and np.abs(pose[:3]).max() <= RUNAWAY_DISTANCE):
            pose[:3], pose[3:] = slot.pose.position, slot.pose.quaternion
        parts = [slot, *(state.slots[wheel] for wheel in state.wheels.get(index, ()))]
        for part in parts:
            dofs = slice(part.dof, part.dof + (6 if part is slot else 1))
            for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
                values[dofs] = 0.0
            data.xfrc_applied[part.body] = 0.0
            if part.actuator >= 0:
                data.ctrl[part.actuator] = 0.0
                if not math.isfinite(data.qpos[part.qpos]) or abs(data.qpos[part.qpos]) > RUNAWAY_DISTANCE:
                    data.qpos[part.qpos] = 0.0

    def _stop_joints(self, link: Slot) -> None:
        """Set the joints of a link to rest; a joint whose value is lost returns to its initial value."""
        data = self._state.data
        for joint in link.joints:
            for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
                values[joint.dof : joint.dof + joint.dofs] = 0.0
            place = slice(joint.qpos, joint.qpos + joint.width)
            if not np.abs(data.qpos[place]).max() <= RUNAWAY_DISTANCE:
                data.qpos[place] = self._state.model.qpos0[place]
        data.xfrc_applied[link.body] = 0.0
